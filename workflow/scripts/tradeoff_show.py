"""Summary, figures and report of the trade-off."""

from trackroller.study.tradeoff.page import write_results
from trackroller.workflow import log_to

log_to(snakemake.log[0])
write_results(snakemake.input.measured, snakemake.output.summary, snakemake.output.figures, snakemake.output.report)
