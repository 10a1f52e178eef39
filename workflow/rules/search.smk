# A search for designs is one job: each generation follows from the results of those before it. With more threads, as by
# `--set-threads search=8`, dask workers solve the cases of a generation. A job that was stopped goes on where it stopped.
rule search:
    input:
        study=study_inputs(LEDGER.study),
        code=digest_file(f"{RESULTS}/code", "results"),
    output:
        design=f"{RESULTS}/design.nc",
        study=f"{RESULTS}/study.nc",
    log:
        f"{RESULTS}/logs/search.log",
    conda:
        "../envs/trackroller.yaml"
    params:
        config=CONFIG,
    script:
        "../scripts/search.py"
