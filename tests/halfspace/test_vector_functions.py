"""The branchless elementary functions of the stress kernels equal those of the mathematics library."""

import numba
import numpy as np
import pytest

from trackroller.halfspace import vectors
from trackroller.numerics.compiled import FAST

exp, sine_cosine, log, angle = vectors.exp, vectors.sine_cosine, vectors.log, vectors.angle


@numba.njit(fastmath=FAST, error_model="numpy")
def evaluate(which, x, y, out):
    for i in range(x.size):
        if which == 0:
            out[i] = exp(x[i])
        elif which == 1:
            out[i] = sine_cosine(x[i])[0]
        elif which == 2:
            out[i] = sine_cosine(x[i])[1]
        elif which == 3:
            out[i] = log(x[i])
        else:
            out[i] = angle(y[i], x[i])


RNG = np.random.default_rng(1)
WIDE = RNG.standard_normal(5000) * 10 ** RNG.uniform(-12, 3, 5000)


@pytest.mark.parametrize(
    "which, x, y, expected",
    [
        (0, np.linspace(-60, 60, 5001), None, lambda x, y: np.exp(x)),
        (1, np.linspace(-20, 20, 5001), None, lambda x, y: np.sin(x)),
        (2, np.linspace(-20, 20, 5001), None, lambda x, y: np.cos(x)),
        (3, 10 ** RNG.uniform(-300, 300, 5000), None, lambda x, y: np.log(x)),
        (4, WIDE, 10 ** RNG.uniform(-14, 3, 5000), lambda x, y: np.arctan2(y, x)),
        (4, np.array([0.0, 1.0, -1.0]), np.array([1.0, 1e-30, 1e-30]), lambda x, y: np.arctan2(y, x)),
    ],
)
def test_equals_the_library(which, x, y, expected):
    """Within 2e-11 relative to the value or 1e-11 where that is near zero, over the ranges that are stated."""
    out = np.empty_like(x)
    evaluate(which, x, x if y is None else y, out)
    np.testing.assert_allclose(out, expected(x, y), rtol=2e-11, atol=1e-11)
