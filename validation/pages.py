"""Pages of headings, paragraphs, tables and figures, as Markdown for the documentation and as one HTML file.

A page is a list of blocks (kind, value): 'h1' to 'h3' and 'p' hold text with `code`, *emphasis* and links as in
Markdown, 'list' several such texts; 'table' holds (heads, rows); 'figure' a mapping with name, caption and sentence of
a PNG.
"""

from __future__ import annotations

import base64
import html
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from trackroller.report.html import inline

Block = tuple[str, Any]


def markdown(content: Sequence[Block], made_by: str, folder: str = "figures") -> str:
    """Return the page as Markdown with figures from a folder beside it."""
    lines = [f"<!-- {made_by}; do not edit -->"]
    for kind, value in content:
        if kind in ("h1", "h2", "h3"):
            lines += [f"{'#' * int(kind[1])} {value}", ""]
        elif kind == "p":
            lines += [value, ""]
        elif kind == "list":
            lines += [*(f"- {text}" for text in value), ""]
        elif kind == "figure":
            lines += [f"![{value['caption']}]({folder}/{value['name']}.png)", "", f"*{value['sentence']}*", ""]
        else:
            heads, rows = value
            for cells in (heads, ["---"] * len(heads), *rows):
                lines.append("| " + " | ".join(str(c).replace("|", "\\|") for c in cells) + " |")
            lines.append("")
    return "\n".join(lines).rstrip() + "\n"


_CSS = (
    "body{font:15px/1.5 sans-serif;max-width:60em;margin:2em auto;padding:0 1em}table{border-collapse:collapse;"
    "font-size:12px;display:block;overflow-x:auto}td,th{border:1px solid #ccc;padding:2px 7px;text-align:left}"
    "img{max-width:100%;width:24em}figure{display:inline-block;margin:.5em;vertical-align:top;width:24em}"
    "figcaption{font-size:12px}"
)


def page_html(content: Sequence[Block], figures: Path, title: str) -> str:
    """Return the page as one HTML file that holds its figures."""
    body = []
    for kind, value in content:
        if kind in ("h1", "h2", "h3", "p"):
            body.append(f"<{kind}>{inline(value)}</{kind}>")
        elif kind == "list":
            body.append("<ul>" + "".join(f"<li>{inline(text)}</li>" for text in value) + "</ul>")
        elif kind == "figure":
            data = base64.b64encode((figures / f"{value['name']}.png").read_bytes()).decode()
            body.append(
                f'<figure><img alt="{html.escape(value["caption"])}" src="data:image/png;base64,{data}">'
                f"<figcaption>{inline(value['caption'])} {inline(value['sentence'])}</figcaption></figure>"
            )
        else:
            heads, rows = value
            cells = ["<tr>" + "".join(f"<th>{inline(h)}</th>" for h in heads) + "</tr>"]
            cells += ["<tr>" + "".join(f"<td>{inline(str(c))}</td>" for c in row) + "</tr>" for row in rows]
            body.append("<table>" + "".join(cells) + "</table>")
    return (
        f'<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><title>{html.escape(title)}</title>'
        f"<style>{_CSS}</style></head><body>{''.join(body)}</body></html>\n"
    )
