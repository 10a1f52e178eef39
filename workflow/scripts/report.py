"""Write the report."""

from pathlib import Path

from trackroller.cli.workflow import log_to
from trackroller.report.build import write_pages
from trackroller.solved import open_study
from trackroller.study.store.seal import check_sealed

log_to(snakemake.log[0], "write the report")
solved = open_study(snakemake.input.study, snakemake.input.sensitivity)
write_pages(solved.analysed_view, check_sealed(Path(snakemake.input.figures)), Path(snakemake.output[0]))
