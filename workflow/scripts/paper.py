"""The published example computed anew: numbers, figures and page."""

from pathlib import Path

from trackroller.paper_page import write_results
from trackroller.workflow import log_to

log_to(snakemake.log[0])
write_results(Path(snakemake.output.data).parent)
