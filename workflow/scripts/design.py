"""Write the design of a study."""

from pathlib import Path

from trackroller.cli.workflow import log_to, workflow_plan
from trackroller.study.gather import write_design

log_to(snakemake.log[0])
write_design(workflow_plan(snakemake.config, check=False).study, Path(snakemake.output[0]))
