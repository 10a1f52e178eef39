"""Write the report."""

from pathlib import Path

from trackroller.cli.workflow import log_to
from trackroller.report.pages.study import write_report
from trackroller.results.stored_study import open_study
from trackroller.study.store.manifest import check_unaltered

log_to(snakemake.log[0], "write the report")
results = open_study(snakemake.input.study, snakemake.input.sensitivity)
check_unaltered(Path(snakemake.input.figures))
write_report(results, Path(snakemake.output[0]))
