"""Run the catalogue of edge scenes."""

from pathlib import Path

from trackroller.study.extremes.run import run, write
from trackroller.workflow import log_to

log_to(snakemake.log[0])
write(run(), Path(snakemake.output[0]))
