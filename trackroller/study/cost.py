"""What solving costs: cases a second and bytes a case, for `plan` and for the size of chunks."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product
from typing import TYPE_CHECKING, Any

from trackroller.contact.friction_laws import law_of
from trackroller.damage import verdict
from trackroller.methods import METHODS
from trackroller.parameters import OPTIONS
from trackroller.parameters.accuracy import PEAK_OUTPUTS, tolerance_of
from trackroller.parameters.contact_models import DECLARED, SOLVED_PATCHES
from trackroller.study.design.entries import OPTION_FACTORS

if TYPE_CHECKING:
    from trackroller.study.file.study import Study

_TRACTIONS = 1e-3
_SUBSURFACE = 0.1
START = 3.0  # seconds of one core: to import, plan and load the compiled solver
PAGES_OF_ARRAY = 3.0  # seconds: figures and page
PAGES_OF_SAMPLE = 5.0  # a random sample has given-data measures
PAGES_A_CASE = 3.5e-4  # seconds: gathering, analysis, figures and page of a large study
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
# s; the limits of forces take no time
_PATCH_LIMITS = {"shakedown": 0.012, "heat": 0.004, "multiaxial": 0.06}


def rate(options: Mapping[str, Any], friction_law: Any = None) -> float:
    """Return the expected cases a second on one core for keyword arguments of `solve` and a
    friction law of a case.
    """
    accuracy = options.get("accuracy", "standard")
    groups = set(options.get("outputs", ("forces",)))
    model = options.get("contact_model", OPTIONS["contact_model"].default)
    peaks = bool(groups & PEAK_OUTPUTS)
    tolerance = tolerance_of(accuracy, groups)
    if law_of(friction_law).is_constant:
        cost = DECLARED[model].cost
    else:
        cost = DECLARED[model].falling or DECLARED[model].cost
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
    if verdict.GROUP in groups and "shakedown" not in options.get("not_checked", ()):
        # the materials of the database have what it needs; heat needs fields that few cases give
        groups.add("shakedown")
    seconds += sum(_PATCH_LIMITS.get(group, 0.0) for group in groups)
    return 1.0 / seconds


def study_rate(study: Study) -> float:
    """Return the expected cases a second of a study, in which model, normal problem and friction
    may be factors.
    """
    varied = {
        name: spec["values"] for name, spec in study.factors.items() if name in OPTION_FACTORS
    }
    options = [
        study.options | dict(zip(varied, values, strict=True))
        for values in product(*varied.values())
    ]
    several = [rate(*each) for each in product(options, study.friction_laws)]
    return len(several) / sum(1.0 / each for each in several)


def seconds_of_report(design: str, cases: int) -> float:
    """Return the expected time on one core [s] to gather and analyse a study, draw its figures and
    write its page.
    """
    return (PAGES_OF_ARRAY if METHODS[design].quick else PAGES_OF_SAMPLE) + cases * PAGES_A_CASE


def bytes_a_case(outputs: tuple[str, ...]) -> int:
    """Return the expected size of a case on the disk, chunk and gathered set together."""
    return 2 * (60 + sum(_BYTES.get(group, _BYTES_OF_A_LIMIT) for group in set(outputs)))


def duration(seconds: float) -> str:
    """Return a time in words: '45 s', '3 min 20 s', '2 h 5 min'."""
    whole = int(seconds + 0.5)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"
