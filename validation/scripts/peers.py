"""Compare with the reference numbers of other programs and write the page."""

from pathlib import Path

from trackroller.cli.workflow import log_to
from validation.peers.page import write_results

log_to(snakemake.log[0])
write_results(Path(snakemake.output.data).parent)
