"""One look for all figures: true printed sizes, colours and marks that survive grey print and colour blindness.

Figures are built without pyplot, so that drawing needs no display and leaves the caller's own figures alone.
"""

from __future__ import annotations

import contextlib
import io
import json
import logging
import math
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

import matplotlib
import seaborn
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import TextToPath
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter, NullLocator

from trackroller.files import write_text, write_whole
from trackroller.report.numbers import number

log = logging.getLogger("trackroller")
COLUMN_MM = 85.0  # a column of a two-column page
WIDE_MM = 170.0  # the one wide column of the report
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "<", ">", "*")
LINES: tuple[Any, ...] = ("-", "--", ":", "-.", (0, (5, 1, 1, 1, 1, 1)), (0, (1, 1)))
REGIME_COLOURS = ("#f2f2f2", "#f0c36d", "#5b8db8", "#4d4d4d")
REGIME_HATCHES = ("", "////", "xxxx", "")
_RC: dict[Any, Any] = {
    "font.size": 7.5,
    "axes.titlesize": 8.0,
    "axes.labelsize": 7.5,
    "xtick.labelsize": 7.0,
    "ytick.labelsize": 7.0,
    "legend.fontsize": 7.0,
    "legend.title_fontsize": 7.0,
    "figure.titlesize": 8.5,
    "axes.linewidth": 0.7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "lines.linewidth": 1.2,
    "lines.markersize": 4.0,
    "grid.linewidth": 0.4,
    "xtick.major.width": 0.7,
    "ytick.major.width": 0.7,
    "xtick.minor.width": 0.5,
    "ytick.minor.width": 0.5,
    "xtick.major.size": 3.0,
    "ytick.major.size": 3.0,
    "hatch.linewidth": 0.6,
    "patch.linewidth": 0.6,
    "font.family": ["DejaVu Sans"],
    "mathtext.fontset": "dejavusans",
    "legend.frameon": False,
    "legend.handlelength": 2.4,
    "legend.borderaxespad": 0.2,
    "legend.columnspacing": 1.2,
    "svg.fonttype": "path",
    "svg.hashsalt": "trackroller",
    "savefig.dpi": 300,
}


@dataclass(frozen=True)
class FigureInfo:
    """A drawn figure: file stem, what it shows (caption), and the one thing to take from it (sentence)."""

    name: str
    caption: str
    sentence: str


Drawn = tuple[Figure, FigureInfo] | None  # what a figure's function returns; None without anything to show


@contextlib.contextmanager
def look() -> Iterator[None]:
    """Set the common style for everything drawn inside; it is restored afterwards."""
    style: dict[Any, Any] = dict(seaborn.axes_style("ticks"))
    style.update({"axes.grid": True, "grid.color": "0.88"})
    style.update(_RC)
    with matplotlib.rc_context(style):
        yield


def palette(count: int) -> list[Any]:
    """Return `count` colours that colour-blind readers tell apart.

    After eight they repeat.
    """
    colours = seaborn.color_palette("colorblind")
    dark = [colours[i] for i in (0, 1, 2, 3, 4, 5, 7, 9)]
    return [dark[i % len(dark)] for i in range(max(count, 1))]


def new_figure(height_mm: float, width_mm: float = WIDE_MM) -> Figure:
    """Return an empty figure of true printed size [mm] whose parts are laid out without overlap."""
    figure = Figure(figsize=(width_mm / 25.4, height_mm / 25.4), layout="constrained")
    engine: Any = figure.get_layout_engine()
    engine.set(w_pad=0.03, h_pad=0.03)
    return figure


def wrapped(text: str, width_mm: float, size: float, weight: str = "normal") -> list[str]:
    """Break a text into lines that are no wider than `width_mm` when set in `size` points."""
    font, measure, limit = FontProperties(size=size, weight=weight), TextToPath(), width_mm / 25.4 * 72
    lines: list[str] = []
    for word in text.split(" "):
        longer = f"{lines[-1]} {word}" if lines else word
        if lines and measure.get_text_width_height_descent(longer, font, False)[0] <= limit:
            lines[-1] = longer
        else:
            lines.append(word)
    return lines


def head(figure: Figure, title: str, subtitle: str = "") -> None:
    """Write the title in bold and the subtitle under it, wrapped so that nothing runs out of the figure."""
    width = float(figure.get_figwidth()) * 25.4 - 3
    lines = wrapped(title, width, 7.5, "bold")
    small = wrapped(subtitle, width, 7.0) if subtitle else []
    figure.suptitle("\n".join([" "] * len(lines) + small), x=0.015, ha="left", fontsize=7.0, linespacing=1.25)
    figure._trackroller_title = "\n".join(lines)  # type: ignore[attr-defined]


def _lay_out(figure: Figure) -> None:
    """Lay out a figure once for both of its files, and set its title."""
    figure.draw_without_rendering()
    figure.set_layout_engine("none")
    # the layout moves one super title only, in one weight: the bold lines are laid over its blank ones
    title, room = getattr(figure, "_trackroller_title", ""), getattr(figure, "_suptitle", None)
    if not title or room is None:
        return
    top = room.get_window_extent().transformed(figure.transFigure.inverted()).y1
    look: dict[str, Any] = {"fontsize": 7.5, "fontweight": "bold", "linespacing": 1.17, "in_layout": False}
    figure.text(0.015, top, title, ha="left", va="top", **look)
    figure._trackroller_title = ""  # type: ignore[attr-defined]


def log_ticks(axis: Any, low: float, high: float) -> None:
    """Set ticks of a logarithmic axis.

    Decades when there are many, 1-2-5 with plain numbers when there are few.
    """
    axis.set_minor_formatter(NullFormatter())
    decades = math.log10(high / low) if low > 0 and high > low else 0.0
    if not 0 < decades <= 1.6:
        return
    few = decades < 0.7
    axis.set_major_locator(MaxNLocator(5, steps=[1, 2, 2.5, 5, 10]) if few else LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.set_major_formatter(FuncFormatter(lambda value, _: number(float(f"{value:.3g}"))))
    axis.set_minor_locator(NullLocator())


def save(figure: Figure, out_dir: Path, name: str) -> tuple[Path, Path]:
    """Write `name`.svg and `name`.png, both whole or not at all, and return the two paths."""
    _lay_out(figure)
    paths = out_dir / f"{name}.svg", out_dir / f"{name}.png"
    for path in paths:
        metadata = {"Date": None} if path.suffix == ".svg" else None  # the same data gives the same file
        drawn = io.BytesIO()
        figure.savefig(drawn, format=path.suffix[1:], metadata=metadata)
        write_whole(path, partial(Path.write_bytes, data=drawn.getvalue()))
    return paths


def draw_all(jobs: Iterable[Callable[[], Drawn]], out_dir: Path) -> list[FigureInfo]:
    """Draw and save figures, and return what each shows; leave out those without content.

    Raises
    ------
    WorkError
        If the folder cannot be written.
    """
    infos: list[FigureInfo] = []
    with look(), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # empty slices and all-NaN panels are expected here
        for number, draw in enumerate(jobs, 1):
            log.info("draw figure %d", number)
            if (drawn := draw()) is not None:
                save(drawn[0], out_dir, drawn[1].name)
                infos.append(drawn[1])
    return infos


def write_index(infos: Sequence[FigureInfo], out_dir: Path, name: str = "index.json") -> Path:
    """Write captions and sentences of the figures in `out_dir`, for the report."""
    write_text(out_dir / name, json.dumps([asdict(i) for i in infos], indent=1, ensure_ascii=False) + "\n")
    return out_dir / name
