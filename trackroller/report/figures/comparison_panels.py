"""Panels of the comparison of contact models: a column for each drive, friction or another factor along the axis."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from trackroller.analysis.contact_models import designs
from trackroller.analysis.groups import DRIVE, Groups, drives, groups, spaced_by_ratio
from trackroller.analysis.table import StudyView
from trackroller.report.figures import style
from trackroller.report.figures.panels import band, quantiles, set_axis
from trackroller.report.numbers import capital, factor_label
from trackroller.report.words.comparison import FRICTION
from trackroller.report.words.levels import group_texts, held_words

# distinguished by dash and mark as well as by colour
LOOKS: dict[str, dict[str, Any]] = {
    "sliding": {"color": "#000000", "linestyle": "-", "marker": "o"},
    "fastsim": {"color": "#d55e00", "linestyle": ":", "marker": "s"},
    "kalker": {"color": "#0072b2", "linestyle": "--", "marker": "^"},
    "kalker_table": {"color": "#56b4e9", "linestyle": "-.", "marker": "v"},
}
LETTERS = 100  # letters of 7 pt across a figure


@dataclass(frozen=True)
class Frame:
    """Designs of a figure, groups along its axis, drives of its columns, and text on the factors held constant."""

    ds: xr.Dataset
    x: Groups
    columns: Groups | None
    held: str

    @property
    def titles(self) -> list[str]:
        """Return the headings of the columns."""
        return [capital(t) for t in group_texts(self.columns)] if self.columns is not None else [""]

    def _inside(self, column: int) -> np.ndarray:
        return np.ones(self.x.index.size, bool) if self.columns is None else self.columns.index == column

    def bands(self, values: np.ndarray, column: int) -> np.ndarray:
        """Return 5, 50 and 95 % of the values (n,) in each group of a column, (3, groups)."""
        return quantiles(np.where(self._inside(column), values, np.nan), self.x.index, len(self.x))

    @property
    def many(self) -> bool:
        """Return whether a place on the axis stands for several cases."""
        counts = [np.bincount(self.x.index[self._inside(k)]) for k in range(len(self.titles))]
        return max(int(count.max(initial=0)) for count in counts) > 1


def axis_name(view: StudyView) -> str | None:
    """Choose the factor along the axis: friction, the first factor with an order, or the first factor."""
    if FRICTION in view.factors:
        return FRICTION
    return next((n for n in view.factors if view.ordered(n)), next(iter(view.factors), None))


def frame(ds: xr.Dataset, hold: bool = False) -> Frame | None:
    """Return the frame of a figure over friction or another factor, a column for each drive; None without a factor.

    With `hold`, the frame of a grid has only the cases whose other factors are at the level of the base case, or
    at their middle level; if no such case rolls, it has all cases.
    """
    view = designs(ds)
    x = axis_name(view)
    if x is None or not len(view.table):
        return None
    rows, held = view.hold((x, DRIVE)) if hold else (view.table, {})
    if not rolling(ds)[rows.index].any():
        rows, held = view.table, {}
    view, part = replace(view, table=rows), ds.isel(design=rows.index)
    columns = drives(view) if x != DRIVE and DRIVE in view.factors else None
    return Frame(part, groups(view, x), columns, held_words(held))


def rolling(ds: xr.Dataset) -> np.ndarray:
    """Return the cases that roll by every model, (n,): only these are compared."""
    return np.asarray((ds["regime"] == 0).all("contact_model").values)


def panels(shown: Frame, labels: list[str], row_mm: float) -> tuple[Figure, Any]:
    """Return rows of panels, one row for each label, over the columns of the frame."""
    figure = style.new_figure(30.0 + row_mm * len(labels))
    axes = figure.subplots(len(labels), len(shown.titles), sharex=True, sharey="row", squeeze=False)
    for column, title in enumerate(shown.titles):
        axes[0, column].set_title(title, loc="left", pad=3)
        label_axis(axes[-1, column], shown.x, LETTERS // len(shown.titles))
    for row, label in enumerate(labels):
        axes[row, 0].set_ylabel(label)
    return figure, axes


def label_axis(axes: Axes, x: Groups, letters: int) -> None:
    """Set scale, ticks and label of the axis of groups."""
    axes.set_xlabel(factor_label(x.name))
    if x.ordered and spaced_by_ratio(x.at, 4.0):
        axes.set_xscale("log")
        style.log_ticks(axes.xaxis, float(x.at.min()), float(x.at.max()))
    else:
        set_axis(axes, x, letters)


def line(axes: Axes, x: Groups, values: np.ndarray, model: str, shade: bool, **more: Any) -> Any:
    """Draw the median of a model over the groups, and its band if it is wanted."""
    look = {"markersize": 2.8, "markeredgewidth": 0.7, **LOOKS[model], **more}
    at = x.at if x.ordered else x.at + 0.1 * (list(LOOKS).index(model) - 1.5)
    return band(axes, at, values, look, x.ordered, shade)
