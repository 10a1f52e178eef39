"""Solve a chunk of cases."""

import logging
from pathlib import Path

from trackroller.cli.workflow import log_to
from trackroller.study.files import StudyFolder
from trackroller.study.solve import solve_chunk

log_to(snakemake.log[0])
summary = solve_chunk(StudyFolder(Path(snakemake.output[0]).parent.parent), snakemake.wildcards.chunk)
logging.getLogger("trackroller").info(summary)
