# Every table and figure of the published example: snakemake -s validation/Snakefile --cores all paper
PAPER = f"{RESULTS}/paper"


rule paper:
    input:
        code=digest_file(f"{PAPER}/code", "validation.paper.page"),
    output:
        data=f"{PAPER}/paper.json",
        figures=directory(f"{PAPER}/figures"),
        page=f"{PAPER}/paper.html",
    log:
        f"{PAPER}/logs/paper.log",
    conda:
        "../../workflow/envs/trackroller.yaml"
    script:
        "../scripts/paper.py"
