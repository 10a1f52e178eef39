"""Latin hypercubes that grow: a larger sample keeps the rows of the smaller one, so that only new cases are solved.

More samples of `sobol`, `saltelli` and `morris` designs append rows to the earlier ones. A Latin hypercube would be
drawn anew for each size. The grown one here keeps its rows and fills empty strata of the larger size. If the size
doubles, the result is a full Latin hypercube again. Between, some strata stay empty.
"""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.errors import InputError
from trackroller.study.design.correlation import correlate

if TYPE_CHECKING:
    from trackroller.study.file.study import Study
    from trackroller.study.store.folder import StudyFolder


def grown_lhs(count: int, sizes: Sequence[int], seed: int, root: np.ndarray | None = None) -> np.ndarray:
    """Draw a Latin hypercube of sizes[0] rows and grow it to each further size.

    Parameters
    ----------
    count : number of factors
    sizes : rising numbers of rows
    seed : of the draw
    root : correlates the rows of each step, see `trackroller.study.design.correlation.copula`

    Returns
    -------
    Quantiles in the unit cube, shape (sizes[-1], count). The first sizes[i] rows are the sample of that size.
    """
    from scipy.stats import qmc  # heavy, and a plan of a grid does not need it

    unit: np.ndarray = qmc.LatinHypercube(d=count, rng=np.random.default_rng(seed)).random(sizes[0])
    unit = correlate(unit, root, strata=True)
    for size in sizes[1:]:
        new = _fill(unit, size, np.random.default_rng([seed, size]))
        unit = np.concatenate([unit, correlate(new, root, strata=True)])
    return unit


def _fill(unit: np.ndarray, size: int, rng: np.random.Generator) -> np.ndarray:
    """Return the rows that bring a sample to `size`, in strata of 1/size that are still empty in each factor."""
    new = size - len(unit)
    columns = []
    for values in unit.T:
        empty = np.setdiff1d(np.arange(size), np.minimum((values * size).astype(int), size - 1))
        columns.append((rng.permutation(empty)[:new] + rng.random(new)) / size)
    return np.stack(columns, axis=1) if columns else np.empty((new, 0))


def check_sizes(earlier: Any, samples: int) -> tuple[int, ...]:
    """Check the earlier sizes of a sample.

    Parameters
    ----------
    earlier : one number, a list of numbers, or nothing
    samples : size of the sample now

    Returns
    -------
    The earlier sizes.

    Raises
    ------
    InputError : the sizes are not rising whole numbers below `samples`
    """
    sizes = [earlier] if isinstance(earlier, int) else list(earlier or ())
    whole = all(isinstance(s, int) and not isinstance(s, bool) and s > 0 for s in sizes)
    if not whole or any(a >= b for a, b in itertools.pairwise([*sizes, samples])):
        remedy = "Remove the key: the sizes of earlier runs are found in the results folder."
        raise InputError("grown_from", sizes, f"rising whole numbers below samples ({samples})", remedy)
    return tuple(sizes)


SAME = ("factors", "rank_correlations", "design", "seed", "inner")  # keys that a grown sample must share


def is_lhs(config: Any) -> bool:
    """Return whether the design of a study file draws a Latin hypercube."""
    return bool(config.design == "lhs" or (config.design == "inner_outer" and config.inner in (None, "lhs")))


def earlier_config(study: Study, folder: StudyFolder) -> Any:
    """Return what the study file of a folder said, None unless the sample of the study can have grown from its own."""
    try:
        old = type(study.config).model_validate(folder.earlier())
    except ValueError:
        return None
    until = (old.until is None) == (study.config.until is None)
    return old if until and all(getattr(old, key) == getattr(study.config, key) for key in SAME) else None


def with_history(study: Study, folder: StudyFolder) -> Study:
    """Add the earlier sizes of the sample to a study.

    Parameters
    ----------
    study : the study
    folder : its results; the study file kept there has the earlier sizes

    Returns
    -------
    The study with `grown_from`, if it is a Latin hypercube whose factors, rank correlations, seed and design are
    unchanged. Otherwise the study as it is.
    """
    config = study.config
    if not is_lhs(config) or config.grown_from or config.until is not None:
        return study
    old = earlier_config(study, folder)
    sizes = () if old is None else (*(old.grown_from or ()), old.samples)
    earlier = tuple(size for size in sizes if size < config.samples)
    return dataclasses.replace(study, config=config.model_copy(update={"grown_from": earlier})) if earlier else study
