"""Describe the results as an RO-Crate."""

from trackroller.cli.workflow import log_to, workflow_ledger
from trackroller.study.store.crate import write_crate

log_to(snakemake.log[0])
ledger = workflow_ledger(snakemake.params.config, main=False)
write_crate(ledger.folder.root)
