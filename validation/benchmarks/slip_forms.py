"""Measure what the division in the stable form of eq. (21) costs the stress kernels.

    python -m validation.benchmarks.slip_forms

The stress below a sliding ellipse needs the slip along every ray. The benchmark times a sum of slips over 4 million
points with `rolling_slip`, which does not cancel at small x, and with `rolling_slip_without_division`.
"""

from __future__ import annotations

import time

import numpy as np
from numba import njit

from trackroller.halfspace.rigid_slip import rolling_slip, rolling_slip_without_division
from trackroller.numerics.compiled import FAST
from validation.benchmarks.command import run


@njit(fastmath=FAST, error_model="numpy")
def _stable(x, sine, cosine, radius, shift):
    total = 0.0
    for i in range(x.size):
        total += abs(rolling_slip(x[i], sine, cosine, radius, shift))
    return total


@njit(fastmath=FAST, error_model="numpy")
def _quick(x, sine, cosine, radius, shift):
    total = 0.0
    for i in range(x.size):
        total += abs(rolling_slip_without_division(x[i], sine, cosine, radius, shift))
    return total


def measure(repeats: int = 30) -> dict[str, float]:
    """Return the shortest processor time of each form over the same points, over that of the quicker form."""
    given = (np.linspace(-0.4, 0.4, 4_000_000), 0.5, 0.75**0.5, 6.0, -0.05)
    found = {}
    for name, total in (("stable", _stable), ("without division", _quick)):
        total(*given)
        spent = []
        for _ in range(repeats):
            start = time.thread_time()
            total(*given)
            spent.append(time.thread_time() - start)
        found[name] = min(spent)
    return {name: seconds / min(found.values()) for name, seconds in found.items()}


if __name__ == "__main__":
    run(measure, __doc__)
