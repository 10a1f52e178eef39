"""Functions of numbers whose sensitivity indices are known in closed form."""

import numpy as np

PI = np.pi


def ishigami(x1, x2, x3):
    """Return the function of Ishigami & Homma (1990) with a = 7, b = 0.1."""
    return np.sin(x1) + 7 * np.sin(x2) ** 2 + 0.1 * x3**4 * np.sin(x1)


def ishigami_indices():
    """Return first-order and total indices and the one second-order index that is not 0, from the closed forms."""
    v1, v2, v13 = 0.5 * (1 + 0.1 * PI**4 / 5) ** 2, 49 / 8, 8 * 0.01 * PI**8 / 225
    v = v1 + v2 + v13
    return np.array([v1, v2, 0]) / v, np.array([v1 + v13, v2, v13]) / v, v13 / v
