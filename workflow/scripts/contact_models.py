"""Solve, draw and tell the comparison of the contact models."""

from pathlib import Path

from trackroller.ladder.product import compare
from trackroller.workflow import log_to

log_to(snakemake.log[0])
compare(Path(snakemake.input.study), Path(snakemake.output.report).parent)
