"""Draw independent replicates of a sample, which take turns in its rows."""

from __future__ import annotations

import warnings
from collections.abc import Callable

import numpy as np


def sobol_rows(count: int, n: int, seed: int) -> np.ndarray:
    """Return the first n rows of a scrambled Sobol sequence of `count` factors, quantiles of shape (n, count)."""
    from scipy.stats import qmc  # heavy, and a plan of a grid does not need it

    engine = qmc.Sobol(d=count, rng=np.random.default_rng(seed))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # the balance of a Sobol sequence needs a power of two
        return np.asarray(engine.random(n))


def in_turn(draw: Callable[[int], np.ndarray], seed: int, copies: int) -> np.ndarray:
    """Draw independent samples that take turns: row i belongs to sample i % copies.

    The first rows are therefore the first rows of each sample, and a larger result begins with a smaller one.

    Parameters
    ----------
    draw : seed -> one sample, shape (n, ...)
    seed : the seeds of the samples follow from it; a single sample takes it as it is
    copies : number of samples

    Returns
    -------
    Shape (copies * n, ...).
    """
    if copies == 1:
        return draw(seed)
    seeds = [int(own.generate_state(1)[0]) for own in np.random.SeedSequence(seed).spawn(copies)]
    drawn = np.stack([draw(own) for own in seeds], axis=1)
    return drawn.reshape(-1, *drawn.shape[2:])
