"""What the pages of this room share: templates, marked-up texts and pictures inside a page."""

from __future__ import annotations

import base64
import html
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jinja2
from markupsafe import Markup, escape

_KINDS = {".svg": "image/svg+xml", ".png": "image/png"}
_GREEK = {"alpha": "α", "mu": "μ", "nu": "ν", "sigma": "σ", "tau": "τ", "xi": "ξ"}


def render(template: str, content: dict[str, Any], **filters: Callable[..., Any]) -> str:
    """Return the HTML of a template of this room.

    Parameters
    ----------
    template : str
        Name of the file in `templates/`.
    content : dict
        Variables of the template; a variable that is missing raises an error.
    **filters : callable
        Filters of the template beside `marked` and `symbols`, by name.
    """
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("trackroller.report", "templates"),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    environment.filters |= {"marked": lambda text: Markup(inline(str(text))), "symbols": symbols} | filters
    return environment.get_template(template).render(content)


def inline(text: str) -> str:
    """Return a text as HTML: `code` and *emphasis* are marked up, links keep only their words, all else is escaped."""
    text = re.sub(r"\[([^\]]+)\]\([^)]+\)", r"\1", html.escape(text, quote=False))
    text = re.sub(r"`([^`]+)`", r"<code>\1</code>", text)
    return re.sub(r"\*([^*]+)\*", r"<em>\1</em>", text)


def symbols(text: str) -> Markup:
    """Return a text with Greek letters and subscripts where it holds symbols such as F_N, r_C,G or sigma_D."""
    told = str(escape(text))
    for name, letter in _GREEK.items():
        told = re.sub(rf"\b{name}(?=\b|_)", letter, told)
    told = told.replace("_Delta", "_Δ")
    return Markup(re.sub(r"\b(\w)_([A-Za-zΔ0-9]+(?:,[A-Z]+)?)", r"<i>\1</i><sub>\2</sub>", told))


def data_uri(path: Path) -> str:
    """Return an SVG or PNG file as a data URI, which stands in a page in place of the file."""
    return f"data:{_KINDS[path.suffix]};base64,{base64.b64encode(path.read_bytes()).decode('ascii')}"
