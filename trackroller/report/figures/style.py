"""One look for all figures: true printed sizes, colours and marks that survive grey print and
colour blindness.

Figures are built without pyplot, so that drawing needs no display and leaves the caller's own
figures alone.
"""

from __future__ import annotations

import io
import json
import logging
import math
import warnings
import zlib
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

import matplotlib
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter, NullLocator

from trackroller.files import write_text, write_whole
from trackroller.materials import builtin_database
from trackroller.report.figures.levels import material_of_level, short_levels
from trackroller.report.numbers import number

log = logging.getLogger("trackroller")
COLUMN_MM = 85.0  # a column of a two-column page
WIDE_MM = 170.0  # the one wide column of the report
# seaborn's palette for colour-blind readers without its two faintest colours
COLOURS = ("#0173b2", "#de8f05", "#029e73", "#d55e00", "#cc78bc", "#ca9161", "#949494", "#56b4e9")
PAIR = ("#12355b", "#b0476f")  # both contacts, or roller and guide: no material has these colours
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "<", ">", "*")
LINES: tuple[Any, ...] = ("-", "--", ":", "-.", (0, (5, 1, 1, 1, 1, 1)), (0, (1, 1)))
REGIME_COLOURS = ("#f2f2f2", "#f0c36d", "#5b8db8", "#4d4d4d")
REGIME_HATCHES = ("", "////", "xxxx", "")


@dataclass(frozen=True)
class FigureInfo:
    """A drawn figure: file stem, what it shows (caption), and its finding (sentence) where the page
    has no other.
    """

    name: str
    caption: str
    sentence: str = ""


# what a figure's function returns; None without anything to show
Drawn = tuple[Figure, FigureInfo] | None


def look() -> Any:
    """Return a context that sets the common style for everything drawn inside; it is restored
    afterwards.
    """
    return matplotlib.rc_context(fname=Path(__file__).with_name("trackroller.mplstyle"))


def palette(count: int) -> list[str]:
    """Return `count` colours that colour-blind readers tell apart.

    After eight they repeat.
    """
    return [COLOURS[i % len(COLOURS)] for i in range(max(count, 1))]


def colours(texts: Sequence[str], materials: bool) -> list[str]:
    """Return a colour for each level of a factor.

    A material has the same colour in all figures of all studies. Of pairs that share the roller's
    material, the material of the guide counts.

    Parameters
    ----------
    texts : sequence of str
        The levels in words.
    materials : bool
        Whether the levels are materials or pairs of materials.
    """
    if not materials:
        return palette(len(texts))
    known = builtin_database().names()
    names = [material_of_level(text) for text in short_levels(texts)]
    spare = len(COLOURS) - len(known)
    places = [
        known.index(n) if n in known else len(known) + zlib.crc32(n.encode()) % spare for n in names
    ]
    return [COLOURS[place % len(COLOURS)] for place in places]


def new_figure(height_mm: float, width_mm: float = WIDE_MM) -> Figure:
    """Return an empty figure of true printed size [mm] whose parts are laid out without overlap."""
    figure = Figure(figsize=(width_mm / 25.4, height_mm / 25.4), layout="constrained")
    engine: Any = figure.get_layout_engine()
    engine.set(w_pad=0.03, h_pad=0.03)
    return figure


def head(figure: Figure, title: str, subtitle: str = "") -> None:
    """Write the title and the subtitle above the figure, in as many lines as its width needs."""
    figure.suptitle("\n".join(filter(None, (title, subtitle))), x=0.015, ha="left", wrap=True)


def panels(title: str, height_mm: float, count: int = 1, **shared: Any) -> tuple[Figure, Any]:
    """Return a figure with its title, and its empty axes side by side; `shared` says which axes
    they share.
    """
    figure = new_figure(height_mm)
    head(figure, title)
    return figure, figure.subplots(1, count, squeeze=False, **shared)[0]


def colour_bar(figure: Figure, image: Any, axes: Sequence[Axes], label: str) -> None:
    """Draw the scale of the colours below maps."""
    figure.colorbar(
        image, ax=axes, location="bottom", aspect=60, pad=0.02, ticks=MaxNLocator(6), label=label
    )


def log_ticks(axis: Any, low: float, high: float) -> None:
    """Set ticks of a logarithmic axis.

    An axis over many powers of ten has a tick at each power, an axis over few has plain numbers
    such as 1, 2 and 5.
    """
    axis.set_minor_formatter(NullFormatter())
    powers = 0.0
    if low > 0 and high > low:
        powers = math.log10(high / low)
    if not 0 < powers <= 1.6:
        return
    if powers < 0.7:
        axis.set_major_locator(MaxNLocator(5, steps=[1, 2, 2.5, 5, 10]))
    else:
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.set_major_formatter(FuncFormatter(lambda value, _: number(float(f"{value:.3g}"))))
    axis.set_minor_locator(NullLocator())


def save(figure: Figure, out_dir: Path, name: str) -> tuple[Path, Path]:
    """Write `name`.svg and `name`.png, both whole or not at all, and return the two paths."""
    figure.draw_without_rendering()
    # both files have the same layout; with "none" each would be drawn twice
    figure.set_layout_engine(None)
    paths = out_dir / f"{name}.svg", out_dir / f"{name}.png"
    for path in paths:
        # the same data gives the same file
        metadata = None
        if path.suffix == ".svg":
            metadata = {"Date": None}
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
            drawn = draw()
            if drawn is not None:
                figure, info = drawn
                save(figure, out_dir, info.name)
                infos.append(info)
    return infos


def write_index(infos: Sequence[FigureInfo], out_dir: Path) -> Path:
    """Write captions and sentences of the figures in `out_dir`, for the report."""
    write_text(
        out_dir / "index.json",
        json.dumps([asdict(i) for i in infos], indent=1, ensure_ascii=False) + "\n",
    )
    return out_dir / "index.json"
