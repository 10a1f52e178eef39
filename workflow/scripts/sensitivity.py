"""Analyse what decides the results."""

from trackroller.cli.workflow import log_to
from trackroller.report.build import analyse_study

log_to(snakemake.log[0], "analyse the results")
analyse_study(snakemake.input.study, snakemake.output[0])
