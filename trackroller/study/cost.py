"""What solving costs: cases a second and bytes a case, for `plan` and for the size of chunks."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from itertools import product
from typing import TYPE_CHECKING, Any

from trackroller.contact.friction_laws import law_of
from trackroller.damage import first_limit
from trackroller.methods import METHODS
from trackroller.parameters import OPTIONS
from trackroller.parameters.accuracy import PEAK_OUTPUTS, tolerance_of
from trackroller.parameters.contact_models import (
    DECLARED,
    SOLVED_PATCHES,
    YARDSTICK,
    measured_costs,
)
from trackroller.study.design.factor_names import OPTION_FACTORS

if TYPE_CHECKING:
    from trackroller.study.file.study import Study

_TRACTIONS = 1e-3
_SUBSURFACE = 0.1
START = 3.0  # seconds of one core: to import, plan and load the compiled solver
PAGES_OF_ARRAY = 3.0  # seconds: figures and page
PAGES_OF_SAMPLE = 5.0  # a random sample has given-data measures
PAGES_A_CASE = 3.5e-4  # seconds: gathering, analysis, figures and page of a large study
# MB of a process that gathers or reports: what it imports, and the figures of a small study
MEGABYTES_OF_PROGRAM = 1000
# memory of a large study over its place on the disk
COPIES = 2.5
_BYTES = {
    "forces": 200,
    "contact": 120,
    "friction_work": 40,
    "peak_stress": 160,
    "life": 90,
    "tractions": 300_000,
    "subsurface": 1_500_000,
}
_BYTES_OF_A_LIMIT = 150
# share of the processor time of solving that threads divide among them; measured on random designs
# without limits of patches
SHARED = 0.7
_FILM = "layer_flexibility"
_WITH_HEAT = "limits with heat"  # what was measured for cases that give the fields of heat
_HEATED = {"heat_transfer_coefficient", "cooled_area"}  # fields of a case, which few cases give


def rate(
    options: Mapping[str, Any], friction_law: Any = None, fields: Collection[str] = ()
) -> float:
    """Return the expected cases a second on one core.

    Parameters
    ----------
    options : mapping
        Keyword arguments of `solve`.
    friction_law : str or mapping, optional
        Friction law of a case.
    fields : collection of str
        Fields that a case gives and that are not 0; a film and the fields of the limit of heat take
        time.
    """
    accuracy = options.get("accuracy", "standard")
    groups = set(options.get("outputs", ("forces",)))
    model = options.get("contact_model", OPTIONS["contact_model"].default)
    peaks = bool(groups & PEAK_OUTPUTS)
    tolerance = tolerance_of(accuracy, groups)
    cost = DECLARED[model].cost_of(not law_of(friction_law).is_constant, _FILM in fields)
    if options.get("normal") == "halfspace":
        cost = SOLVED_PATCHES
    if tolerance is not None:
        accuracy = tolerance.by_quantity
    seconds, searched = cost.at(accuracy)
    if peaks:  # one search serves all
        seconds += searched
    if "tractions" in groups:
        seconds += _TRACTIONS
    if "subsurface" in groups:
        seconds += _SUBSURFACE
    return 1.0 / (seconds + _seconds_of_limits(groups, options.get("not_checked", ()), fields))


def _seconds_of_limits(
    groups: Collection[str], not_checked: Collection[str], fields: Collection[str]
) -> float:
    """Return the expected time of the limits of a case on one core; those of forces take none."""
    ratios: dict[str, float] = measured_costs()["limits"]
    spent = sum(
        ratio for name, ratio in ratios.items() if name in groups and name != first_limit.GROUP
    )
    if first_limit.GROUP in groups:
        heats = set(fields) >= _HEATED and not {"heat"} & {*groups, *not_checked}
        shakes = not {"shakedown"} & {*groups, *not_checked}
        # the materials of the database have what shakedown needs
        if shakes:
            spent += ratios[first_limit.GROUP]
        if heats:
            spent += max(ratios[_WITH_HEAT] - ratios[first_limit.GROUP], 0.0)
    return YARDSTICK * spent


def study_rate(study: Study, accuracy: str | None = None) -> float:
    """Return the expected cases a second of a study, in which model, normal problem, friction and
    film may be factors, at its own accuracy or on another rung.
    """
    stated = study.options
    if accuracy is not None:
        stated = stated | {"accuracy": accuracy}
    varied = {
        name: spec["values"] for name, spec in study.factors.items() if name in OPTION_FACTORS
    }
    options = [
        stated | dict(zip(varied, values, strict=True)) for values in product(*varied.values())
    ]
    given = {name for name, value in study.config.base.items() if value} | set(study.factors)
    films = study.factors.get(_FILM, {}).get("values", [_FILM in given])
    several = []
    for one, law, film in product(options, study.friction_laws, films):
        fields = given - {_FILM}
        if film:
            fields = given | {_FILM}
        several.append(rate(one, law, fields))
    return len(several) / sum(1.0 / each for each in several)


def seconds_on(cores: int, seconds: float) -> float:
    """Return the time [s] that a process with so many threads takes for what takes one core
    `seconds`.
    """
    return seconds * (1.0 - SHARED + SHARED / cores)


def seconds_of_report(design: str, cases: int) -> float:
    """Return the expected time on one core [s] to gather and analyse a study, draw its figures and
    write its page.
    """
    return (PAGES_OF_ARRAY if METHODS[design].quick else PAGES_OF_SAMPLE) + cases * PAGES_A_CASE


def bytes_a_case(outputs: tuple[str, ...]) -> int:
    """Return the expected size of a case on the disk, chunk and gathered set together."""
    return 2 * (60 + sum(_BYTES.get(group, _BYTES_OF_A_LIMIT) for group in set(outputs)))


def megabytes_of_report(outputs: tuple[str, ...], cases: int) -> int:
    """Return the memory [MB] in which a study is gathered, analysed, drawn and shown.

    Parameters
    ----------
    outputs : tuple of str
        Groups of outputs of the study.
    cases : int
        Number of its cases.

    Notes
    -----
    The values of a study are in memory twice, in their data set and in the table of cases, and
    parts of them a third time. See "Plan ten million cases" in the docs for measured peaks.
    """
    return MEGABYTES_OF_PROGRAM + round(COPIES * cases * bytes_a_case(outputs) / 1e6)


def duration(seconds: float) -> str:
    """Return a time in words: '45 s', '3 min 20 s', '2 h 5 min'."""
    whole = int(seconds + 0.5)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"
