"""Draw the figures."""

from trackroller.cli.workflow import draw_study, log_to

log_to(snakemake.log[0])
draw_study(snakemake.input.study, snakemake.input.sensitivity, snakemake.output[0])
