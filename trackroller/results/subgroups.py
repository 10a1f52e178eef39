"""Where something happens in a study: the levels of factors that hold some of its cases."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from trackroller.parameters.carriage_fields import long_name_of, parameter_of
from trackroller.results.factor_levels import MOST_LEVELS, confined, levels
from trackroller.study.design.levels import in_words

MOST_PRODUCTS = 2  # combinations of levels that describe a place
Levels = Mapping[str, tuple[Any, ...]]


def plain(value: Any) -> Any:
    """Return a level as a plain number or text."""
    if isinstance(value, np.generic):
        return value.item()
    return value


def levels_of(table: pd.DataFrame, names: Sequence[str], row: int) -> dict[str, Any]:
    """Return the levels of some factors in one row."""
    return {name: plain(table[name].iloc[row]) for name in names}


def places_of(
    table: pd.DataFrame, names: Sequence[str], hit: np.ndarray, among: np.ndarray
) -> tuple[Levels, ...]:
    """Return the levels that hold together exactly in some rows, or two such products; nothing if
    no levels do.

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
    return tuple(_without_every_level(product.levels, table[among]) for product in products)


def labels_in_place(
    table: pd.DataFrame, names: Sequence[str], labels: Sequence[str], hit: np.ndarray
) -> list[str]:
    """Return the factors that may describe some rows, in the order that `places_of` expects: a
    label of a table that names them by at most two levels takes the place of their numbers.

    Parameters
    ----------
    table : one row a case
    names : factors that may describe the place
    labels : columns of names, such as that of a load case, which change no case
    hit : the rows, shape (n,) bool
    """
    short = [
        name for name in labels if name in names and table[name][hit].nunique() <= NAMED_BY_LABELS
    ]
    long = [name for name in labels if name in names and name not in short]
    return [*long, *(name for name in names if name not in labels), *short]


NAMED_BY_LABELS = 2  # largest number of labels that describe a place


def _without_every_level(product: Levels, table: pd.DataFrame) -> Levels:
    """Return the levels of a place without those of a factor of which it holds every level."""
    return {name: own for name, own in product.items() if len(own) < table[name].nunique()}


def _without_needless(
    table: pd.DataFrame, restricted: Levels, hit: np.ndarray, among: np.ndarray
) -> Levels:
    """Return the levels without those of factors that the other ones restrict already."""
    needed = dict(restricted)
    for name in list(restricted):
        others = {other: own for other, own in needed.items() if other != name}
        inside = among.copy()
        for other, own in others.items():
            inside &= table[other].isin(own).to_numpy()
        if others and inside.sum() == hit.sum():
            needed = others
    return needed


def number_text(value: float) -> str:
    """Return a number as a person wrote it, with up to six digits; a drawn number, which has more,
    with four.
    """
    text = f"{value:.6g}"
    digits = 4
    if float(text) == value:
        digits = 6
    return f"{value:,.{digits}g}".replace("-", "−").replace("inf", "∞")


def level_text(name: str, value: Any) -> str:
    """Return a level of a factor with its unit."""
    if isinstance(value, str):
        return in_words(name, value)
    if name == "guide_curve_radius" and np.isinf(value):
        return "straight"
    known = parameter_of(name)
    if known is None or known.unit == "-":
        unit = ""
    else:
        unit = f" {known.unit}"
    return (number_text(float(value)) + unit).replace(" deg", "°")


def case_text(table: pd.DataFrame, names: Sequence[str], row: int) -> str:
    """Return the levels of some factors in one row as a text: 'motor force −20 N, friction
    coefficient 0.05'.
    """
    levels_here = levels_of(table, names, row).items()
    return ", ".join(
        f"{long_name_of(name)} {level_text(name, level)}" for name, level in levels_here
    )


def places_text(places: Sequence[Levels], table: pd.DataFrame) -> str:
    """Return some places as a text, with numbers that follow each other in a table as 'first to
    last'.
    """
    return "; ".join(_place_text(place, table) for place in places)


def _place_text(place: Levels, table: pd.DataFrame) -> str:
    parts = []
    for name, own in place.items():
        texts = []
        for run in _runs(own, levels(table[name])):
            texts += _run_texts(name, run)
        parts.append(f"{long_name_of(name)} {' or '.join(texts)}")
    return ", ".join(parts)


def _runs(own: tuple[Any, ...], known: list[Any]) -> list[list[Any]]:
    """Return levels in groups that follow each other in the list of all levels."""
    runs: list[list[Any]] = []
    last = -2
    for at, level in enumerate(known):
        if level not in own:
            continue
        if at == last + 1:
            runs[-1].append(level)
        else:
            runs.append([level])
        last = at
    return runs


def _run_texts(name: str, run: list[Any]) -> list[str]:
    """Return the texts of levels that follow each other: all of few, otherwise the first and the
    last number.
    """
    texts = [level_text(name, value) for value in run]
    if len(texts) > 2 and not isinstance(run[0], str):
        return [f"{texts[0]} to {texts[-1]}"]
    return texts
