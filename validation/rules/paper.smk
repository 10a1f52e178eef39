# Every table and figure of the published example: snakemake -s validation/Snakefile --cores all paper
PAPER = f"{config.get('results', 'results')}/paper"


rule paper:
    input:
        code=sources("roller", "contact", "halfspace", "damage", "materials", "numerics", "parameters.py", "report/figures", "validation/paper", "report/pages.py"),
    output:
        data=f"{PAPER}/paper.json",
        figures=directory(f"{PAPER}/figures"),
        page=f"{PAPER}/paper.html",
    log:
        f"{PAPER}/logs/paper.log",
    conda:
        "../../workflow/envs/trackroller.yaml"
    script:
        "../scripts/paper.py"
