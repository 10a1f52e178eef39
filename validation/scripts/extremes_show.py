"""Draw the extremes and write their page."""

from pathlib import Path

from trackroller.cli.workflow import log_to
from validation.extremes.figures import draw_extremes
from validation.extremes.page import html, read

log_to(snakemake.log[0])
page = Path(snakemake.output.page)
figures = Path(snakemake.output.figures)
record, _ = read(page.parent, figures=False)
draw_extremes(record, figures)
record, infos = read(page.parent)
page.write_text(html(record, infos, figures), encoding="utf-8")
