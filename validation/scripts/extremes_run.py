"""Run the catalogue of edge scenes."""

from pathlib import Path

from trackroller.cli.workflow import log_to
from validation.extremes.run import run, write

log_to(snakemake.log[0])
write(run(), Path(snakemake.output[0]))
