"""Solve a chunk of cases."""

import logging
from pathlib import Path

from trackroller.environment import leave_out

leave_out("dask", "pint")  # before xarray asks for them

from trackroller.cli.workflow import log_to, show_progress
from trackroller.study.solve_chunk import solve_chunk
from trackroller.study.store.folder import StudyFolder

log_to(snakemake.log[0])
folder = StudyFolder(Path(snakemake.output[0]).parent.parent)
inputs = {Path(path): (kind, digest) for path, (kind, digest) in snakemake.config["inputs"].items()}
summary = solve_chunk(folder, snakemake.wildcards.chunk, inputs=inputs)
logging.getLogger("trackroller").info(summary)
show_progress(folder)
