"""What the pages of this room share: templates, marked-up texts, pictures inside a page, and pages
as files.
"""

from __future__ import annotations

import base64
import functools
import html
import os
import re
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from markupsafe import Markup, escape

from trackroller.errors import InputError, WorkError
from trackroller.study.store.put import put, put_text

if TYPE_CHECKING:
    from jinja2 import Template

_KINDS = {".svg": "image/svg+xml", ".png": "image/png"}
_BROWSERS = ("chromium", "chromium-browser", "google-chrome", "chrome", "msedge")
_TOGETHER = 10_000  # values and texts of a template that make one piece
_PATIENCE = 300  # seconds that printing may take
_PRINT = [
    *("--headless", "--disable-gpu", "--no-first-run"),
    *("--disable-background-networking", "--no-pdf-header-footer"),
]
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
    return _template(template, tuple(filters.items())).render(content)


def pieces(template: str, content: dict[str, Any], **filters: Callable[..., Any]) -> Iterator[str]:
    """Yield the text of a template in pieces, so that a long one is never in memory as a whole.

    Parameters are those of `render`.
    """
    stream = _template(template, tuple(filters.items())).stream(content)
    stream.enable_buffering(_TOGETHER)
    yield from stream


@functools.cache
def _template(name: str, filters: tuple[tuple[str, Callable[..., Any]], ...]) -> Template:
    """Return a compiled template; compiling takes half of the time of a drawing, which the live
    page repeats.
    """
    import jinja2  # noqa: PLC0415 - heavy, and a terminal needs no template

    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("trackroller.report", "templates"),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    environment.filters |= {
        "marked": lambda text: Markup(inline(str(text))),
        "symbols": symbols,
    } | dict(filters)
    return environment.get_template(name)


def inline(text: str) -> str:
    """Return a text as HTML: `code` and *emphasis* are marked up, links keep only their words, all
    else is escaped.
    """
    text = re.sub(r"\[([^\]]+)\]\([^)]+\)", r"\1", html.escape(text, quote=False))
    text = re.sub(r"`([^`]+)`", r"<code>\1</code>", text)
    return re.sub(r"\*([^*]+)\*", r"<em>\1</em>", text)


def symbols(text: str) -> Markup:
    """Return a text with Greek letters and subscripts where it holds symbols such as F_N, r_C,G or
    sigma_D.
    """
    escaped = str(escape(text))
    for name, letter in _GREEK.items():
        escaped = re.sub(rf"\b{name}(?=\b|_)", letter, escaped)
    escaped = escaped.replace("_Delta", "_Δ")
    return Markup(re.sub(r"\b(\w)_([A-Za-zΔ0-9]+(?:,[A-Z]+)?)", r"<i>\1</i><sub>\2</sub>", escaped))


def data_uri(path: Path) -> str:
    """Return an SVG or PNG file as a data URI, which stands in a page in place of the file."""
    return (
        f"data:{_KINDS[path.suffix]};base64,{base64.b64encode(path.read_bytes()).decode('ascii')}"
    )


def check_page(path: Path) -> None:
    """Refuse a page whose name ends neither in .html nor in .pdf, and a PDF without a browser that
    prints it.

    Raises
    ------
    InputError
        If the name has another ending.
    WorkError
        If it is a PDF, and neither Chromium, Chrome nor Edge is installed.
    """
    if path.suffix.lower() not in (".html", ".htm", ".pdf"):
        raise InputError(
            "report", str(path), "a file whose name ends in .html or .pdf", "Change the name."
        )
    if path.suffix.lower() == ".pdf" and _browser() is None:
        remedy = "Install one of them, or write a page: give a name that ends in .html."
        raise WorkError(
            f"{path}: Chromium, Chrome or Edge prints a PDF, and none of them was found. {remedy}"
        )


def write_page(path: Path, text: str) -> Path:
    """Write a page as HTML, or print it as PDF if the name of the file ends in .pdf, and return its
    path.

    Raises
    ------
    InputError, WorkError
        As `check_page`, or if the browser does not print.
    """
    check_page(path)
    if path.suffix.lower() == ".pdf":
        return put(path, lambda beside: _print(text, beside))
    return put_text(path, text)


def _browser() -> str | None:
    return next(filter(None, map(shutil.which, _BROWSERS)), None)


def _print(text: str, path: Path) -> None:
    """Print a page by a headless browser with a profile of its own."""
    with tempfile.TemporaryDirectory(
        prefix="trackroller-print-", ignore_cleanup_errors=True
    ) as place:
        page = Path(place, "page.html")
        pdf = Path(place, "page.pdf")
        page.write_text(text, encoding="utf-8")
        # root has no sandbox
        alone = []
        if getattr(os, "geteuid", lambda: 1)() == 0:
            alone = ["--no-sandbox"]
        own = [f"--user-data-dir={place}/profile", f"--print-to-pdf={pdf}", page.as_uri()]
        try:
            subprocess.run(
                [str(_browser()), *_PRINT, *alone, *own],
                capture_output=True,
                timeout=_PATIENCE,
                check=True,
            )
            shutil.copyfile(pdf, path)
        except (subprocess.SubprocessError, OSError) as exc:
            raise WorkError(
                f"{_browser()} does not print the page: {exc}. Give a name that ends in .html."
            ) from exc
