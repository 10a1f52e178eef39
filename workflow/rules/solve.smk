# Write the design, solve the cases in chunks, gather the results into one file. Planning writes the case lists
# plan/*.nc.
# The output of the rule solve is an empty mark: Snakemake deletes the outputs of a job that it repeats, and the solved
# cases in chunks/ must survive that.
localrules:
    design,


rule design:
    input:
        study_inputs(LEDGER.study),
        code=digest_file(f"{RESULTS}/code", "study"),
    output:
        f"{RESULTS}/design.nc",
    log:
        f"{RESULTS}/logs/design.log",
    conda:
        "../envs/trackroller.yaml"
    params:
        config=CONFIG,
    script:
        "../scripts/design.py"


rule solve:
    input:
        f"{RESULTS}/plan/{{chunk}}.nc",
    output:
        f"{RESULTS}/plan/{{chunk}}.solved",
    log:
        f"{RESULTS}/logs/solve/{{chunk}}.log",
    conda:
        "../envs/trackroller.yaml"
    threads: 1
    script:
        "../scripts/solve.py"


rule gather:
    input:
        study=study_inputs(LEDGER.study),
        design=rules.design.output,
        chunks=expand(f"{RESULTS}/plan/{{chunk}}.solved", chunk=LEDGER.chunks),
        code=digest_file(f"{RESULTS}/code", "study"),
    output:
        f"{RESULTS}/study.nc",
    log:
        f"{RESULTS}/logs/gather.log",
    conda:
        "../envs/trackroller.yaml"
    resources:
        mem_mb=megabytes_of_report(LEDGER.study.config.outputs, LEDGER.size),
    params:
        config=CONFIG,
    script:
        "../scripts/gather.py"
