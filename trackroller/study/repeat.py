"""Solve one case of a study again and compare it with the stored result."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from trackroller.errors import InputError, WorkError
from trackroller.parameters import PARAMETERS
from trackroller.roller.differences import Difference, compare
from trackroller.roller.options import options_of_cases
from trackroller.roller.stored_inputs import solve_command
from trackroller.study.design.build import case_columns
from trackroller.study.design.growth import as_planned
from trackroller.study.store import chunks
from trackroller.study.store.fingerprint import StudyCases
from trackroller.study.store.folder import StudyFolder
from trackroller.study.store.ledger import Ledger

if TYPE_CHECKING:
    from trackroller.study.file.study import Study


@dataclass
class Repeat:
    """A case that was solved again.

    Attributes
    ----------
    case : dict
        Values of the case.
    options : dict
        Keyword arguments of `solve`.
    differences : dict of str to Difference
        Difference to the stored result, by variable.
    duty : dict, optional
        Hours a day and days a year of the study.
    """

    case: dict[str, Any]
    options: dict[str, Any]
    differences: dict[str, Difference]
    duty: dict[str, float] | None = None

    def command(self) -> str:
        """Return a command that solves the case without the study."""
        settings = self.case | self.options
        if self.duty:
            settings["duty"] = self.duty
        return solve_command(settings)


def repeat_case(study: Study, number: int, folder: StudyFolder) -> Repeat:
    """Solve a case of a study again and compare it with the stored result.

    Parameters
    ----------
    study : Study
        The checked study.
    number : int
        Number of the case: the variable `case` of `study.nc`.
    folder : StudyFolder
        Its folder.

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

    study = as_planned(study, folder.record())
    ledger = Ledger(StudyCases(study), folder)
    design = ledger.cases.design
    state_number = ledger.state_number
    if not 0 <= number < len(state_number):
        raise InputError("case", number, f"a case number from 0 to {len(state_number) - 1}")
    if state_number[number] < 0:
        raise WorkError("this case is not solved by this version of the program: run the study first.")
    options, group = options_of_cases(design, {})
    state = ledger.states.isel(case=state_number[[number]])
    before = chunks.read(ledger.paths[state["file"].item()]).isel(case=state["row"].values)
    row = design.drop_vars(list(design.coords)).drop_attrs().isel(case=[number])
    solved = solve(row, database=study.materials, **options[group[number]])
    again = chunks.from_results(solved, state["case"].values)
    again = chunks.join([before.isel(case=[]), again])  # a failed case lacks results of others
    loads = {name: ("case", row[name].values) for name in row.data_vars if name not in before.variables}
    differences = compare(before.assign_coords(loads), again.assign_coords(loads))
    case: dict[str, Any] = {}
    for name in case_columns(row):
        value = row[name].values[0]
        if name in PARAMETERS:
            case[name] = float(value)
        else:
            case[name] = str(value)
    return Repeat(case, dict(options[group[number]]), differences, study.config.duty and dict(study.config.duty))
