"""Gather the parts of the trade-off."""

from trackroller.cli.workflow import log_to
from validation.tradeoff.parts import write_gathered

log_to(snakemake.log[0])
write_gathered(snakemake.input.parts, snakemake.input.sizes, snakemake.output[0])
