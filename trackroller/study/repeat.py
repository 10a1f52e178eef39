"""Solve one case of a study again and compare it with the stored result."""

from __future__ import annotations

import dataclasses
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
from trackroller.study.inventory import take_inventory
from trackroller.study.plan import case_options, identify, study_folder

if TYPE_CHECKING:
    from trackroller.study.config import Study


@dataclass
class Repeat:
    """A case that was solved again.

    Attributes
    ----------
    case : dict
        Values of the case.
    options : dict
        Keyword arguments of `solve`.
    differences : dict
        Largest relative difference to the stored result [1], by variable.
    """

    case: dict[str, Any]
    options: dict[str, Any]
    differences: dict[str, float]

    @property
    def largest(self) -> float:
        """Return the largest relative difference of all variables [1]."""
        return max(self.differences.values(), default=0.0)

    def command(self) -> str:
        """Return a command that solves the case without the study."""
        words = ["trackroller", "solve"]
        for key, value in (self.case | self.options).items():
            if isinstance(value, (list, tuple)):
                value = ",".join(value) or None
            if value is not None and not (isinstance(value, float) and np.isnan(value)):
                words += ["--set", f"{key}={value!r}" if isinstance(value, float) else f"{key}={value}"]
        return " ".join(shlex.quote(word) for word in words)


def repeat_case(study: Study, number: int, results: Path | str = "results") -> Repeat:
    """Solve a case of a study again and compare it with the stored result.

    Parameters
    ----------
    study : Study
        The checked study.
    number : int
        Number of the case: the variable `case` of `study.nc`.
    results : path
        Parent of the study's folder.

    Returns
    -------
    Repeat
        The case and the differences.

    Raises
    ------
    InputError
        If the study has no such case.
    WorkError
        If the case is not solved yet.
    """
    from trackroller.roller.solver import solve  # numba compiles on import; the checks come first

    folder = study_folder(study.name, results)
    study = with_history(study, folder)
    design = build(study)
    if not 0 <= number < design.sizes["case"]:
        raise InputError("case", number, f"a case number from 0 to {design.sizes['case'] - 1}")
    cases = identify(study, design)
    options, group = case_options(study, design)
    found = take_inventory(folder)
    place = found.find(cases[[number]])[0]
    if place < 0:
        raise WorkError("this case is not solved yet: run the study first.")
    before = store.read_named(found.paths[found.file[place]]).take(found.row[[place]])
    row = design.drop_vars(list(design.coords)).isel(case=[number])
    again = store.from_dataset(solve(row, database=study.materials, **options[group[number]]), cases[[number]])
    after = dataclasses.replace(before, values=store.aligned(again, before.layout))
    differences = {name: largest_difference(before.columns(name), after.columns(name)) for name in before.layout}
    case = {name: row[name].values[0] for name in case_columns(row)}
    case = {name: float(value) if name in PARAMETERS else str(value) for name, value in case.items()}
    return Repeat(case, dict(options[group[number]]), differences)


def largest_difference(old: np.ndarray, new: np.ndarray) -> float:
    """Return the largest relative difference of two arrays of one shape; NaN in one of them alone counts as inf."""
    same = (old == new) | (np.isnan(old) & np.isnan(new))
    if same.all():
        return 0.0
    scale = np.maximum(np.abs(old), np.abs(new))
    apart = np.where(same, 0.0, np.abs(old - new) / np.where(scale > 0, scale, 1.0))
    return float(np.where(np.isnan(apart), np.inf, apart).max())
