# What the results mean: indices, figures and one report to send; and the RO-Crate, which holds a digest of each file.


rule sensitivity:
    input:
        study=f"{RESULTS}/study.nc",
        code=digest_file(f"{RESULTS}/code", "results"),
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
        code=digest_file(f"{RESULTS}/code", "report"),
    output:
        report(
            directory(f"{RESULTS}/figures"),
            patterns=["{name}.svg"],
            caption="../report/figure.rst",
            category="Figures",
            labels={"figure": "{name}"},
        ),
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
        code=digest_file(f"{RESULTS}/code", "report"),
    output:
        report(
            f"{RESULTS}/report.html",
            caption="../report/report.rst",
            category="Report",
            labels={"file": "report of the study"},
        ),
    log:
        f"{RESULTS}/logs/report.log",
    conda:
        "../envs/trackroller.yaml"
    script:
        "../scripts/report.py"


rule crate:
    input:
        inputs=study_inputs(LEDGER.study),
        design=f"{RESULTS}/design.nc",
        study=f"{RESULTS}/study.nc",
        sensitivity=rules.sensitivity.output,
        figures=rules.figures.output,
        report=rules.report.output,
        code=digest_file(f"{RESULTS}/code", "study"),
    output:
        f"{RESULTS}/ro-crate-metadata.json",
    log:
        f"{RESULTS}/logs/crate.log",
    conda:
        "../envs/trackroller.yaml"
    params:
        config=CONFIG,
    script:
        "../scripts/crate.py"
