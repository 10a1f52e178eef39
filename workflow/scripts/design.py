"""Write the design of a study."""

from pathlib import Path

from trackroller.study.config import load_study
from trackroller.study.gather import write_design
from trackroller.study.workflow import log_to

log_to(snakemake.log[0])
write_design(load_study(snakemake.input[0]), Path(snakemake.output[0]))
