"""Panels of the comparison of contact models: a column a drive, friction (or what varies instead) along the axis."""

from __future__ import annotations

import json
import textwrap
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from trackroller.parameters import PARAMETERS
from trackroller.report.comparison.groups import DERIVED, DRIVE, FRICTION, Groups, drives, factors, groups
from trackroller.report.figures import style
from trackroller.report.numbers import capital, factor_label, level_text, long_name

# told apart by dash and mark as much as by colour
LOOKS: dict[str, dict[str, Any]] = {
    "sliding": {"color": "#000000", "linestyle": "-", "marker": "o"},
    "fastsim": {"color": "#d55e00", "linestyle": ":", "marker": "s"},
    "kalker": {"color": "#0072b2", "linestyle": "--", "marker": "^"},
    "kalker_table": {"color": "#56b4e9", "linestyle": "-.", "marker": "v"},
}
SIZE = 2.8
WRAP, UPRIGHT = 13, 4  # letters of a line of a category's name, and how many categories are named level


@dataclass(frozen=True)
class Frame:
    """Designs of a figure, groups along its axis, drives of its columns, and words on the factors held constant."""

    ds: xr.Dataset
    x: Groups
    columns: Groups | None
    held: str

    def titles(self) -> list[str]:
        """Return the headings of the columns."""
        return [capital(t) for t in self.columns.texts] if self.columns is not None else [""]

    def inside(self, column: int) -> np.ndarray:
        """Return the designs of a column, (n,)."""
        return np.ones(self.ds.sizes["design"], bool) if self.columns is None else self.columns.index == column

    def bands(self, values: np.ndarray, column: int) -> np.ndarray:
        """Return 5, 50 and 95 % of the values (n,) in each group of a column, (3, groups).

        A group without values has NaN.
        """
        out = np.full((3, len(self.x)), np.nan)
        chosen = self.inside(column) & ~np.isnan(values)
        for k in range(len(self.x)):
            own = values[chosen & (self.x.index == k)]
            if own.size:
                out[:, k] = np.percentile(own, (5, 50, 95), method="nearest")
        return out

    @property
    def many(self) -> bool:
        """Return whether a place on the axis stands for several designs."""
        column = np.zeros(len(self.x.index), int) if self.columns is None else self.columns.index
        pairs = column * (len(self.x) + 1) + self.x.index
        return bool(np.unique(pairs, return_counts=True)[1].max(initial=0) > 1)


def axis_name(ds: xr.Dataset) -> str | None:
    """Choose the factor along the axis: friction, else the first with an order, else any."""
    names = [n for n in factors(ds) if n in ds.coords]
    if FRICTION in names:
        return FRICTION
    ordered = [n for n in names if n != DRIVE and groups(ds, n).ordered]
    return next(iter([*ordered, *(n for n in names if n == DRIVE), *names]), None)


def frame(ds: xr.Dataset, name: str | None = None, hold: bool = False, split: bool = True) -> Frame | None:
    """Return the frame of a figure over `name`; None if no factor varies.

    `hold`: of a grid, only designs with all other factors at the base's level (else the middle one); where none of
    them rolls, all designs. `split`: a column a drive.
    """
    x = name or axis_name(ds)
    if x is None or not ds.sizes["design"]:
        return None
    shown = (x, DRIVE) if split else (x,)
    kept, said = _held(ds, shown) if hold and ds.attrs["grid"] else (np.ones(ds.sizes["design"], bool), "")
    part = ds.isel(design=np.flatnonzero(kept))
    if not (part["regime"] == 0).all("contact_model").any():
        part, said = ds, ""
    columns = drives(part) if split and x != DRIVE and DRIVE in factors(ds) else None
    return Frame(part, groups(part, x), columns, said)


def _held(ds: xr.Dataset, shown: tuple[str, ...]) -> tuple[np.ndarray, str]:
    base, kept, said = json.loads(ds.attrs["base"]), np.ones(ds.sizes["design"], bool), []
    for name in factors(ds):
        if name in shown or name not in ds.coords:
            continue
        values = ds[name].values
        levels = list(dict.fromkeys(values.tolist()))
        levels = sorted(levels) if values.dtype.kind == "f" else levels
        given = base.get(name, PARAMETERS[name].default if name in PARAMETERS else None)
        level = given if given in levels else levels[len(levels) // 2] if values.dtype.kind == "f" else levels[0]
        kept &= values == level
        bare = name in (DRIVE, "guide_curve_radius", "material_pair")
        said.append(("" if bare else f"{long_name(name)} ") + level_text(name, level))
    return kept, f"Held: {'; '.join(said)}." if said else ""


def rolling(ds: xr.Dataset) -> np.ndarray:
    """Return the designs that roll by every model, (n,): only these are compared."""
    return np.asarray((ds["regime"] == 0).all("contact_model").values)


def panels(shown: Frame, labels: list[str], row_mm: float) -> tuple[Figure, Any]:
    """Return rows of panels, one row for each label, over the columns of the frame."""
    titles = shown.titles()
    figure = style.new_figure(30.0 + row_mm * len(labels) + label_mm(shown.x))
    axes = figure.subplots(len(labels), len(titles), sharex=True, sharey="row", squeeze=False)
    for column, title in enumerate(titles):
        axes[0, column].set_title(title, loc="left", pad=3)
        set_axis(axes[-1, column], shown.x)
    for row, label in enumerate(labels):
        axes[row, 0].set_ylabel(label)
    return figure, axes


def label_mm(x: Groups) -> float:
    """Return the height that names of categories take under an axis [mm]."""
    if x.ordered:
        return 0.0
    lines = [textwrap.wrap(text, WRAP) for text in x.texts]
    return 1.6 * max(len(line) for text in lines for line in text) if len(x) > UPRIGHT else 3.0 * max(map(len, lines))


def set_axis(axes: Axes, x: Groups) -> None:
    """Set scale, ticks and label of the axis of groups."""
    axes.set_xlabel(axis_label(x.name))
    if not x.ordered:
        texts = [textwrap.fill(text, WRAP) for text in x.texts]
        axes.set_xticks(x.at, texts, rotation=90 if len(x) > UPRIGHT else 0, linespacing=0.95)
        axes.set_xlim(-0.6, len(x) - 0.4)
        axes.grid(visible=False, axis="x")
    elif x.at.min() > 0 and x.at.max() > 4 * x.at.min():
        axes.set_xscale("log")
        style.log_ticks(axes.xaxis, float(x.at.min()), float(x.at.max()))


def axis_label(name: str) -> str:
    """Return the axis label of a factor or of a quantity computed from factors."""
    derived = {"spin": r"Spin $\varphi\,\rho$ [–]", "lean": r"$\mu\,\tan\alpha$ [–]"}
    return derived[name] if name in DERIVED else factor_label(name)


def line(
    axes: Axes, x: Groups, band: np.ndarray, model: str, hollow: bool = False, shade: bool = False, **more: Any
) -> Any:
    """Draw the median of a model over the groups, and its band where asked for."""
    look = LOOKS[model] | more
    at = x.at if x.ordered else x.at + 0.14 * (list(LOOKS).index(model) - 1)
    if shade and np.nanmax(band[2] - band[0], initial=0.0) > 0:
        if x.ordered:
            axes.fill_between(at, band[0], band[2], color=look["color"], alpha=0.15, linewidth=0)
        else:
            axes.vlines(at, band[0], band[2], color=look["color"], alpha=0.3, linewidth=4)
    face = "white" if hollow else look["color"]
    look = look if x.ordered else look | {"linestyle": "none"}
    return axes.plot(at, band[1], markersize=SIZE, markerfacecolor=face, markeredgewidth=0.7, **look)[0]


def close(figure: Figure, handles: dict[str, Any], title: str, words: str, columns: int = 3) -> Figure:
    """Add the legend (label -> line) and the heading, and return the figure."""
    figure.legend(
        list(handles.values()),
        list(handles),
        loc="outside lower center",
        ncols=columns,
        handlelength=2.6,
        columnspacing=1.2,
    )
    style.head(figure, title, words)
    style.finish(figure)
    return figure
