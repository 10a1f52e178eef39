# The contact models side by side: snakemake -s validation/Snakefile --cores all contact_models
COMPARED = f"{RESULTS}/contact_models"


rule contact_models:
    input:
        study=HERE / "config" / "contact_models.yaml",
        code=digest_file(f"{COMPARED}/code", "validation.contact_models.product"),
    output:
        report=f"{COMPARED}/report.html",
        figures=directory(f"{COMPARED}/figures"),
        words=f"{COMPARED}/words.txt",
        errors=f"{COMPARED}/errors.json",
    log:
        f"{COMPARED}/logs/contact_models.log",
    conda:
        "../../workflow/envs/trackroller.yaml"
    script:
        "../scripts/contact_models.py"
