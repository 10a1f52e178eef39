"""Write the design of a study."""

from trackroller.cli.workflow import log_to, workflow_plan
from trackroller.study.store.gather import write_design

log_to(snakemake.log[0])
plan = workflow_plan(snakemake.params.config, main=False)
write_design(plan.study, plan.folder)
