"""The plan of stages of a solution: which run, for how many cases or patches, which are spared and why."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trackroller.roller import requirements

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
    told = f"contact model {options.contact_model}"
    if not options.slip_terms:
        return told
    if options.contact_model == "sliding":
        return told + ", whose slip is the profile's anyway"
    return told + f"; the slip counts {' and '.join(options.slip_terms)}"


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
    The counts are those known before anything is solved. Cases that lift off or slip fully leave later stages.
    """
    n, on = len(table), options.shortcuts
    rows = requirements.distinct_mechanics(table)[0] if on and n > 1 else np.arange(n)
    part = table.take(rows)
    twins = int(requirements.is_mirror_symmetric(part).sum()) if on else 0
    free = int(requirements.is_frictionless(part).sum())
    wanted = set(options.outputs)
    asked = wanted & {"peak_stress", "life", "subsurface"}
    m, patches = len(rows), 2 * len(rows) - twins
    bare = 2 * free - int((requirements.is_mirror_symmetric(part) & requirements.is_frictionless(part)).sum())
    sides = f"; {twins} mirror-symmetric (no axial force): one contact each" if twins else ""
    told = [
        Stage(
            "geometry, Hertz or half-space pressure",
            True,
            m,
            n,
            "cases",
            f"{n - m} cases repeat the mechanics of others" if m < n else "every case has mechanics of its own",
        ),
        Stage("equilibrium", True, patches, 2 * n, "patches", _model(options) + sides),
    ]

    def stage(name: str, need: set[str], unit: str, count: int, total: int, why: str) -> None:
        missing = " or ".join(sorted(need))
        runs = bool(need & wanted)
        told.append(
            Stage(
                name,
                runs,
                count if runs else 0,
                total,
                unit,
                why if runs else f"no output needs it (it serves {missing})",
            )
        )

    stage("friction work", {"friction_work"}, "patches", patches, 2 * n, "asked for" + sides)
    if options.stop_if is not None:
        told.append(
            Stage(
                "stop condition",
                bool(asked),
                m if asked else 0,
                n,
                "cases",
                f"{options.stop_if}: where it holds no peak is searched for"
                if asked
                else "no stress is asked for: nothing to stop",
            )
        )
    if asked and options.contact_model != "sliding":
        rubbing = patches - bare if on else patches
        told.append(
            Stage(
                "tractions on a grid",
                rubbing > 0,
                rubbing,
                2 * n,
                "patches",
                "the stress of stick and slip needs them"
                + (f"; {free} cases without friction have none" if free and on else ""),
            )
        )
    elif "tractions" not in wanted:
        told.append(
            Stage(
                "tractions on a grid",
                False,
                0,
                2 * n,
                "patches",
                "not asked for: full sliding tractions are known in closed form"
                if options.contact_model == "sliding"
                else "no output needs them",
            )
        )
    why = "serves " + " and ".join(sorted(asked)) + sides
    if on and bare > 1:
        why += f"; {bare} patches without friction: one search for each ellipticity and material"
    if options.stress_bodies == "published":
        why += "; one body with the mean Poisson's ratio"
    stage("peak stress", {"peak_stress", "life", "subsurface"}, "patches", patches, 2 * n, why)
    stage("life", {"life"}, "cases", n, n, "from peak stress, strength and speed of each case")
    stage("tractions output", {"tractions"}, "patches", 2 * n, 2 * n, "asked for")
    stage("subsurface sections", {"subsurface"}, "patches", 2 * n, 2 * n, "asked for")
    return told
