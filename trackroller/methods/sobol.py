"""Scrambled Sobol sequences: rows that fill the ranges evenly, and that stay when more of them are
drawn.
"""

from __future__ import annotations

import warnings

import numpy as np

from trackroller.methods import correlation
from trackroller.methods.method import Drawn, Factors, Settings
from trackroller.methods.replicates import in_turn
from trackroller.methods.sample import RandomSample


class Sobol(RandomSample):
    """The first `samples` rows of a scrambled Sobol sequence, or of several that take turns."""

    name = "sobol"
    takes = {**RandomSample.takes, "replicates": 1}
    grows = True
    reference = (
        "Design: Sobol sequence",
        "Sobol (1967): On the distribution of points in a cube and the approximate evaluation of "
        "integrals. "
        "USSR Comput. Math. Math. Phys. 7, 86–112",
    )

    def draw(self, free: Factors, n: int, seed: int, settings: Settings) -> Drawn:
        """Return quantiles; a correlated row depends on no other row."""
        entries = tuple(settings[correlation.KEY])
        copies = settings["replicates"]
        root = correlation.copula(entries, free)

        def one(seed: int) -> np.ndarray:
            return correlation.correlate(
                sobol_rows(len(free), n // copies, seed), root, strata=False
            )

        return in_turn(one, seed, copies), {correlation.KEY: entries}


def sobol_rows(count: int, n: int, seed: int) -> np.ndarray:
    """Return the first n rows of a scrambled Sobol sequence of `count` factors, quantiles of shape
    (n, count).
    """
    from scipy.stats import qmc  # heavy, and a plan of a grid does not need it

    engine = qmc.Sobol(d=count, rng=np.random.default_rng(seed))
    with warnings.catch_warnings():
        # the balance of a Sobol sequence needs a power of two
        warnings.simplefilter("ignore", UserWarning)
        return np.asarray(engine.random(n))
