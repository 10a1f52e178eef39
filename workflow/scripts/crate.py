"""Describe the results as an RO-Crate."""

from trackroller.cli.workflow import log_to, workflow_plan
from trackroller.study.store.crate import write_crate

log_to(snakemake.log[0])
plan = workflow_plan(snakemake.params.config, main=False)
write_crate(plan.folder.root)
