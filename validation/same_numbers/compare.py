"""Compare two recordings value by value."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from validation.same_numbers.archive import LABELS, Archive

VERDICTS = {"cases": "physics", "studies": "physics", "designs": "designs", "indices": "indices"}
NAMES = ("physics", "designs", "indices", "signatures")
# Sentences may be rewritten without a change of any number.
WORDING = ("long_name", "comment", "source", "history", "note", "treatment", "needs", "study", "reason", "refused")
# Attributes that name the version and the date of a result.
PROVENANCE = ("date_created", "git_commit", "physics_code", "results_version", "solver_digest", "versions")
DECODED = ("flag_meanings", "flag_values", "flag_masks")  # the recorded words say what they say
# Old and new names of one thing: both are read as the second name.
RENAMED = {"kalker_table": "kalker", "nested": "inner_outer"}
# Axes within one case. The largest value along them is the scale of a difference.
WITHIN_CASE = ("contact", "body", "component", "x", "y", "section_x", "section_y", "section_z")
# These quantities are relative already: their scale is 1.
RELATIVE = ("residual", "error_estimate", "life_error_estimate", "force_error_estimate", "energy_residual")


@dataclass(frozen=True)
class Difference:
    """Values of one array that differ.

    `relative` is the largest difference over the larger of the two values; `scaled` is the largest difference over the
    largest value in the same case. Both are infinite where a value appears, disappears or is a text.
    """

    key: str
    differ: int
    total: int
    relative: float
    scaled: float
    beyond: bool


@dataclass
class Verdict:
    """Findings of the comparison for one of the four subjects in `NAMES`."""

    name: str
    arrays: int = 0
    values: int = 0
    differences: list[Difference] = field(default_factory=list)
    problems: list[str] = field(default_factory=list)  # missing arrays, other shapes, other labels
    remarks: list[str] = field(default_factory=list)  # additions and rewritten sentences, which are allowed

    @property
    def passed(self) -> bool:
        """Return whether there is no problem and no difference beyond the tolerance."""
        return not self.problems and not any(difference.beyond for difference in self.differences)


def compare(before: Archive, after: Archive, tolerance: float = 0.0) -> list[Verdict]:
    """Compare two recordings.

    Parameters
    ----------
    before, after : Archive
        Recordings of the same parts.
    tolerance : float
        Allowed difference over the largest value in the same case; 0 asks for equal values.

    Returns
    -------
    list of Verdict
        Physics, designs, indices and signatures. A subject that `before` does not hold has no arrays.
    """
    verdicts = {name: Verdict(name) for name in NAMES}
    for key in sorted(before.keys() | after.keys()):
        verdict = verdicts[VERDICTS.get(key.partition("/")[0], "signatures")]
        if key not in before:
            verdict.remarks.append(f"{key}: added")
        elif key not in after and key.endswith("/refused"):
            verdict.remarks.append(f"{key}: now solved")
        elif key not in after:
            verdict.problems.append(f"{key}: missing")
        elif key.endswith(".json"):
            _compare_texts(key, before[key], after[key], verdict)
        elif key.rpartition("/")[2] in WORDING:
            _compare_wording(key, before[key], after[key], verdict)
        else:
            _compare_arrays(key, before, after, tolerance, verdict)
    return [verdicts[name] for name in NAMES]


def _compare_wording(key: str, old: np.ndarray, new: np.ndarray, verdict: Verdict) -> None:
    """Compare sentences: other words are a remark, an added or removed sentence is a problem."""
    if old.shape != new.shape or np.any((old == "") != (new == "")):
        verdict.problems.append(f"{key}: sentences appear or disappear")
    elif np.any(old != new):
        verdict.remarks.append(f"{key}: reworded")


def _compare_arrays(key: str, before: Archive, after: Archive, tolerance: float, verdict: Verdict) -> None:
    old, new = before[key], after[key]
    verdict.arrays += 1
    verdict.values += old.size
    if old.shape != new.shape:
        verdict.problems.append(f"{key}: shape {old.shape} became {new.shape}")
        return
    if old.dtype.kind == "U" or new.dtype.kind == "U":
        found = _texts_that_differ(key, old, new)
    else:
        found = numbers_that_differ(key, old, new, _axes(key, before, old.ndim), tolerance)
    if found.differ:
        verdict.differences.append(found)


def _texts_that_differ(key: str, old: np.ndarray, new: np.ndarray) -> Difference:
    differ = [_renamed(a) != _renamed(b) for a, b in zip(old.ravel().tolist(), new.ravel().tolist(), strict=True)]
    return Difference(key, sum(differ), old.size, np.inf, np.inf, any(differ))


def _renamed(value: Any) -> Any:
    return RENAMED.get(value, value) if isinstance(value, str) else value


def _axes(key: str, archive: Archive, dimensions: int) -> tuple[int, ...]:
    """Return the axes of an array that lie within one case; all axes but the first if the file does not say."""
    where, _, name = key.rpartition("/")
    labels = archive.get(f"{where}/{LABELS}")
    known = {} if labels is None else json.loads(str(labels))["variables"].get(name, {})
    dims = known.get("dims", ["case", *WITHIN_CASE[:1] * (dimensions - 1)])
    return tuple(i for i, dim in enumerate(dims[:dimensions]) if dim in WITHIN_CASE)


def numbers_that_differ(
    key: str, old: np.ndarray, new: np.ndarray, axes: tuple[int, ...], tolerance: float
) -> Difference:
    """Count and measure the numbers that differ; NaN equals NaN, and an infinity equals itself.

    Parameters
    ----------
    key : str
        Name of the array.
    old, new : ndarray
        Numbers of equal shape.
    axes : tuple of int
        Axes within one case, along which the scale of a difference is taken.
    tolerance : float
        Allowed difference over the scale.

    Returns
    -------
    Difference
    """
    a, b = old.astype(float), new.astype(float)
    same = (a == b) | (np.isnan(a) & np.isnan(b))
    if same.all():
        return Difference(key, 0, a.size, 0.0, 0.0, False)
    with np.errstate(all="ignore"):
        apart = np.where(same, 0.0, np.abs(a - b))
        size = np.fmax(np.abs(a), np.abs(b))
        finite = np.where(np.isfinite(size), size, 0.0)
        scale = finite.max(axis=axes, keepdims=True) if axes else finite
        if key.rpartition("/")[2] in RELATIVE:
            scale = np.maximum(scale, 1.0)
        scaled, relative = apart / scale, apart / size
    measured = [np.where(same, 0.0, np.where(np.isfinite(ratio), ratio, np.inf)) for ratio in (relative, scaled)]
    beyond = bool(np.any(measured[1] > tolerance))
    return Difference(key, int((~same).sum()), a.size, float(measured[0].max()), float(measured[1].max()), beyond)


def _leaves(value: Any, where: str = "") -> Iterable[tuple[str, Any]]:
    """Yield every leaf of a JSON value with the path to it."""
    if isinstance(value, dict) and value:
        for name, inner in value.items():
            yield from _leaves(inner, f"{where}.{name}" if where else str(name))
    elif isinstance(value, list) and any(isinstance(inner, (dict, list)) for inner in value):
        for i, inner in enumerate(value):
            yield from _leaves(inner, f"{where}[{i}]")
    else:
        yield where, value


def _compare_texts(key: str, old: np.ndarray, new: np.ndarray, verdict: Verdict) -> None:
    """Compare two JSON texts leaf by leaf: additions and rewritten sentences are remarks, all else is a problem."""
    before, after = (dict(_leaves(json.loads(str(each)))) for each in (old, new))
    verdict.arrays += 1
    verdict.values += len(before)
    for path in sorted(before.keys() | after.keys()):
        last = path.rpartition(".")[2]
        if last in (*DECODED, *PROVENANCE):
            continue
        if path not in before:
            verdict.remarks.append(f"{key}: {path} added")
        elif path not in after and last in WORDING:
            verdict.remarks.append(f"{key}: {path} left out")
        elif path not in after:
            verdict.problems.append(f"{key}: {path} missing (was {before[path]!r})")
        elif _renamed(before[path]) != _renamed(after[path]):
            reworded = last in WORDING or last.endswith("_conventions")
            told = f"{key}: {path}: {before[path]!r} became {after[path]!r}"
            (verdict.remarks if reworded else verdict.problems).append(told)
