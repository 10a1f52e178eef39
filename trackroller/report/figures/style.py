"""One look for all figures: 85 mm columns, colours and marks that survive grey print and colour blindness.

Figures are built without pyplot, so that drawing needs no display and leaves the caller's own figures alone.
"""

from __future__ import annotations

import contextlib
import json
import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from trackroller.parameters import MAPPING_FIELDS, PARAMETERS
from trackroller.study.design.levels import short

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COLUMN_MM = 85.0  # width of a column of a two-column page
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "<", ">", "*")
LINES: tuple[Any, ...] = ("-", "--", ":", "-.", (0, (5, 1, 1, 1, 1, 1)), (0, (1, 1)))
REGIME_LABELS = ("rolling", "full slip", "lift-off", "failed")
REGIME_COLOURS = ("#f2f2f2", "#f0c36d", "#5b8db8", "#4d4d4d")
REGIME_HATCHES = ("", "////", "xxxx", "")
UNITS = {
    "1": "–",
    "-": "–",
    "degree": "°",
    "deg": "°",
    "m min-1": "m/min",
    "h-1": "1/h",
    "J m-1": "J/m",
    "N mm": "N·mm",
}
SYMBOLS = {
    "A_T": r"$A_\mathrm{T}$",
    "r_C,G": r"$r_\mathrm{C,G}$",
    "r_C,TR": r"$r_\mathrm{C,TR}$",
    "r_Curve": r"$r_\mathrm{Curve}$",
    "alpha": r"$\alpha$",
    "F_rad": r"$F_\mathrm{rad}$",
    "F_ax": r"$F_\mathrm{ax}$",
    "F_Motor": r"$F_\mathrm{Motor}$",
    "mu": r"$\mu$",
    "v": r"$v$",
    "n_G": r"$n_\mathrm{G}$",
}

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
    "axes.formatter.use_mathtext": True,
    "legend.frameon": False,
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


@contextlib.contextmanager
def look() -> Iterator[None]:
    """The common style for everything drawn inside; restored afterwards."""
    import matplotlib
    import seaborn

    style: dict[Any, Any] = dict(seaborn.axes_style("ticks"))
    style.update({"axes.grid": True, "grid.color": "0.88"})
    style.update(_RC)
    with matplotlib.rc_context(style):
        yield


def palette(count: int) -> list[Any]:
    """`count` colours that colour-blind readers tell apart, without those too light for a line; after eight again."""
    import seaborn

    colours = seaborn.color_palette("colorblind")
    dark = [colours[i] for i in (0, 1, 2, 3, 4, 5, 7, 9)]
    return [dark[i % len(dark)] for i in range(max(count, 1))]


def new_figure(height_mm: float, width_mm: float = COLUMN_MM) -> Figure:
    """An empty figure of true printed size [mm] whose parts are laid out without overlap."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width_mm / 25.4, height_mm / 25.4), layout="constrained")
    engine: Any = figure.get_layout_engine()
    engine.set(w_pad=0.03, h_pad=0.03)
    return figure


def wrapped(text: str, width_mm: float, size: float, weight: str = "normal") -> list[str]:
    """Lines of `text` that are no wider than `width_mm` when set in `size` points."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import TextToPath

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
    """Title in bold and, under it, what was held; wrapped so that nothing runs out of the figure."""
    width = float(figure.get_figwidth()) * 25.4 - 3
    lines = wrapped(title, width, 7.5, "bold")
    small = wrapped(subtitle, width, 7.0)
    figure.suptitle("\n".join([" "] * len(lines) + small), x=0.015, ha="left", fontsize=7.0, linespacing=1.25)
    figure._trackroller_title = "\n".join(lines)  # type: ignore[attr-defined]


def _set_title(figure: Figure) -> None:
    # the layout moves one super title only, in one weight: the bold lines are laid over its blank ones
    title, room = getattr(figure, "_trackroller_title", ""), getattr(figure, "_suptitle", None)
    if not title or room is None:
        return
    figure.draw_without_rendering()
    top = room.get_window_extent().transformed(figure.transFigure.inverted()).y1
    figure.text(
        0.015, top, title, ha="left", va="top", fontsize=7.5, fontweight="bold", linespacing=1.17, in_layout=False
    )
    figure._trackroller_title = ""  # type: ignore[attr-defined]


def log_ticks(axis: Any, low: float, high: float) -> None:
    """Ticks of a logarithmic axis: decades when there are many, 1-2-5 with plain numbers when there are few."""
    from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter, NullLocator

    axis.set_minor_formatter(NullFormatter())
    decades = math.log10(high / low) if low > 0 and high > low else 0.0
    if not 0 < decades <= 1.6:
        return
    few = decades < 0.7
    axis.set_major_locator(MaxNLocator(5, steps=[1, 2, 2.5, 5, 10]) if few else LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.set_major_formatter(FuncFormatter(lambda value, _: number(float(f"{value:.3g}"))))
    axis.set_minor_locator(NullLocator())


def finish(figure: Figure) -> None:
    """Take the right and upper spines away where there is no twin axis."""
    for axes in figure.axes:
        for side in ("top", "right"):
            if side in axes.spines:
                axes.spines[side].set_visible(axes.get_label() == "<colorbar>")


def save(figure: Figure, out_dir: Path, name: str) -> tuple[Path, Path]:
    """Write `name`.svg and `name`.png; both whole or not at all. Result: the two paths."""
    out_dir.mkdir(parents=True, exist_ok=True)
    _set_title(figure)
    paths = out_dir / f"{name}.svg", out_dir / f"{name}.png"
    for path in paths:
        part = path.with_name(f".{path.name}.part")
        metadata = {"Date": None} if path.suffix == ".svg" else None  # the same data gives the same file
        figure.savefig(part, format=path.suffix[1:], metadata=metadata)
        part.replace(path)
    return paths


def write_index(infos: Sequence[FigureInfo], out_dir: Path, name: str = "index.json") -> Path:
    """Captions and sentences of the figures in `out_dir`, for the report."""
    out_dir.mkdir(parents=True, exist_ok=True)
    path = out_dir / name
    part = path.with_name(f".{name}.part")
    part.write_text(json.dumps([asdict(i) for i in infos], indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    part.replace(path)
    return path


def unit_text(units: str) -> str:
    """A CF unit as a reader expects it."""
    return UNITS.get(units, units)


def with_unit(text: str, units: str) -> str:
    """Axis label: quantity and its unit in brackets."""
    return f"{text} [{unit_text(units)}]"


def plain(name: str) -> str:
    """A name without underscores."""
    return name.replace("_", " ")


def capital(text: str) -> str:
    """Text with a capital first letter, the rest as it is."""
    return text[:1].upper() + text[1:]


def long_name(name: str) -> str:
    """A factor in words, for running text."""
    if name == "normal":  # an option, whose name alone says little
        return "normal problem"
    return PARAMETERS[name].long_name if name in PARAMETERS else plain(name)


def factor_label(name: str, units: str | None = None) -> str:
    """Axis label of a factor: long name, symbol, unit."""
    parameter = PARAMETERS.get(name)
    if parameter is None:
        return with_unit(capital(plain(name)), units) if units else capital(plain(name))
    text = parameter.long_name[0].upper() + parameter.long_name[1:]
    return with_unit(f"{text} {SYMBOLS.get(parameter.symbol, parameter.symbol)}", parameter.unit)


def number(value: float) -> str:
    """A number in at most four figures, thousands as 12 300 and large ones as 1.2e+09."""
    if value is None or math.isnan(value):
        return "–"
    if math.isinf(value):
        return "∞" if value > 0 else "−∞"
    size = abs(value)
    if size >= 1e6 or (0 < size < 1e-3):
        mantissa, exponent = f"{value:.1e}".split("e")
        return f"{mantissa.replace('-', '−')}·10{str(int(exponent)).translate(_RAISED)}"
    if size >= 1e4:
        return f"{float(f'{value:.3g}'):,.0f}".replace(",", "\u00a0").replace("-", "−")
    return f"{value:.4g}".replace("-", "−")


def rounded(value: float, figures: int) -> str:
    """`number` of a value cut to so many figures."""
    return number(float(f"{value:.{figures}g}"))


def near(value: float, span: float) -> str:
    """A value rounded to a thousandth of the span it lies in: 0.2498 of 0.25 is 0.25, 1.6e-5 of 0.25 is 0."""
    if not (span > 0 and math.isfinite(span) and math.isfinite(value)):
        return number(value)
    digits = 2 - math.floor(math.log10(span))
    return rounded(round(value, digits) + 0.0, 3)


_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def level_text(name: str, value: Any, unit: bool = True) -> str:
    """A level of a factor in words: 'straight' for an infinite curve, 'driven −30 N' for a motor force."""
    if isinstance(value, str):
        return short(name, value) if name in MAPPING_FIELDS else _pair(value)
    value = float(value)
    if name == "motor_force" and unit:
        if value == 0:
            return "free rolling"
        return f"{'driven' if value < 0 else 'braked'} {number(value)} N"
    if name == "guide_curve_radius" and unit:
        if math.isinf(value):
            return "straight"
        return f"{'outer' if value > 0 else 'inner'} curve {number(abs(value))} mm"
    if not unit or name not in PARAMETERS or PARAMETERS[name].unit == "-":
        return number(value)
    return f"{number(value)} {unit_text(PARAMETERS[name].unit)}".replace(" °", "°")


def short_levels(names: Sequence[str]) -> list[str]:
    """Names of categories without the part of a pair that all of them share: only what differs tells them apart."""
    parts = [_parts(name) for name in names]
    if len(set(names)) > 1 and all(len(p) == 2 for p in parts):
        for keep in (0, 1):
            if len({p[1 - keep] for p in parts}) == 1:
                return [p[keep] for p in parts]
    return list(names)


def _parts(name: str) -> list[str]:
    if name.endswith(" on itself"):
        return [name.removesuffix(" on itself")] * 2
    return name.split(" / " if " / " in name else " on ")


def _pair(label: str) -> str:
    parts = label.split(" / ")
    return f"{parts[0]} on itself" if len(parts) == 2 and parts[0] == parts[1] else " on ".join(parts)
