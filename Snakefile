# From a study file to a report: snakemake --cores all [--config study=config/studies/NAME.yaml]
include: "workflow/Snakefile"


localrules:
    study,


rule study:
    input:
        rules.all.input,
