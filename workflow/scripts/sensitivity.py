"""Analyse what decides the results."""

from pathlib import Path

from trackroller.environment import leave_out

leave_out("dask", "pint")  # before xarray asks for them

from trackroller.cli.workflow import log_to
from trackroller.report.build import write_analysis
from trackroller.results.stored_study import open_study

log_to(snakemake.log[0], "analyse the results")
write_analysis(open_study(snakemake.input.study), Path(snakemake.output[0]))
