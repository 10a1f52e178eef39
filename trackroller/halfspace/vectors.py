"""Elementary functions as branch-free arithmetic, so that loops over them run in vector registers.

The functions of the mathematics library take one number at a time. The relative errors here are
below 1e-11 in the stated ranges, far below the errors of the quadratures
(tests/halfspace/test_vector_functions.py).
"""

from __future__ import annotations

import math

import numpy as np

from trackroller.numerics.compiled import inner


@inner
def exp(x):
    """Return e^x for |x| < 700: a power of two by its bits, times Taylor's series."""
    k = math.floor(x * 1.4426950408889634 + 0.5)
    r = (x - k * 0.693147180369123816490) - k * 1.90821492927058770002e-10
    e = 1 / 5040 + r * (1 / 40320 + r * (1 / 362880 + r * (1 / 3628800 + r * (1 / 39916800))))
    e = 1.0 + r * (
        1.0 + r * (0.5 + r * (1 / 6 + r * (1 / 24 + r * (1 / 120 + r * (1 / 720 + r * e)))))
    )
    return e * np.int64((np.int64(k) + 1023) << 52).view(np.float64)


@inner
def sine_cosine(x):
    """Return sin x and cos x for |x| < 100."""
    turns = math.floor(x * (2.0 / math.pi) + 0.5)
    r = (x - turns * 1.5707963267341256) - turns * 6.077100506506192e-11
    q = r * r
    s = 1 / 362880 - q * (1 / 39916800 - q * (1 / 6227020800))
    s = r * (1.0 - q * (1 / 6 - q * (1 / 120 - q * (1 / 5040 - q * s))))
    c = 1 / 40320 - q * (1 / 3628800 - q * (1 / 479001600 - q * (1 / 87178291200)))
    c = 1.0 - q * (0.5 - q * (1 / 24 - q * (1 / 720 - q * c)))
    quarter = turns - 4.0 * math.floor(0.25 * turns)
    odd = quarter == 1.0 or quarter == 3.0
    first, second = (c, s) if odd else (s, c)
    return (-first if quarter >= 2.0 else first), (
        -second if quarter == 1.0 or quarter == 2.0 else second
    )


@inner
def log(x):
    """Return ln x for normal x > 0: the exponent by its bits, the mantissa by the series of
    artanh.
    """
    bits = np.float64(x).view(np.int64)
    exponent = float((bits >> 52) - 1023)
    m = np.int64((bits & 0xFFFFFFFFFFFFF) | 0x3FF0000000000000).view(np.float64)
    large = m > 1.4142135623730951
    m = 0.5 * m if large else m
    exponent = exponent + 1.0 if large else exponent
    f = (m - 1.0) / (m + 1.0)
    q = f * f
    series = 1.0 + q * (
        1 / 3 + q * (1 / 5 + q * (1 / 7 + q * (1 / 9 + q * (1 / 11 + q * (1 / 13 + q * (1 / 15))))))
    )
    return exponent * 0.6931471805599453 + 2.0 * f * series


@inner
def angle(y, x):
    """Return atan2(y, x) for y > 0."""
    a = abs(x)
    low, high = min(a, y), max(a, y)
    wide = low > 0.41421356237309503 * high
    t = (low - high if wide else low) / (low + high if wide else high)
    q = t * t
    at = 1 / 15 - q * (1 / 17 - q * (1 / 19 - q * (1 / 21 - q * (1 / 23 - q * (1 / 25)))))
    at = 1.0 - q * (
        1 / 3 - q * (1 / 5 - q * (1 / 7 - q * (1 / 9 - q * (1 / 11 - q * (1 / 13 - q * at)))))
    )
    at = t * at
    at = at + 0.7853981633974483 if wide else at
    at = 1.5707963267948966 - at if y > a else at
    return math.pi - at if x < 0.0 else at
