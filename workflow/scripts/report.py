"""Draw the figures, write the report, and describe the results as an RO-Crate."""

import sys
from pathlib import Path

from trackroller.environment import leave_out

leave_out("dask", "pint")  # before xarray asks for them

from trackroller.cli.workflow import log_to, workflow_ledger
from trackroller.report.build import draw_figures
from trackroller.report.pages.study import write_report
from trackroller.results.stored_study import open_study
from trackroller.study.store.crate import write_crate

log_to(snakemake.log[0], "draw the figures")
ledger = workflow_ledger(snakemake.params.config, main=False)
results = open_study(snakemake.input.study, snakemake.input.sensitivity[0])
draw_figures(results, Path(snakemake.output.figures))
print("write the report", file=sys.stderr, flush=True)
write_report(results, Path(snakemake.output.page))
write_crate(ledger.folder.root)
