"""Designs in groups along a factor: one group a level, or groups of equal size where the levels are many."""

from __future__ import annotations

import json
from dataclasses import dataclass

import numpy as np
import xarray as xr

from trackroller.report.numbers import level_text, long_name, number, rounded, short_levels

MAX_LEVELS = 12  # a factor with more levels is divided into BINS groups
BINS = 8
FRICTION, DRIVE = "friction_coefficient", "motor_force"
DERIVED = {"spin": "spin φρ", "lean": "μ tan α"}  # quantities that `pairs` computes from the inputs


@dataclass(frozen=True)
class Groups:
    """Groups along `name`: places, texts and ends, and the group of every design (n,)."""

    name: str
    at: np.ndarray
    texts: tuple[str, ...]
    low: np.ndarray
    high: np.ndarray
    index: np.ndarray
    ordered: bool

    def __len__(self) -> int:
        return len(self.texts)


def factors(ds: xr.Dataset) -> list[str]:
    """Return the factors that vary besides the contact model."""
    return list(json.loads(ds.attrs["factors"]))


def groups(ds: xr.Dataset, name: str) -> Groups:
    """Sort the designs into groups along a factor, or along `spin`.

    Groups of numbers rise; categories stand in order of appearance.
    """
    values = ds[name].values
    if values.dtype.kind != "f" or not np.isfinite(values).all():
        return _categories(name, values)
    if name in DERIVED:
        values = np.array([float(f"{v:.3g}") for v in values])
    levels, index = np.unique(values, return_inverse=True)
    if len(levels) > MAX_LEVELS:
        edges = np.unique(np.quantile(values, np.linspace(0.0, 1.0, BINS + 1)))
        index = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, len(edges) - 2)
        parts = [values[index == i] for i in range(len(edges) - 1)]
        parts = [p for p in parts if p.size]
        _, index = np.unique(index, return_inverse=True)
        low, high = (np.array([f(p) for p in parts]) for f in (np.min, np.max))
        at = np.array([np.median(p) for p in parts])
    else:
        at = low = high = levels
    texts = tuple(span(name, a, b) for a, b in zip(low, high, strict=True))
    return Groups(name, at, texts, low, high, index, True)


def _categories(name: str, values: np.ndarray) -> Groups:
    """Return one group for each value: a word, or a number of a list with infinity (the curve of a straight guide)."""
    kinds = list(dict.fromkeys(values.tolist())) if values.dtype.kind != "f" else np.unique(values).tolist()
    index = np.array([kinds.index(v) if v == v else -1 for v in values.tolist()])
    texts = tuple(short_levels([level_text(name, k) for k in kinds]))
    at = np.arange(len(kinds), dtype=float)
    return Groups(name, at, texts, at, at, index, False)


def span(name: str, low: float, high: float) -> str:
    """Return a level or a range in words."""
    figures = 2 if name in (FRICTION, *DERIVED) else 4 if low == high else 3
    low, high = float(f"{low:.{figures}g}"), float(f"{high:.{figures}g}")
    if low == high:
        return level_text(name, low)
    return f"{number(low)} to {level_text(name, high, words=False)}"


def drives(ds: xr.Dataset) -> Groups:
    """Sort the designs into free rolling, driven and braked ones.

    Each level is a group by itself where there are three or fewer.
    """
    force = ds[DRIVE].values
    if np.unique(force).size <= 3:
        return groups(ds, DRIVE)
    sign = np.sign(force)
    parts, texts = [s for s in (-1.0, 0.0, 1.0) if (sign == s).any()], []
    for s in parts:
        own = np.abs(force[sign == s])
        way = {-1.0: "driven", 0.0: "free rolling", 1.0: "braked"}[s]
        low, high = (rounded(float(v), 2) for v in (own.min(), own.max()))
        texts.append(way if s == 0 else f"{way}, {low} N" if low == high else f"{way}, {low} to {high} N")
    index = np.searchsorted(parts, sign)
    at = np.arange(len(parts), dtype=float)
    return Groups(DRIVE, at, tuple(texts), at, at, index, False)


def name_of(name: str) -> str:
    """Return a factor or the spin in running text."""
    return DERIVED.get(name) or ("friction" if name == FRICTION else long_name(name))


def spin_is_its_own(ds: xr.Dataset) -> bool:
    """Return whether the spin varies."""
    values = ds["spin"].values
    good = values[np.isfinite(values)]
    return bool(good.size) and float(good.max()) > 1.1 * float(good.min())
