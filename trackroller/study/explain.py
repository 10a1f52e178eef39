"""The plan of stages of a solution: which run, for how many cases or patches, which are skipped and why."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from trackroller.roller import requirements

if TYPE_CHECKING:
    from trackroller.roller.case import CaseTable
    from trackroller.roller.options import Options


PEAK = {"peak_stress", "life", "subsurface"}  # outputs that the search for the peak serves


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


@dataclass(frozen=True)
class _Counts:
    """What the stages of a solution work on: cases, distinct mechanics, patches, and those that are left out."""

    cases: int
    distinct: int
    patches: int
    frictionless: int
    bare: int
    sides: str

    @classmethod
    def of(cls, table: CaseTable, shortcuts: bool) -> _Counts:
        n = len(table)
        part = table.take(requirements.distinct_mechanics(table)[0]) if shortcuts and n > 1 else table
        mirrored, free = requirements.is_mirror_symmetric(part), requirements.is_frictionless(part)
        twins = int(mirrored.sum()) if shortcuts else 0
        sides = f"; {twins} mirror-symmetric (no axial force): one contact each" if twins else ""
        bare = 2 * int(free.sum()) - int((mirrored & free).sum())
        return cls(n, len(part), 2 * len(part) - twins, int(free.sum()), bare, sides)


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
    found, wanted = _Counts.of(table, options.shortcuts), set(options.outputs)
    asked = wanted & PEAK
    n, m = found.cases, found.distinct
    repeated = f"{n - m} cases repeat the mechanics of others" if m < n else "every case has mechanics of its own"
    why, both = _model(options) + found.sides, (found.patches, 2 * n, "patches")
    told = [
        Stage("geometry, Hertz or half-space pressure", True, m, n, "cases", repeated),
        Stage("equilibrium", True, found.patches, 2 * n, "patches", why),
        _stage(
            "friction work", {"friction_work"}, wanted, (found.patches, 2 * n, "patches"), "asked for" + found.sides
        ),
    ]
    if options.stop_if is not None:
        holds = f"{options.stop_if}: where it holds no peak is searched for"
        why = holds if asked else "no stress is asked for: nothing to stop"
        told.append(Stage("stop condition", bool(asked), m if asked else 0, n, "cases", why))
    if (asked and options.contact_model != "sliding") or "tractions" not in wanted:
        told.append(_grid_stage(found, options, bool(asked)))
    return [
        *told,
        _stage("peak stress", PEAK, wanted, both, _peak_words(found, options, asked)),
        _stage("life", {"life"}, wanted, (n, n, "cases"), "from peak stress, strength and speed of each case"),
        _stage("tractions output", {"tractions"}, wanted, (2 * n, 2 * n, "patches"), "asked for"),
        _stage("subsurface sections", {"subsurface"}, wanted, (2 * n, 2 * n, "patches"), "asked for"),
    ]


def _stage(name: str, need: set[str], wanted: set[str], size: tuple[int, int, str], why: str) -> Stage:
    """Return a stage that runs if one of the outputs `need` is wanted; `size` has count, total and unit."""
    count, total, unit = size
    if need & wanted:
        return Stage(name, True, count, total, unit, why)
    return Stage(name, False, 0, total, unit, f"no output needs it (it serves {' or '.join(sorted(need))})")


def _grid_stage(found: _Counts, options: Options, asked: bool) -> Stage:
    """Return the stage that computes tractions on a grid for the stress of stick and slip."""
    count, why = 0, "no output needs them"
    if options.contact_model == "sliding":
        why = "not asked for: full sliding tractions are known in closed form"
    elif asked:
        count = found.patches - found.bare if options.shortcuts else found.patches
        none = found.frictionless and options.shortcuts
        why = "the stress of stick and slip needs them"
        why += f"; {found.frictionless} cases without friction have none" if none else ""
    return Stage("tractions on a grid", count > 0, count, 2 * found.cases, "patches", why)


def _peak_words(found: _Counts, options: Options, asked: set[str]) -> str:
    why = "serves " + " and ".join(sorted(asked)) + found.sides
    if options.shortcuts and found.bare > 1:
        why += f"; {found.bare} patches without friction: one search for each ellipticity and material"
    return why + ("; one body with the mean Poisson's ratio" if options.stress_bodies == "published" else "")
