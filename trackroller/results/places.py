"""Where something happens in a study: the levels of factors that hold some of its cases."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from trackroller.parameters.of_carriage import long_name_of, parameter_of
from trackroller.results.groups import MOST_LEVELS, confined, levels
from trackroller.study.design.levels import in_words

MOST_PRODUCTS = 2  # combinations of levels that describe a place
Levels = Mapping[str, tuple[Any, ...]]


def plain(value: Any) -> Any:
    """Return a level as a plain number or text."""
    return value.item() if isinstance(value, np.generic) else value


def levels_of(table: pd.DataFrame, names: Sequence[str], row: int) -> dict[str, Any]:
    """Return the levels of some factors in one row."""
    return {name: plain(table[name].iloc[row]) for name in names}


def places_of(table: pd.DataFrame, names: Sequence[str], hit: np.ndarray, among: np.ndarray) -> tuple[Levels, ...]:
    """Return the levels that hold together exactly in some rows, or two such products; nothing if no levels do.

    Parameters
    ----------
    table : one row a case
    names : factors that may describe the place
    hit : the rows, shape (n,) bool
    among : the rows that they are compared with, shape (n,) bool
    """
    hit = hit & among
    if not hit.any() or hit.sum() == among.sum():
        return ()
    few = [name for name in names if 1 < table[name][among].nunique() <= MOST_LEVELS]
    restricted: dict[str, tuple[Any, ...]] = {}
    inside = among.copy()
    for name in few:
        own = set(table[name][hit].unique())
        if len(own) < table[name][among].nunique():
            restricted[name] = tuple(plain(level) for level in levels(table[name]) if level in own)
            inside &= table[name].isin(own).to_numpy()
    if restricted and inside.sum() == hit.sum():
        return (_without_needless(table, restricted, hit, among),)
    products = confined(table, few, hit, among, MOST_PRODUCTS, whole=True)
    return tuple(product.levels for product in products)


def _without_needless(table: pd.DataFrame, restricted: Levels, hit: np.ndarray, among: np.ndarray) -> Levels:
    """Return the levels without those of factors that the other ones restrict already."""
    kept = dict(restricted)
    for name in list(restricted):
        others = {other: own for other, own in kept.items() if other != name}
        inside = among.copy()
        for other, own in others.items():
            inside &= table[other].isin(own).to_numpy()
        if others and inside.sum() == hit.sum():
            kept = others
    return kept


def number_text(value: float) -> str:
    """Return a number with up to six digits."""
    return f"{value:,.6g}".replace("-", "−").replace("inf", "∞")


def level_text(name: str, value: Any) -> str:
    """Return a level of a factor with its unit."""
    if isinstance(value, str):
        return in_words(name, value)
    if name == "guide_curve_radius" and np.isinf(value):
        return "straight"
    known = parameter_of(name)
    unit = "" if known is None or known.unit == "-" else f" {known.unit}"
    return (number_text(float(value)) + unit).replace(" deg", "°")


def place_text(place: Levels) -> str:
    """Return one place as a text: 'motor force −20, 20 N and friction coefficient 0.05'."""
    parts = []
    for name, own in place.items():
        parts.append(f"{long_name_of(name)} {_joined(name, own)}")
    return ", ".join(parts)


def _joined(name: str, own: tuple[Any, ...]) -> str:
    texts = [level_text(name, value) for value in own]
    if len(texts) > 3 and not isinstance(own[0], str):
        return f"{texts[0]} to {texts[-1]}"
    return " or ".join(texts)


def places_text(places: Sequence[Levels]) -> str:
    """Return some places as a text."""
    return "; ".join(place_text(place) for place in places)
