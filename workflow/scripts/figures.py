"""Draw the figures."""

from pathlib import Path

from trackroller.cli.workflow import log_to
from trackroller.report.build import draw_figures
from trackroller.results.stored_study import open_study

log_to(snakemake.log[0], "draw the figures")
results = open_study(snakemake.input.study, snakemake.input.sensitivity)
draw_figures(results, Path(snakemake.output[0]))
