"""Latin hypercubes: one row in each of n strata of every factor."""

from __future__ import annotations

import numpy as np

from trackroller.methods import correlation
from trackroller.methods.method import Drawn, Factors, Settings
from trackroller.methods.sample import RandomSample


class LatinHypercube(RandomSample):
    """A Latin hypercube of `samples` rows. It cannot grow: a larger one has other strata."""

    name = "lhs"
    reference = (
        "Design: Latin hypercube",
        "McKay, Beckman, Conover (1979): A comparison of three methods for selecting values of "
        "input variables. "
        "Technometrics 21, 239–245",
    )

    def draw(self, free: Factors, n: int, seed: int, settings: Settings) -> Drawn:
        """Return quantiles; rank correlations change their order only."""
        from scipy.stats import qmc  # heavy, and a plan of a grid does not need it

        entries = tuple(settings[correlation.KEY])
        unit = qmc.LatinHypercube(d=len(free), rng=np.random.default_rng(seed)).random(n)
        return correlation.correlate(unit, correlation.copula(entries, free), strata=True), {
            correlation.KEY: entries
        }
