"""Draw the figures."""

from trackroller.cli.workflow import log_to
from trackroller.report.build import draw_study

log_to(snakemake.log[0], "draw the figures")
draw_study(snakemake.input.study, snakemake.input.sensitivity, snakemake.output[0])
