# The contact models side by side: snakemake -s validation/Snakefile --cores all contact_models
COMPARED = f"{config.get('results', 'results')}/contact_models"


rule contact_models:
    input:
        study="validation/config/contact_models.yaml",
        code=sources("study", "analysis", "report", "roller", "contact", "halfspace", "damage", "materials", "numerics", "parameters.py", "validation/contact_models"),
    output:
        report=f"{COMPARED}/report.html",
        figures=directory(f"{COMPARED}/figures"),
        words=f"{COMPARED}/words.txt",
    log:
        f"{COMPARED}/logs/contact_models.log",
    conda:
        "../../workflow/envs/trackroller.yaml"
    script:
        "../scripts/contact_models.py"
