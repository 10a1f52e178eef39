"""Write the report."""

from trackroller.cli.workflow import log_to
from trackroller.report.build import report_study

log_to(snakemake.log[0], "write the report")
report_study(snakemake.input.study, snakemake.input.figures, snakemake.input.sensitivity, snakemake.output[0])
