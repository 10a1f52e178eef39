"""Run a study whose cases depend on results, and gather it."""

import logging

from trackroller.cli.workflow import log_to
from trackroller.results.run import run_any
from trackroller.study.file.load import load_study

log_to(snakemake.log[0], "search for the best designs" if snakemake.rule == "search" else "")
config, tell = snakemake.params.config, logging.getLogger("trackroller").info
scheduler = "local" if snakemake.threads > 1 else None
run_any(load_study(config["study"]), config["results"], scheduler=scheduler, tell=tell)
