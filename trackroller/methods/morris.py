"""Morris trajectories: each step changes one factor, and its elementary effect is the change of the
output.
"""

from __future__ import annotations

import numpy as np

from trackroller.errors import InputError
from trackroller.methods import convergence
from trackroller.methods.factor import TAIL
from trackroller.methods.intervals import constant, percentile_bounds
from trackroller.methods.method import (
    Design,
    Drawn,
    Estimated,
    Estimates,
    Factors,
    Index,
    Key,
    Method,
    Settings,
)
from trackroller.methods.replicates import jackknife, left_out


class Morris(Method):
    """`samples` trajectories, drawn by SALib."""

    name = "morris"
    takes = {"replicates": 1, "levels": Key(int, 4, "number of levels")}
    sampled = grows = effects = quick = True
    tail = TAIL
    first_look = 2
    indices = {
        "mu_star": Index("mean absolute effect", sized=True, of_factor=True),
        "sigma": Index("spread of effects σ", sized=True, of_factor=True),
        "mu": Index("mean elementary effect", sized=True, signed=True),
        "effects_used": Index("elementary effects used"),
    }
    headline = "mu_star"
    narrowed = ("mu_star",)
    judged = ("mu_star",)
    half_width = 0.15  # of mu*, relative to the largest mu*
    needs = "pairs of neighbouring rows of a trajectory"
    unit = "elementary effects"
    samples_unit = "trajectories"
    uncorrelated = (
        "Elementary effects change one factor at a time. Take method: lhs: first and "
        "delta allow correlation."
    )
    reference = (
        "Design and indices: elementary effects",
        "Morris (1991): Factorial sampling plans for preliminary computational experiments. "
        "Technometrics 33, 161–174",
    )

    def draw(self, free: Factors, n: int, seed: int, settings: Settings) -> Drawn:
        """Draw SALib's trajectories; a list moves between a random pair of its different values
        instead.

        If the values of a list were bins over SALib's four levels, a fifth value would never occur.
        A step between two values would also be divided by the step 2/3 of the unit range, so that
        mu* of a list would be 1.5 times too large beside that of continuous factors.
        """
        from SALib.sample import morris  # heavy, and other designs do not need it

        levels = settings["levels"]
        if not isinstance(levels, int) or levels < 4 or levels % 2:
            raise InputError("design option levels", levels, "an even whole number >= 4")
        count = len(free)
        # a seed for each trajectory, so that more of them leave the first ones as they were
        problem = {"num_vars": count, "names": list(free), "bounds": [[0.0, 1.0]] * count}
        seeds = [int(np.random.SeedSequence([seed, i]).generate_state(1)[0]) for i in range(n)]
        unit = np.concatenate([morris.sample(problem, 1, num_levels=levels, seed=s) for s in seeds])
        # trajectories are independent, so they take turns as they are
        meta = {"trajectories": n, "levels": levels}
        path = unit.reshape(n, count + 1, count)
        drawers = [np.random.default_rng([s, 1]) for s in seeds]
        for j, factor in enumerate(free.values()):
            if factor.discrete:
                pair = np.array(
                    [rng.choice(len(factor.levels), 2, replace=False) for rng in drawers]
                )
                moved = path[:, :, j] != path[:, :1, j]
                path[:, :, j] = np.where(moved, pair[:, 1:], pair[:, :1])
        return path.reshape(-1, count), meta

    def estimate(self, y: np.ndarray, design: Design) -> Estimated:
        """Return mean effects, mean absolute effects and their spread, with the course of mu*."""
        step = len(design.factors) + 1

        def part(paths: int) -> Estimates:
            rows = slice(0, paths * step)
            return morris(y[rows], design.unit[rows], design.listed)

        total = int(design.meta["trajectories"])
        at = convergence.sizes(total, smallest=4)
        out = part(total)
        out |= convergence.course(part, at, out, ("mu_star",))
        return Estimated(out, int(out["effects_used"].sum()), total * (step - 1), at)

    def from_replicates(
        self, y: np.ndarray, unit: np.ndarray, design: Design, member: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return mu* of each factor."""
        if constant(y):
            unknown = np.full(unit.shape[1], np.nan)
            return unknown, unknown
        effect = np.abs(elementary_effects(y, unit, design.listed))
        filled = np.nan_to_num(effect)
        good = np.isfinite(effect).astype(float)
        keep = left_out(member, int(design.meta["replicates"]))
        with np.errstate(invalid="ignore", divide="ignore"):
            return filled.sum(axis=0) / good.sum(axis=0), jackknife((keep @ filled) / (keep @ good))


def morris(
    y: np.ndarray, unit: np.ndarray, listed: np.ndarray, seed: int = 0, resamples: int = 300
) -> Estimates:
    """Estimate the elementary effects of Morris trajectories.

    Parameters
    ----------
    y : output, shape (trajectories * (k + 1),)
    unit : quantiles or list indices, shape (trajectories * (k + 1), k)
    listed : which factors are lists, shape (k,)
    seed : of the bootstrap
    resamples : bootstrap resamples of trajectories

    Returns
    -------
    mu, mu_star (with _low and _high), sigma, effects_used, each shape (k,).

    Notes
    -----
    An effect is the change of the output divided by the step in units of the factor's range
    (quantiles 0 to 1). For a list it is the whole change between two of its values. An unusable row
    costs the two effects that need it. SALib's `morris` gives the same numbers on complete data. It
    returns no index at all if one value is NaN; without incomplete trajectories, 5 % unusable rows
    would cost 43 % instead of 10 % of the effects of ten factors.

    An interval of the resamples alone is too narrow: of twelve effects it holds the mean in 9 of 10
    studies. Here it is wider by Student's t, by 17 % with twelve effects.

    References
    ----------
    Morris (1991), Technometrics 33, 161-174; Campolongo et al. (2007), Environ. Model. Softw. 22,
    1509-1518.
    """
    # heavy, and a process that only plans needs no interval
    from scipy.special import ndtri, stdtrit

    count = unit.shape[1]
    effect = elementary_effects(y, unit, listed)
    good = np.isfinite(effect)
    used = good.sum(axis=0)
    out: Estimates = {"effects_used": used}
    if constant(y):
        return out | {
            n: np.full(count, np.nan)
            for n in ("mu", "mu_star", "mu_star_low", "mu_star_high", "sigma")
        }
    picks = np.random.default_rng(seed).integers(0, len(effect), (resamples, len(effect)))
    with np.errstate(invalid="ignore", divide="ignore"):
        filled = np.nan_to_num(np.abs(effect))
        resampled = filled[picks].sum(axis=1) / good[picks].sum(axis=1)
        out["mu"] = np.nan_to_num(effect).sum(axis=0) / used
        out["mu_star"] = filled.sum(axis=0) / used
        spread = np.where(good, (effect - out["mu"]) ** 2, 0.0).sum(axis=0) / (used - 1)
    out["sigma"] = np.sqrt(np.where(used > 1, spread, np.nan))
    low, high = percentile_bounds(resampled)
    # resamples of a dozen effects spread less than their mean does: as a normal quantile to that of
    # Student's t; of two or three effects t is so wide that nothing would follow for the samples
    # that are needed
    least = np.maximum(used, 4)
    wider = stdtrit(least - 1.0, 0.975) / ndtri(0.975) * np.sqrt(least / (least - 1.0))
    mean = out["mu_star"]
    return out | {
        "mu_star_low": np.maximum(0.0, mean - wider * (mean - low)),
        "mu_star_high": mean + wider * (high - mean),
    }


def elementary_effects(y: np.ndarray, unit: np.ndarray, listed: np.ndarray) -> np.ndarray:
    """Return the elementary effects of Morris trajectories, shape (trajectories, k); NaN where a
    row is unusable.

    Parameters
    ----------
    y, unit, listed : as in `morris`
    """
    count = unit.shape[1]
    step = np.diff(unit.reshape(-1, count + 1, count), axis=1)
    moved = np.argmax(np.abs(step), axis=2)
    size = np.take_along_axis(step, moved[:, :, None], axis=2)[:, :, 0]
    size = np.where(listed[moved], np.sign(size), size)
    effect = np.full((len(step), count), np.nan)
    np.put_along_axis(effect, moved, np.diff(y.reshape(-1, count + 1), axis=1) / size, axis=1)
    return effect
