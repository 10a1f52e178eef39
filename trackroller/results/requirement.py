"""What a study requires of its outputs."""

from __future__ import annotations

from trackroller.results.answer import Required
from trackroller.results.solved_cases import SolvedCases


def required_of(results: SolvedCases) -> tuple[Required, ...]:
    """Return what a study requires, in the order of its file; empty without a requirement."""
    found = []
    for name, own in results.config.requirement.items():
        _, units, words = results.quantity(name)
        found.append(Required(name, words, units, own.least, own.most, own.probability, own.years))
    return tuple(found)
