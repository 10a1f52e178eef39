"""Measure one part of the trade-off."""

from trackroller.cli.workflow import log_to
from validation.tradeoff.parts import write_part

log_to(snakemake.log[0])
write_part(snakemake.wildcards.part, snakemake.input.sizes, snakemake.output[0])
