# A catalogue of edge scenes, run and drawn as a map: snakemake -s validation/Snakefile --cores all extremes
EXTREMES = f"{RESULTS}/extremes"


rule extremes:
    input:
        f"{EXTREMES}/extremes.json",
        f"{EXTREMES}/extremes.html",


rule extremes_run:
    input:
        code=digest_file(f"{EXTREMES}/code", "validation.extremes.run"),
    output:
        f"{EXTREMES}/extremes.json",
    log:
        f"{EXTREMES}/logs/run.log",
    conda:
        "../../workflow/envs/trackroller.yaml"
    threads: 2  # the solver shares its rows among them; a fixed number, which a cluster needs
    script:
        "../scripts/extremes_run.py"


rule extremes_show:
    input:
        record=f"{EXTREMES}/extremes.json",
        code=digest_file(
            f"{EXTREMES}/code",
            "validation.extremes.page",
            "validation.extremes.figures",
        ),
    output:
        figures=directory(f"{EXTREMES}/figures"),
        page=f"{EXTREMES}/extremes.html",
    log:
        f"{EXTREMES}/logs/show.log",
    conda:
        "../../workflow/envs/trackroller.yaml"
    script:
        "../scripts/extremes_show.py"
