"""The plan of stages of a solution: which run, for how many cases or patches, which are skipped and
why.
"""

from __future__ import annotations

from collections.abc import Set
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trackroller.parameters.accuracy import PEAK_OUTPUTS, RUNGS
from trackroller.parameters.contact_models import DECLARED
from trackroller.roller import distinct_contacts
from trackroller.roller.case_limits import marks_of_limits

if TYPE_CHECKING:
    from trackroller.roller.case import CaseTable
    from trackroller.roller.options import Options


@dataclass(frozen=True)
class Stage:
    """A stage: does it run, on how many of how many (`unit` cases or patches), and why so."""

    name: str
    runs: bool
    count: int
    total: int
    unit: str
    why: str


def _model(options: Options) -> str:
    words = f"contact model {options.contact_model}"
    if options.tolerance is not None:
        shares = DECLARED[options.contact_model].cost.shares_of(options.tolerance.by_quantity)
        expected = ", ".join(
            f"{name} {100 * share:.0f} %" for name, share in zip(RUNGS, shares, strict=True)
        )
        words += f" on the rungs that each case needs, expected: {expected} of the cases"
    if not options.slip_terms:
        return words
    if options.contact_model == "sliding":
        return words + ", whose slip is the profile's anyway"
    return words + f"; the slip counts {' and '.join(options.slip_terms)}"


def explain(table: CaseTable, options: Options) -> list[Stage]:
    """Return the stages of a solution of cases in their order.

    Parameters
    ----------
    table : CaseTable
        The n cases.
    options : Options
        Options of the solution.

    Returns
    -------
    list of Stage
        For each stage: whether it runs, on how many cases or patches, and why.

    Notes
    -----
    The counts are those known before anything is solved. Cases that lift off or slip fully leave
    later stages.
    """
    n = len(table)
    shortcuts = options.shortcuts
    outputs = set(options.outputs)
    part = table
    if shortcuts and n > 1:
        marks = marks_of_limits(table, options)
        part = table.take(distinct_contacts.distinct_mechanics(table, marks)[0])
    mirrored = distinct_contacts.is_mirror_symmetric(part)
    free = distinct_contacts.is_frictionless(part)
    if not shortcuts:
        mirrored = free = np.zeros(len(part), dtype=bool)
    m = len(part)
    twins = int(mirrored.sum())
    frictionless = int(free.sum())
    solved = (2 * m - twins, 2 * n, "patches")  # a mirror-symmetric case has one patch to solve
    bare = 2 * frictionless - int((mirrored & free).sum())  # patches without friction
    sides = ""
    if twins:
        sides = f"; {twins} mirror-symmetric (no axial force): one contact each"
    repeated = "every case has mechanics of its own"
    if m < n:
        repeated = f"{n - m} cases repeat the mechanics of others"
    every = (2 * n, 2 * n, "patches")
    cases = (n, n, "cases")
    peaks = outputs & PEAK_OUTPUTS
    stages = [
        Stage("geometry, Hertz or half-space pressure", True, m, n, "cases", repeated),
        Stage("equilibrium", True, *solved, _model(options) + sides),
        _stage("friction work", {"friction_work"}, outputs, solved, "asked for" + sides),
    ]
    if options.stop_if is not None and peaks:
        why = f"{options.stop_if}: where it holds no peak is searched for"
        stages.append(Stage("stop condition", True, m, n, "cases", why))
    elif options.stop_if is not None:
        stages.append(
            Stage("stop condition", False, 0, n, "cases", "no stress is asked for: nothing to stop")
        )
    if (peaks and options.contact_model != "sliding") or "tractions" not in outputs:
        stages.append(_tractions(options, bool(peaks), solved[0] - bare, 2 * n, frictionless))
    peak = "serves " + " and ".join(sorted(peaks)) + sides
    if bare > 1:
        peak += f"; {bare} patches without friction: one search for each ellipticity and material"
    if options.stress_bodies == "published":
        peak += "; one body with the mean Poisson's ratio"
    return [
        *stages,
        _stage("peak stress", PEAK_OUTPUTS, outputs, solved, peak),
        _stage(
            "life", {"life"}, outputs, cases, "from peak stress, strength and speed of each case"
        ),
        _stage("tractions output", {"tractions"}, outputs, every, "asked for"),
        _stage("subsurface sections", {"subsurface"}, outputs, every, "asked for"),
    ]


def _tractions(
    options: Options, has_peaks: bool, patches: int, total: int, frictionless: int
) -> Stage:
    """Return the stage of the tractions of `patches` with friction, from which stresses are
    computed.
    """
    name = "tractions on a grid"
    if options.contact_model == "sliding":
        why = "not asked for: full sliding tractions are known in closed form"
        return Stage(name, False, 0, total, "patches", why)
    if not has_peaks:
        return Stage(name, False, 0, total, "patches", "no output needs them")
    why = "the stress of stick and slip needs them"
    if frictionless:
        why += f"; {frictionless} cases without friction have none"
    return Stage(name, patches > 0, patches, total, "patches", why)


def _stage(
    name: str, need: Set[str], outputs: set[str], size: tuple[int, int, str], why: str
) -> Stage:
    """Return a stage that runs if one of the outputs `need` is wanted; `size` has count, total and
    unit.
    """
    if need & outputs:
        return Stage(name, True, *size, why)
    return Stage(
        name, False, 0, *size[1:], f"no output needs it (it serves {' or '.join(sorted(need))})"
    )
