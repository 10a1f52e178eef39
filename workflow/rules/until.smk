# The sample grows until its intervals are narrow. A look plans the chunks of the next step, or says why the study stops;
# how many looks follow is known only then, so each of them is a checkpoint.
import json


def chunks_of(number):
    """Return the report of a look, and the marks of its chunks."""
    if number < 0:
        return []
    told = checkpoints.look.get(number=number).output[0]
    chunks = json.loads(Path(told).read_text())["chunks"]
    return [told, *(f"{RESULTS}/looks/{number}-{chunk}.solved" for chunk in chunks)]


def looks(wildcards):
    """Return the reports of all looks up to the one at which the study stops, and their marks."""
    files = chunks_of(0)
    number = 0
    while not json.loads(Path(files[0]).read_text())["stopped"]:
        number += 1
        files = chunks_of(number)
    return files


wildcard_constraints:
    number="[0-9]+",


checkpoint look:
    input:
        lambda wildcards: chunks_of(int(wildcards.number) - 1),
        study=study_inputs(LEDGER.study),
        code=digest_file(f"{RESULTS}/code", "results"),
    output:
        f"{RESULTS}/looks/{{number}}.json",
    log:
        f"{RESULTS}/logs/looks/{{number}}.log",
    conda:
        "../envs/trackroller.yaml"
    params:
        config=CONFIG,
    script:
        "../scripts/look.py"


rule solve:
    input:
        f"{RESULTS}/looks/{{number}}.json",
    output:
        touch(f"{RESULTS}/looks/{{number}}-{{chunk}}.solved"),
    log:
        f"{RESULTS}/logs/solve/{{number}}-{{chunk}}.log",
    conda:
        "../envs/trackroller.yaml"
    threads: 1
    script:
        "../scripts/solve.py"


# Every case is solved: this repeats the looks from the stored cases and gathers the last step.
rule gather:
    input:
        looks,
        study=study_inputs(LEDGER.study),
        code=digest_file(f"{RESULTS}/code", "results"),
    output:
        design=f"{RESULTS}/design.nc",
        study=f"{RESULTS}/study.nc",
    log:
        f"{RESULTS}/logs/gather.log",
    conda:
        "../envs/trackroller.yaml"
    params:
        config=CONFIG,
    script:
        "../scripts/search.py"
