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
    resources:
        mem_mb=megabytes_of_report(LEDGER.study.config.outputs, LEDGER.size),
    script:
        "../scripts/sensitivity.py"


# One job, because a process of its own for each of them would spend most of its time on imports.
rule report:
    input:
        inputs=study_inputs(LEDGER.study),
        design=f"{RESULTS}/design.nc",
        study=f"{RESULTS}/study.nc",
        sensitivity=rules.sensitivity.output,
        code=digest_file(f"{RESULTS}/code", "report"),
    output:
        figures=report(
            directory(f"{RESULTS}/figures"),
            patterns=["{name}.svg"],
            caption="../report/figure.rst",
            category="Figures",
            labels={"figure": "{name}"},
        ),
        page=report(
            f"{RESULTS}/report.html",
            caption="../report/report.rst",
            category="Report",
            labels={"file": "report of the study"},
        ),
        crate=f"{RESULTS}/ro-crate-metadata.json",
    log:
        f"{RESULTS}/logs/report.log",
    conda:
        "../envs/trackroller.yaml"
    resources:
        mem_mb=megabytes_of_report(LEDGER.study.config.outputs, LEDGER.size),
    params:
        config=CONFIG,
    script:
        "../scripts/report.py"
