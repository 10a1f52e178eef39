"""Write the pages of the documentation that mix sentences with measured numbers.

Each page has a template in `validation/templates` (Jinja). A template states no measured number itself: it takes every
number from a file of `docs/data`, which stands under its name without the ending, from the paper's results or from the
package.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import jinja2

from trackroller.report.numbers import rounded
from validation.benchmarks import programs
from validation.paper.compute import stored

TEMPLATES = Path(__file__).with_name("templates")
DOCS = Path(__file__).resolve().parents[1] / "docs"


def percent(share: float, figures: int = 2) -> str:
    """Return a share as per cent in so many figures, '0.032 %'."""
    return f"{rounded(100 * share, figures)} %"


def ratio(value: float) -> str:
    """Return a ratio in two figures, as '6.3' or '12,000'."""
    return rounded(value, 2)


def peer(rows: list[dict[str, Any]], quantity: str, against: str) -> dict[str, Any]:
    """Return the row of a comparison with other programs."""
    return next(r for r in rows if r["quantity"] == quantity and r["against"] == against)


def measured() -> dict[str, Any]:
    """Return what the templates may use: every data file by its name, and the paper's results as `paper`."""
    data = {path.stem: json.loads(path.read_text(encoding="utf-8")) for path in (DOCS / "data").glob("*.json")}
    return data | {"paper": stored(), "programs": programs(), "peer": peer}


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
    environment.filters |= {"percent": percent, "ratio": ratio, "rounded": rounded}
    made_by = f"<!-- made by docs/generate.py from validation/templates/{name} and docs/data; do not edit -->\n"
    return made_by + environment.get_template(name).render(measured() | more)
