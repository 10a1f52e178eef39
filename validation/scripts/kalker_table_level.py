"""Solve the patches of one level of the table of the exact theory."""

import numpy as np
from trackroller.cli.workflow import log_to
from validation.kalker_table.build import solve_level

log_to(snakemake.log[0])
np.savez_compressed(snakemake.output[0], **solve_level(int(snakemake.wildcards.level)))
