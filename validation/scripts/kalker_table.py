"""Join the levels of the table of the exact theory and measure the errors of the table."""

from pathlib import Path

from trackroller.cli.workflow import log_to
from validation.kalker_table.measure import write_measured

log_to(snakemake.log[0])
write_measured(list(map(Path, snakemake.input.levels)), Path(snakemake.output.table), Path(snakemake.output.errors))
