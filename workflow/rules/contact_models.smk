# The contact models side by side: snakemake --cores all contact_models
COMPARED = f"{config.get('results', 'results')}/contact_models"


# the same study as the configured one, `--config study=config/studies/contact_models.yaml`, has these files by the rules
# of any study
ruleorder: figures > contact_models
ruleorder: report > contact_models


rule contact_models:
    input:
        study="config/studies/contact_models.yaml",
        code=sources(
            "ladder",
            "plots",
            "report",
            "templates",
            "contact",
            "contact_choice.py",
            "contact_choice_probe.py",
        ),
    output:
        report=f"{COMPARED}/report.html",
        figures=directory(f"{COMPARED}/figures"),
        words=f"{COMPARED}/words.txt",
    log:
        f"{COMPARED}/logs/contact_models.log",
    conda:
        "../envs/trackroller.yaml"
    script:
        "../scripts/contact_models.py"
