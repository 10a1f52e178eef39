"""Gather the solved chunks into one labelled file."""

import logging

from trackroller.environment import leave_out

leave_out("dask", "pint")  # before xarray asks for them

from trackroller.cli.workflow import log_to, workflow_ledger
from trackroller.study.store.gather import gather

log_to(snakemake.log[0])
gather(workflow_ledger(snakemake.params.config, main=False), tell=logging.getLogger("trackroller").info)
