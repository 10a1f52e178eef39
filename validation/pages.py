"""Write the pages of the documentation that show measured numbers.

Each page has a template in `validation/templates` (Jinja). A template states no measured number itself: it takes every
number from a file of `docs/data`, which stands under its name without the ending, from the functions of its evidence
(`FACTS`) or from the package.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import jinja2

from trackroller.report.numbers import rounded
from validation.benchmarks import programs
from validation.extremes import page as extremes
from validation.measured import page as against
from validation.paper import page as paper
from validation.tradeoff import page as tradeoff

TEMPLATES = Path(__file__).with_name("templates")
DOCS = Path(__file__).resolve().parents[1] / "docs"
FACTS: dict[str, Callable[[Mapping[str, Any]], dict[str, Any]]] = {
    "paper.md": paper.facts,
    "tradeoff.md": tradeoff.facts,
    "extremes.md": extremes.facts,
    "measured.md": against.facts,
    "benchmark.md": against.benchmark_facts,
}


def percent(share: float, figures: int = 2) -> str:
    """Return a share as per cent in so many figures, '0.032 %'."""
    return f"{rounded(100 * share, figures)} %"


def ratio(value: float) -> str:
    """Return a ratio in two figures, as '6.3' or '12,000'."""
    return rounded(value, 2)


def pair(value: Any, digits: int | None = None) -> str:
    """Return a number, or the numbers of both contacts, with so many digits after the point; %g without."""
    values = value if isinstance(value, list) else [value]
    return " / ".join(f"{v:g}" if digits is None else f"{v:.{digits}f}" for v in values)


def peer(rows: list[dict[str, Any]], quantity: str, against: str) -> dict[str, Any]:
    """Return the row of a comparison with other programs."""
    return next(r for r in rows if r["quantity"] == quantity and r["against"] == against)


def table(heads: Sequence[object], rows: Iterable[Sequence[object]]) -> str:
    """Return a table in Markdown."""
    lines = (heads, ["---"] * len(heads), *rows)
    return "\n".join("| " + " | ".join(str(cell).replace("|", "\\|") for cell in cells) + " |" for cells in lines)


def pictures(figures: Iterable[Mapping[str, str]], part: str = "") -> str:
    """Return the figures of an index whose names hold `part`, each with its caption and its sentence."""
    shown = [f for f in figures if part in f["name"]]
    return "\n\n".join(f"![{f['caption']}](../figures/{f['name']}.png)\n\n*{f['sentence']}*" for f in shown)


def measured() -> dict[str, Any]:
    """Return what the templates may use: every data file by its name, and the functions of this module."""
    data = {path.stem: json.loads(path.read_text(encoding="utf-8")) for path in (DOCS / "data").glob("*.json")}
    return data | {"programs": programs(), "peer": peer, "table": table, "pictures": pictures}


def render(name: str, **more: Any) -> str:
    """Return the text of a page.

    Parameters
    ----------
    name : str
        File of the template, such as "accuracy.md".
    **more
        Further values for the template.

    Returns
    -------
    str
        Markdown, beginning with a remark that names the template.
    """
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(TEMPLATES),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters |= {"percent": percent, "ratio": ratio, "rounded": rounded, "pair": pair}
    values = measured() | more
    if name in FACTS:
        values |= FACTS[name](values)
    made_by = f"<!-- made by docs/generate.py from validation/templates/{name} and docs/data; do not edit -->\n"
    return made_by + environment.get_template(name).render(values)
