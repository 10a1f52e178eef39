"""Summary, figures and report of the trade-off."""

from trackroller.cli.workflow import log_to
from validation.tradeoff.page import write_results

log_to(snakemake.log[0])
write_results(snakemake.input.measured, snakemake.output.summary, snakemake.output.figures, snakemake.output.report)
