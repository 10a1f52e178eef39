# Error against cost of stages and contact models: snakemake -s validation/Snakefile --cores all tradeoff
from validation.tradeoff.parts import load_sizes

TRADEOFF = f"{RESULTS}/tradeoff"
TRADEOFF_SIZES = HERE / "config" / "tradeoff.yaml"


rule tradeoff:
    input:
        f"{TRADEOFF}/tradeoff.nc",
        f"{TRADEOFF}/tradeoff.html",


rule tradeoff_part:
    input:
        sizes=TRADEOFF_SIZES,
        code=digest_file(f"{TRADEOFF}/code", "validation.tradeoff.parts"),
    output:
        f"{TRADEOFF}/parts/{{part}}.nc",
    log:
        f"{TRADEOFF}/logs/{{part}}.log",
    wildcard_constraints:
        part="[a-z]+-[0-9]+",
    conda:
        "../../workflow/envs/trackroller.yaml"
    threads: 1
    script:
        "../scripts/tradeoff_part.py"


rule tradeoff_gather:
    input:
        sizes=TRADEOFF_SIZES,
        parts=[
            f"{TRADEOFF}/parts/{name}.nc"
            for name in load_sizes(TRADEOFF_SIZES).names()
        ],
    output:
        f"{TRADEOFF}/tradeoff.nc",
    log:
        f"{TRADEOFF}/logs/gather.log",
    conda:
        "../../workflow/envs/trackroller.yaml"
    script:
        "../scripts/tradeoff_gather.py"


rule tradeoff_show:
    input:
        measured=f"{TRADEOFF}/tradeoff.nc",
        code=digest_file(f"{TRADEOFF}/code", "validation.tradeoff.page"),
    output:
        summary=f"{TRADEOFF}/tradeoff.json",
        figures=directory(f"{TRADEOFF}/figures"),
        report=f"{TRADEOFF}/tradeoff.html",
    log:
        f"{TRADEOFF}/logs/show.log",
    conda:
        "../../workflow/envs/trackroller.yaml"
    script:
        "../scripts/tradeoff_show.py"
