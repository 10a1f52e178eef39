"""What a study requires of its outputs."""

from __future__ import annotations

import numpy as np

from trackroller.results.answer import Required
from trackroller.results.results import Results


def required_of(results: Results) -> tuple[Required, ...]:
    """Return what a study requires, in the order of its file; empty without a requirement."""
    found = []
    for name, ends in results.config.analysis.target.items():
        _, units, words = results.quantity(name)
        least = float(ends.get("min", -np.inf))
        most = float(ends.get("max", np.inf))
        found.append(Required(name, words, units, least, most))
    return tuple(found)
