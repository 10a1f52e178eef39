"""What a study requires of its outputs."""

from __future__ import annotations

from dataclasses import replace

from trackroller.damage.wear import KM_PER_HOUR
from trackroller.numerics.numbers import number_or_nan
from trackroller.results.answer import Required
from trackroller.results.life_columns import FIRST_LIMIT
from trackroller.results.solved_cases import SolvedCases
from trackroller.roller.requirement import Requirement


def requirements_of(results: SolvedCases) -> dict[str, Requirement]:
    """Return what a study requires by output: its key `requirement`, and the travel that its base
    requires.

    The travel is a life to the first limit, as on the sheet of one roller.
    """
    requirements = dict(results.config.requirement)
    hours = _hours_of_travel(results)
    if hours > 0:
        own = requirements.get(FIRST_LIMIT[0], Requirement())
        requirements[FIRST_LIMIT[0]] = replace(own, least=max(own.least, hours))
    return requirements


def required_of(results: SolvedCases) -> tuple[Required, ...]:
    """Return what a study requires, in the order of its file; empty without a requirement."""
    required = []
    for name, own in requirements_of(results).items():
        _, units, words = results.quantity(name)
        required.append(
            Required(name, words, units, own.least, own.most, own.probability, own.years)
        )
    return tuple(required)


def _hours_of_travel(results: SolvedCases) -> float:
    """Return the required travel in hours; 0 without one, without limits, and where travel or
    velocity varies.
    """
    if FIRST_LIMIT[0] not in results.table:
        return 0.0
    travel = number_or_nan(results.base.get("required_travel"))
    velocity = number_or_nan(results.base.get("velocity"))
    if travel > 0 and velocity > 0:
        return travel / (KM_PER_HOUR * velocity)
    return 0.0
