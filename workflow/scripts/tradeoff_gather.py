"""Gather the parts of the trade-off."""

from trackroller.study.tradeoff.parts import write_gathered
from trackroller.workflow import log_to

log_to(snakemake.log[0])
write_gathered(snakemake.input.parts, snakemake.input.sizes, snakemake.output[0])
