"""Measure one part of the trade-off."""

from trackroller.study.tradeoff.parts import write_part
from trackroller.workflow import log_to

log_to(snakemake.log[0])
write_part(snakemake.wildcards.part, snakemake.input.sizes, snakemake.output[0])
