"""Draw the figures."""

from pathlib import Path

from trackroller.cli.workflow import log_to
from trackroller.report.build import draw_figures
from trackroller.solved import open_study

log_to(snakemake.log[0], "draw the figures")
solved = open_study(snakemake.input.study, snakemake.input.sensitivity)
draw_figures(solved.analysed_view, Path(snakemake.output[0]))
