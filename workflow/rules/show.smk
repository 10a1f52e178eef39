

rule sensitivity:
    input:
        study=f"{RESULTS}/study.nc",
        code=sources("damage", "numerics", "study", "analysis"),
    output:
        f"{RESULTS}/sensitivity.nc",
    log:
        f"{RESULTS}/logs/sensitivity.log",
    conda:
        "../envs/trackroller.yaml"
    script:
        "../scripts/sensitivity.py"


rule figures:
    input:
        study=f"{RESULTS}/study.nc",
        sensitivity=f"{RESULTS}/sensitivity.nc",
        code=sources("damage", "numerics", "study", "analysis", "report"),
    output:
        directory(f"{RESULTS}/figures"),
    log:
        f"{RESULTS}/logs/figures.log",
    conda:
        "../envs/trackroller.yaml"
    script:
        "../scripts/figures.py"


rule report:
    input:
        study=f"{RESULTS}/study.nc",
        figures=f"{RESULTS}/figures",
        sensitivity=f"{RESULTS}/sensitivity.nc",
        code=sources("damage", "numerics", "study", "analysis", "report"),
    output:
        f"{RESULTS}/report.html",
    log:
        f"{RESULTS}/logs/report.log",
    conda:
        "../envs/trackroller.yaml"
    script:
        "../scripts/report.py"
