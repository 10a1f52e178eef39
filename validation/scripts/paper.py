"""The published example computed anew: numbers, figures and page."""

from pathlib import Path

from trackroller.cli.workflow import log_to
from validation.paper.page import write_results

log_to(snakemake.log[0])
write_results(Path(snakemake.output.data).parent)
