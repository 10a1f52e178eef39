# A catalogue of edge scenes, run and drawn as a map: snakemake -s validation/Snakefile --cores all extremes
EXTREMES = f"{config.get('results', 'results')}/extremes"


rule extremes:
    input:
        f"{EXTREMES}/extremes.json",
        f"{EXTREMES}/extremes.html",


rule extremes_run:
    input:
        code=sources("roller", "contact", "halfspace", "damage", "materials", "numerics", "parameters.py", "validation/extremes"),
    output:
        f"{EXTREMES}/extremes.json",
    log:
        f"{EXTREMES}/logs/run.log",
    conda:
        "../../workflow/envs/trackroller.yaml"
    script:
        "../scripts/extremes_run.py"


rule extremes_show:
    input:
        record=f"{EXTREMES}/extremes.json",
        code=sources("report/figures/style.py", "validation/extremes", "report/pages.py"),
    output:
        figures=directory(f"{EXTREMES}/figures"),
        page=f"{EXTREMES}/extremes.html",
    log:
        f"{EXTREMES}/logs/show.log",
    conda:
        "../../workflow/envs/trackroller.yaml"
    script:
        "../scripts/extremes_show.py"
