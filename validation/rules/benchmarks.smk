# Programs that measure one thing each: snakemake -s validation/Snakefile --cores all benchmarks statistics
from validation.benchmarks import TIMED, programs

BENCHMARKS, STATISTICS = f"{RESULTS}/benchmarks", f"{RESULTS}/statistics"


rule benchmarks:
    input:
        [f"{BENCHMARKS}/{program}.json" for program in programs()],


rule benchmark:
    input:
        code=lambda wildcards: digest_file(
            f"{BENCHMARKS}/code", f"validation.benchmarks.{wildcards.program}"
        ),
    output:
        f"{BENCHMARKS}/{{program}}.json",
    log:
        f"{BENCHMARKS}/logs/{{program}}.log",
    wildcard_constraints:
        program="[a-z_]+",
    conda:
        "../../workflow/envs/trackroller.yaml"
    # a measurement of time needs the machine for itself
    threads: lambda wildcards: workflow.cores if wildcards.program in TIMED else 1
    shell:
        "python -m validation.benchmarks.{wildcards.program} --output {output} > {log} 2>&1"


rule statistics:
    input:
        f"{STATISTICS}/index_estimators.txt",
        f"{STATISTICS}/probability_intervals.txt",


rule statistics_program:
    input:
        code=lambda wildcards: digest_file(
            f"{STATISTICS}/code", f"validation.{wildcards.program}"
        ),
    output:
        f"{STATISTICS}/{{program}}.txt",
    log:
        f"{STATISTICS}/logs/{{program}}.log",
    wildcard_constraints:
        program="[a-z_]+",
    conda:
        "../../workflow/envs/trackroller.yaml"
    shell:
        "python -m validation.{wildcards.program} > {output} 2> {log}"
