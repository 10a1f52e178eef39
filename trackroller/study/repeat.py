"""From a row of a study back to its case: solve it anew and compare."""

from __future__ import annotations

import shlex
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.errors import InputError
from trackroller.parameters import PARAMETERS
from trackroller.study import store
from trackroller.study.design.build import build, case_columns
from trackroller.study.design.growth import with_history
from trackroller.study.files import WorkError
from trackroller.study.plan import case_options, identify, study_folder

if TYPE_CHECKING:
    from trackroller.study.config import Study


@dataclass
class Repeat:
    """A case solved anew: its values and options, and for each variable the largest relative difference."""

    case: dict[str, Any]
    options: dict[str, Any]
    differences: dict[str, float]

    @property
    def largest(self) -> float:
        """Largest relative difference of all variables."""
        return max(self.differences.values(), default=0.0)

    def command(self) -> str:
        """A command that solves the case without the study."""
        words = ["trackroller", "solve"]
        for key, value in (self.case | self.options).items():
            if isinstance(value, (list, tuple)):
                value = ",".join(value) or None
            if value is not None and not (isinstance(value, float) and np.isnan(value)):
                words += ["--set", f"{key}={value!r}" if isinstance(value, float) else f"{key}={value}"]
        return " ".join(shlex.quote(word) for word in words)


def repeat_case(study: Study, number: int, results: Path | str = "results") -> Repeat:
    """Solve case `number` of a study anew and compare it with what is stored.

    Raises `InputError` for a number outside the study, `WorkError` for a case that is not solved yet.
    """
    from trackroller.roller.solver import solve

    folder = study_folder(study.name, results)
    study = with_history(study, folder)
    design = build(study)
    if not 0 <= number < design.sizes["case"]:
        raise InputError("case", number, f"a case number from 0 to {design.sizes['case'] - 1}")
    cases = identify(study, design)
    options, _ = case_options(study, design)
    told = options if isinstance(options, dict) else options[number]
    before = _stored(folder.root, cases[number])
    row = design.drop_vars(list(design.coords)).isel(case=[number])
    again = store.from_dataset(solve(row, database=study.materials, **told), cases[[number]])
    differences = {}
    for name in before.layout:
        old = before.columns(name)[0]
        new = again.columns(name)[0] if name in again.layout else np.full(old.shape, np.nan)
        differences[name] = _difference(old, new)
    case = {name: row[name].values[0] for name in case_columns(row)}
    return Repeat({k: float(v) if k in PARAMETERS else str(v) for k, v in case.items()}, dict(told), differences)


def _difference(old: np.ndarray, new: np.ndarray) -> float:
    same = (old == new) | (np.isnan(old) & np.isnan(new))
    if same.all():
        return 0.0
    scale = np.maximum(np.abs(old), np.abs(new))
    apart = np.where(same, 0.0, np.abs(old - new) / np.where(scale > 0, scale, 1.0))
    return float(np.where(np.isnan(apart), np.inf, apart).max())


def _stored(root: Path, case: bytes) -> store.Block:
    for path in sorted([*(root / "store").glob("*.nc"), *(root / "store").glob("*.parts/*.nc")]):
        block = store.read(path)
        hit = np.flatnonzero(block.cases == case)
        if hit.size:
            return block.take(hit[:1])
    raise WorkError("this case is not solved yet: run the study first.")
