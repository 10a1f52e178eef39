"""Typeset the formulas of the documentation as MathML while MkDocs builds the site, and keep its search at home.

A fenced block `math` holds one formula a line, in LaTeX. Behind `%` stand its number in the publication in parentheses,
what it is, and behind `|` the file of `trackroller/` that computes it; each of the three may be left out:

    h_N = A_T \\sin\\alpha  % (13) lever arm | roller/geometry.py

Between words, `$...$` holds a formula. No script is needed to read formulas.

The search runs from file:// too. The theme takes a stand-in for Worker from another server there; `assets/worker.js`
replaces it. MkDocs calls the functions `on_...` (the key `hooks` of mkdocs.yml).
"""

from __future__ import annotations

import html
import re
from typing import Any, NamedTuple
from xml.etree.ElementTree import Element

from latex2mathml.converter import convert
from markdown import Markdown
from markdown.extensions import Extension
from markdown.inlinepatterns import InlineProcessor
from mkdocs.utils import get_relative_url
from pymdownx.superfences import SuperFencesException

NUMBERS = re.compile(r"(?:\(\d+\)[-, ]*)+")
BETWEEN_WORDS = r"\$(?=\S)([^$\n]+?)(?<=\S)\$"


class Formula(NamedTuple):
    """One line of a block; what is left out is empty."""

    latex: str
    number: str
    words: str
    file: str


def formula(line: str) -> Formula:
    """Return the parts of a line of a block `math`.

    Raises
    ------
    SuperFencesException
        If the line holds no formula; MkDocs stops then.
    """
    latex, _, note = (part.strip() for part in line.partition("%"))
    if not latex:
        raise SuperFencesException(f"no formula: {line!r}; write LaTeX % (number) words | file")
    numbers = NUMBERS.match(note)
    words, _, file = note[numbers.end() if numbers else 0 :].partition("|")
    return Formula(latex, numbers[0].strip() if numbers else "", words.strip(), file.strip())


def mathml(latex: str, display: str) -> str:
    """Return the MathML of a formula in LaTeX; `display` is "block" or "inline"."""
    return convert(latex, display=display)


def block(source: str, *_: Any, **__: Any) -> str:
    """Return the HTML of a fenced block `math`: a row for each formula."""
    rows = []
    for one in map(formula, filter(str.strip, source.splitlines())):
        file = f" <code>{html.escape(one.file)}</code>" if one.file else ""
        rows.append(
            f'<div class="formula"><div class="typeset">{mathml(one.latex, "block")}</div>'
            f'<div class="number">{html.escape(one.number)}</div>'
            f'<div class="words">{html.escape(one.words)}{file}</div></div>'
        )
    return f'<div class="formulas">{"".join(rows)}</div>'


class _Inline(InlineProcessor):
    def handleMatch(self, m: re.Match[str], data: str) -> tuple[str | Element, int, int]:
        """Return the MathML in place of `$...$`."""
        shown = f'<span class="inline-formula">{mathml(m[1], "inline")}</span>'
        return self.md.htmlStash.store(shown), m.start(0), m.end(0)


class Formulas(Extension):
    """The extension of Markdown that typesets formulas between words; code in backticks stays as it is."""

    def extendMarkdown(self, md: Markdown) -> None:
        """Register the pattern behind that of code (190)."""
        md.inlinePatterns.register(_Inline(BETWEEN_WORDS, md), "formula", 180)


def on_config(config: Any) -> Any:
    """Add the block `math` and the formulas between words to the Markdown of the site."""
    fences = config.mdx_configs.setdefault("pymdownx.superfences", {})
    fences["custom_fences"] = [{"name": "math", "class": "math", "format": block}]
    config.markdown_extensions.append(Formulas())
    return config


def on_post_page(output: str, page: Any, **_: Any) -> str:
    """Take the stand-in for Worker from the site instead of another server."""
    return _own_worker(output, page.url)


def on_post_template(output: str, template_name: str, **_: Any) -> str:
    """Do the same in 404.html, which is no page."""
    return _own_worker(output, template_name)


def _own_worker(output: str, url: str) -> str:
    return output.replace("https://unpkg.com/iframe-worker/shim", get_relative_url("assets/worker.js", url))
