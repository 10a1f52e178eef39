# Every table and figure of the published example: snakemake --cores all paper
PAPER = f"{config.get('results', 'results')}/paper"


rule paper:
    input:
        code=sources(
            "solver.py",
            "stages",
            "equilibrium",
            "contact",
            "contact_choice.py",
            "contact_choice_probe.py",
            "halfspace",
            "paper.py",
            "paper_page.py",
            "pages.py",
            "plots/paper.py",
            "plots/contact_patch.py",
            "plots/contact_sections.py",
        ),
    output:
        data=f"{PAPER}/paper.json",
        figures=directory(f"{PAPER}/figures"),
        page=f"{PAPER}/paper.html",
    log:
        f"{PAPER}/logs/paper.log",
    conda:
        "../envs/trackroller.yaml"
    script:
        "../scripts/paper.py"
