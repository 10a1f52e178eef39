"""Samples whose rows are draws of their own, with measures from given data."""

from __future__ import annotations

import numpy as np

from trackroller.methods import correlation
from trackroller.methods.method import Design, Estimated, Estimates, Index, Method

GIVEN_DATA = {
    "first": Index("first-order index from given data", of_factor=True),
    "fit_alone": Index("first-order index by a fitted polynomial", of_factor=True),
    "delta": Index("delta", of_factor=True),
    "prcc": Index("partial rank correlation", signed=True, of_factor=True),
    "delta_noise": Index("delta index below which an inert factor stays"),
    "fit_share": Index("share of variance predicted by the fitted polynomial"),
    "interaction_share": Index("share of variance of interaction"),
}


class Sample(Method):
    """Rows that may be left out one by one, so that their indices come from given data."""

    subset = weighted = True
    indices = GIVEN_DATA
    needs = "independent factors (correlated factors share their influence); any usable rows"

    def estimate(self, y: np.ndarray, design: Design) -> Estimated:
        """Return first-order shares, delta, partial rank correlations and interactions."""
        from trackroller.methods.given_data import measures  # heavy: SALib and scipy.stats

        return measures(y, design, bool(correlation.correlated_pairs(design)))

    def level_indices(
        self, y: np.ndarray, design: Design, place: int, inside: np.ndarray
    ) -> Estimates:
        """Return the first-order shares of the rows of a level."""
        from trackroller.methods.given_data import firsts_within  # heavy, as above

        return firsts_within(y, design, place, inside)


class RandomSample(Sample):
    """A sample of `samples` rows, drawn from the distributions of its factors, which may be
    correlated.
    """

    takes = {"rank_correlations": ()}
    sampled = weighs = True

    def from_replicates(
        self, y: np.ndarray, unit: np.ndarray, design: Design, member: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the first-order share of each factor."""
        from trackroller.methods.given_data import first_indices  # heavy: scipy.stats

        return first_indices(y, unit, design.ordered, member, int(design.meta["replicates"]))
