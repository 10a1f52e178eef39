"""Write the design of a study."""

from trackroller.environment import leave_out

leave_out("dask", "pint")  # before xarray asks for them

from trackroller.cli.workflow import log_to, workflow_ledger
from trackroller.study.store.gather import write_design

log_to(snakemake.log[0])
write_design(workflow_ledger(snakemake.params.config, main=False))
