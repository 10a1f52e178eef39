# A catalogue of edge scenes, run and drawn as a map: snakemake --cores all extremes
EXTREMES = f"{config.get('results', 'results')}/extremes"


rule extremes:
    input:
        f"{EXTREMES}/extremes.json",
        f"{EXTREMES}/extremes.html",


rule extremes_run:
    input:
        code=sources(
            "solver.py",
            "stages",
            "equilibrium",
            "contact",
            "contact_choice.py",
            "contact_choice_probe.py",
            "halfspace",
            "study/extremes/scenes.py",
            "study/extremes/checks.py",
            "study/extremes/kernels.py",
            "study/extremes/random_cases.py",
            "study/extremes/run.py",
            "study/extremes/search.py",
        ),
    output:
        f"{EXTREMES}/extremes.json",
    log:
        f"{EXTREMES}/logs/run.log",
    conda:
        "../envs/trackroller.yaml"
    threads: workflow.cores
    script:
        "../scripts/extremes_run.py"


rule extremes_show:
    input:
        record=f"{EXTREMES}/extremes.json",
        code=sources(
            "plots/extremes.py",
            "plots/style.py",
            "study/extremes/page.py",
            "pages.py",
        ),
    output:
        figures=directory(f"{EXTREMES}/figures"),
        page=f"{EXTREMES}/extremes.html",
    log:
        f"{EXTREMES}/logs/show.log",
    conda:
        "../envs/trackroller.yaml"
    script:
        "../scripts/extremes_show.py"
