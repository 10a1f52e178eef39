"""Narrow down where conditions end, several at a time."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np


def narrowed(
    brackets: Sequence[tuple[float, float]],
    rounds: Sequence[int],
    holds: Callable[[list[int], list[float]], Sequence[bool]],
) -> list[tuple[float, float]]:
    """Narrow brackets, each from a value at which a condition holds to a value at which it does not.

    Parameters
    ----------
    brackets : sequence of tuple of float
        The value at which the condition of each bracket holds, and the value at which it does not.
    rounds : sequence of int
        Number of equal parts into which each round cuts every bracket.
    holds : callable
        Receives the numbers of brackets and a value for each, and returns whether the condition holds there. A round
        asks for the values of all brackets at once, because many cases are solved faster together.

    Returns
    -------
    list of tuple of float
        The brackets: each is the first part of the earlier one at whose end the condition does not hold.

    Examples
    --------
    >>> narrowed([(0.0, 8.0), (0.0, -8.0)], (8, 4), lambda numbers, values: [abs(value) < 2.3 for value in values])
    [(2.25, 2.5), (-2.25, -2.5)]
    """
    ends = list(brackets)
    for parts in rounds if ends else ():
        inner = [np.linspace(*pair, parts + 1)[1:-1].tolist() for pair in ends]
        numbers = [number for number, values in enumerate(inner) for _ in values]
        answers = iter(holds(numbers, [value for values in inner for value in values]))
        for number, values in enumerate(inner):
            truths = [bool(next(answers)) for _ in values]
            line = [ends[number][0], *values, ends[number][1]]
            last = [*truths, False].index(False)  # the last value before the first one at which the condition fails
            ends[number] = line[last], line[last + 1]
    return ends
