# Design, chunks of solved cases, one gathered file. Case lists under plan/ are written when the study is planned.
localrules:
    design,


rule design:
    input:
        study_inputs(PLAN.study),
    output:
        f"{RESULTS}/design.nc",
    log:
        f"{RESULTS}/logs/design.log",
    conda:
        "../envs/trackroller.yaml"
    script:
        "../scripts/design.py"


rule solve:
    input:
        f"{RESULTS}/plan/{{chunk}}.npz",
    output:
        f"{RESULTS}/chunks/{{chunk}}.nc",
    log:
        f"{RESULTS}/logs/solve/{{chunk}}.log",
    conda:
        "../envs/trackroller.yaml"
    threads: 1
    script:
        "../scripts/solve.py"


rule gather:
    input:
        study=study_inputs(PLAN.study),
        design=rules.design.output,
        chunks=expand(f"{RESULTS}/chunks/{{chunk}}.nc", chunk=PLAN.chunks),
    output:
        f"{RESULTS}/study.nc",
    log:
        f"{RESULTS}/logs/gather.log",
    conda:
        "../envs/trackroller.yaml"
    script:
        "../scripts/gather.py"
