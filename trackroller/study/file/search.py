"""Check the keys of a study file that state what a search for designs aims at.

method: optimise
goals: {pair_life_hours: max, mean(friction_power): min, probability(pair_life_hours): max}
budget: {designs: 640, hours: 2}
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel, ConfigDict, Field

from trackroller.errors import InputError
from trackroller.methods.factor import Factor
from trackroller.parameters import PARAMETERS
from trackroller.study.design.roles import scattered
from trackroller.study.file.goals import STATISTICS_OF, check_statistic, names_of_outputs, statistic

JUDGED_BY = STATISTICS_OF["goals"]  # over the conditions of a design


class Budget(BaseModel):
    """The key `budget` of a study file; each field has a description."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    designs: int = Field(
        640,
        ge=1,
        le=1_000_000,
        description="largest number of designs of the search; polishing and checks come on top",
    )
    population: int | None = Field(
        None,
        ge=4,
        le=10_000,
        description="designs of a generation; default a twentieth of the designs, 8 to 32",
    )
    hours: float | None = Field(
        None, gt=0, description="time of solving on one core, all runs together"
    )

    @property
    def generation(self) -> int:
        """Return the number of designs of a generation."""
        return min(self.designs, self.population or min(max(self.designs // 20, 8), 32))


def judged_by(goal: str) -> tuple[str, str]:
    """Split a goal of a search into its statistic over the conditions and its result; a plain name
    is its `worst`.
    """
    kind, output = statistic(goal, JUDGED_BY)
    return kind or "worst", output


def check_search(config: Any, factors: Mapping[str, Factor]) -> None:
    """Check the goals of a search, and refuse them in every other design."""
    if not config.method.proposes:
        if config.question == "best":
            remedy = "Write method: optimise and goals, or question: decide."
            raise InputError(
                "question",
                config.question,
                "another question: only a search finds the best",
                remedy,
            )
        if config.goals:
            remedy = "Use method: optimise, or name the goals under pareto."
            raise InputError("goals", config.method_name, "method: optimise", remedy)
        return
    if config.pareto:
        raise InputError(
            "pareto", list(config.pareto), "goals, with method optimise", "Rename the key to goals."
        )
    if len({judged_by(goal) for goal in config.goals}) < len(config.goals):
        raise InputError(
            "goals", list(config.goals), "each result once with a statistic", "Remove one of them."
        )
    known = names_of_outputs(config)
    free = [*known, *factors, *PARAMETERS]
    for goal in config.goals:
        _check_goal(config, goal, factors, free, known)
    if any(not f.discrete for n, f in factors.items() if n in scattered(factors, config.roles)):
        if "samples" not in config.model_fields_set:
            allowed = "the number of drawn conditions at which each design is judged"
            raise InputError("samples", None, allowed, "Write samples: 32, for example.")


def _check_goal(
    config: Any, goal: str, factors: Mapping[str, Factor], free: list[str], known: list[str]
) -> None:
    kind, output = judged_by(goal)
    if kind == "worst":
        known = free
    check_statistic(config, ("goals", goal), kind, output, known)
    if output in factors and not factors[output].numeric:
        raise InputError(
            "goals", goal, "a result or factor with one number a case", "Names have no order."
        )
