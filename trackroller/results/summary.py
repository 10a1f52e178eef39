"""What `print` shows of the results of a study: ten lines on cases, factors, regimes, outputs and
what to take next.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from trackroller.parameters import REGIMES
from trackroller.results.solved_cases import SolvedCases

MOST_NAMED = 3  # factors or outputs of a line; of further ones their number is said
NEXT = (
    "next: .answer, .best(), .to_table(), .report(path), .explore(path), .indices(), "
    ".pareto(), .data (xarray)"
)


def summary_of(results: SolvedCases) -> str:
    """Return what a user wants to see first of the results of a study, in at most ten lines.

    Parameters
    ----------
    results : SolvedCases
        The solved study; nothing is analysed for it.
    """
    return "\n".join(_lines(results))


def _lines(results: SolvedCases) -> Iterator[str]:
    config = results.config
    described = ""
    if config.description:
        described = f": {config.description}"
    yield f"Study '{config.name}'{described}"
    missing = int(results.data.attrs.get("missing_cases", 0))
    left = ""
    if missing:
        left = f", {missing:,} not solved yet"
    yield f"cases    {len(results.table):,} ({config.method.name}){left}"
    yield f"factors  {_factors(results)}"
    yield f"model    {config.contact_model}, {config.accuracy}"
    yield f"regimes  {_regimes(results)}"
    for name in _outputs(results):
        yield _range(results, name)
    required = [f"{name} {_ends(own.ends)}" for name, own in config.requirement.items()]
    if required:
        yield f"required {', '.join(required)}"
    yield NEXT


def _factors(results: SolvedCases) -> str:
    """Return the first factors with their numbers of levels."""
    named = [f"{name} ({len(results.levels(name))})" for name in results.factors[:MOST_NAMED]]
    left = len(results.factors) - len(named)
    further = ""
    if left > 0:
        further = f" and {left} more"
    return ", ".join(named) + further


def _regimes(results: SolvedCases) -> str:
    """Return how many cases roll, skid, lift off or failed."""
    counts = np.bincount(results.regime.astype(int), minlength=len(REGIMES))
    parts = [
        f"{count:,} {name.replace('_', ' ')}"
        for name, count in zip(REGIMES, counts, strict=True)
        if count
    ]
    return ", ".join(parts)


def _outputs(results: SolvedCases) -> list[str]:
    """Return the outputs of the summary: the life that counts, and the outputs that the study asks
    for.
    """
    names = []
    if results.life is not None:
        names = [results.life[0]]
    names += [name for name in results.config.requirement if name not in names]
    return names[:MOST_NAMED]


def _range(results: SolvedCases, name: str) -> str:
    """Return the range of an output over the cases that roll."""
    values, units, words = results.quantity(name)
    own = values[results.rolling & ~np.isnan(values)]
    if not own.size:
        return f"{name}: not known in any case that rolls"
    if units in ("1", "-"):
        unit = ""
    else:
        unit = f" {units}"
    low = own.min()
    middle = np.quantile(own, 0.5, method="inverted_cdf")
    high = own.max()
    return f"{words} ({name}): {low:.4g} to {high:.4g}{unit}, median {middle:.4g}"


def _ends(ends: dict[str, float]) -> str:
    words = {"min": "at least", "max": "at most"}
    return " ".join(f"{words[end]} {value:g}" for end, value in ends.items())
