# The table of the exact theory: snakemake -s validation/Snakefile --cores all kalker_table
from validation.kalker_table.nodes import FORCES

KALKER_TABLE = f"{RESULTS}/kalker_table"


rule kalker_table:
    input:
        levels=[f"{KALKER_TABLE}/levels/{level}.npz" for level in FORCES.levels],
        code=digest_file(f"{KALKER_TABLE}/code", "validation.kalker_table.measure"),
    output:
        table=f"{KALKER_TABLE}/kalker_table.npz",
        errors=f"{KALKER_TABLE}/errors.json",
    log:
        f"{KALKER_TABLE}/logs/table.log",
    conda:
        "../../workflow/envs/trackroller.yaml"
    threads: 1
    script:
        "../scripts/kalker_table.py"


rule kalker_table_level:
    input:
        code=digest_file(f"{KALKER_TABLE}/code", "validation.kalker_table.build"),
    output:
        f"{KALKER_TABLE}/levels/{{level}}.npz",
    log:
        f"{KALKER_TABLE}/logs/level-{{level}}.log",
    wildcard_constraints:
        level="[0-9]+",
    conda:
        "../../workflow/envs/trackroller.yaml"
    threads: 1
    script:
        "../scripts/kalker_table_level.py"
