"""Write the report."""

from pathlib import Path

from trackroller.report import write_report
from trackroller.study.workflow import log_to

log_to(snakemake.log[0])
write_report(Path(snakemake.input.study), Path(snakemake.input.figures), Path(snakemake.output[0]))
