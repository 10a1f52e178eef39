"""The map of the pairs of factors that interact."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from markupsafe import Markup

from trackroller.report.numbers import capital
from trackroller.report.pictures.frame import cut, framed
from trackroller.report.pictures.marks import element, joined, label, percent_place, width_of
from trackroller.results.answer import Answer

MAP_ROW = 26.0  # height of a row of a map [px]
SHADES = 7  # of a map
WORTH = 0.02  # of the variance: a map is drawn from such an interaction on


def map_of(answer: Answer) -> tuple[Markup, str] | None:
    """Return the map of the pairs that interact, with what it draws; None where no pair holds 2 %
    of the variance.
    """
    if answer.picture.get("pairs") is None:
        return None
    shares = np.asarray(answer.picture["pairs"], dtype=float)
    names = [capital(str(title)) for title in answer.picture["titles"]]
    own = np.tril(np.nan_to_num(shares), -1)
    if own.max(initial=0.0) < WORTH:
        return None
    shown = [i for i in range(len(names)) if max(own[i].max(), own[:, i].max()) >= WORTH]
    return _drawn_map(own[np.ix_(shown, shown)], [names[i] for i in shown])


def _drawn_map(shares: np.ndarray, names: Sequence[str]) -> tuple[Markup, str]:
    """Draw the shares of the pairs of factors as cells with their numbers."""
    size = len(names) - 1  # the first factor has no row, the last one no column
    cell = 100 / size
    parts = []
    for row in range(size):
        y = row * cell
        parts.append(
            label(cut(names[row + 1], 110), 0, percent_place(y + cell / 2), "end", dx=-6, dy=4)
        )
        for column in range(row + 1):
            share = float(shares[row + 1, column])
            shade = min(SHADES - 1, int(SHADES * share / max(float(shares.max()), WORTH)))
            place = (percent_place(column * cell), percent_place(y))
            length = percent_place(cell)
            parts.append(
                element(
                    "rect", class_=f"s{shade}", x=place[0], y=place[1], width=length, height=length
                )
            )
            middle = percent_place(y + cell / 2)
            parts.append(
                label(
                    f"{100 * share:.0f}", (column + 0.5) * cell, middle, kind="strong", dx=0, dy=4
                )
            )
    for column in range(size):
        parts.append(
            label(cut(names[column], 260 / size), (column + 0.5) * cell, "100%", dx=0, dy=15)
        )
    left = max(width_of(cut(name, 110)) for name in names[1:]) + 14
    words = "; ".join(
        f"{names[i]} and {names[j]} {100 * shares[i, j]:.0f} %"
        for i in range(len(names))
        for j in range(i)
    )
    drawn = framed(joined(parts), MAP_ROW * size, words, left=left)
    return (
        drawn,
        "Share of the variance that a pair of factors holds beyond each of them alone [%].",
    )
