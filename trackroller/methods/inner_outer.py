"""Inner/outer arrays (crossed arrays, Taguchi): one sample of what scatters at each of several
design points.

The same inner sample at every point (common random numbers) keeps chance out of differences between
the points. Their analysis is that of a distribution at each point, see `trackroller.methods.b10`
and `trackroller.methods.probability`.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from trackroller.errors import InputError
from trackroller.methods.factor import Factor
from trackroller.methods.grid import Grid
from trackroller.methods.method import METHODS, Drawn, Factors, Key, Method, Settings, in_order


class InnerOuter(Method):
    """A grid of the listed factors (outer array) times `samples` rows of those that scatter (inner
    array).
    """

    name = "inner_outer"
    takes = {
        "rank_correlations": (),
        "replicates": 1,
        "inner": Key(
            Literal["lhs", "sobol"], "sobol", "how the inner array is sampled; default sobol"
        ),
        "point_samples": (),
    }
    sampled = weighted = grows = points = True
    judged = ()

    def random(self, factor: Factor) -> bool:
        """Return whether the factor scatters in the inner array."""
        return factor.scatter

    def draw(self, free: Factors, n: int, seed: int, settings: Settings) -> Drawn:
        """Return indices of the outer factors and quantiles of the inner ones.

        `point_samples` gives each design point its own number of the first rows of the inner
        sample.
        """
        outer = {name: f for name, f in free.items() if not f.scatter}
        inner = {name: f for name, f in free.items() if f.scatter}
        if not inner:
            allowed = "at least one factor that scatters (a distribution), with method inner_outer"
            remedy = "Give one factor a distribution such as {normal: [0.1, 0.02]}."
            raise InputError("factors", list(free), allowed, remedy)
        if settings["replicates"] > 1 and not METHODS[settings["inner"]].grows:
            raise InputError(
                "inner", settings["inner"], "a sample that grows, for independent replicates"
            )
        sample, of_sample = METHODS[settings["inner"]].draw(inner, n, seed, settings)
        index, meta = Grid().draw(outer, 0, 0, {})
        sizes = list(settings["point_samples"]) or [n] * len(index)
        sides = np.repeat(index, sizes, axis=0), np.concatenate([sample[:size] for size in sizes])
        unit = in_order(np.concatenate(sides, axis=1), [*outer, *inner], free)
        meta |= of_sample | {
            "outer": list(outer),
            "inner": list(inner),
            "inner_samples": n,
            "design_points": len(index),
        }
        if min(sizes) < n:
            meta |= {"point_samples": sizes}
        return unit, meta
