"""Write the page that sets reference numbers of other programs beside ours."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from trackroller.files import write_whole
from validation.pages import Block, page_html
from validation.peers.compare import compare

TITLE = "Other programs beside ours"
HEADS = ("quantity", "compared with", "cases", "median deviation", "largest deviation")


def blocks(found: dict[str, Any]) -> list[Block]:
    """Return the page as blocks of `validation.pages`."""
    rows = [
        (f"`{r['quantity']}`", r["against"], r["cases"], f"{100 * r['median']:.2g} %", f"{100 * r['largest']:.2g} %")
        for r in found["rows"]
    ]
    return [
        ("h1", TITLE),
        (
            "p",
            "Friction forces are compared over μ F_N of the more loaded contact, the spin moment over its larger "
            "value, and all other quantities over their larger value. Full sliding differs from CONTACT because it "
            "neglects elastic displacements; its rows show the size of this assumption, not an error of the program.",
        ),
        ("table", (HEADS, rows)),
        ("list", [f"Left out: {count} {what}." for what, count in found["left_out"].items()]),
    ]


def write_results(folder: Path) -> None:
    """Compare, and write `peers.json` and `peers.html` into a folder."""
    found = compare()
    write_whole(folder / "peers.json", lambda path: path.write_text(json.dumps(found, indent=1) + "\n"))
    page = page_html(blocks(found), folder, TITLE)
    write_whole(folder / "peers.html", lambda path: path.write_text(page, encoding="utf-8"))
