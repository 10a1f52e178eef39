"""Solve, draw and tell the comparison of the contact models."""

from pathlib import Path

from trackroller.cli.workflow import log_to
from validation.contact_models.product import compare

log_to(snakemake.log[0])
compare(Path(snakemake.input.study), Path(snakemake.output.report).parent)
