"""Sobol indices from Saltelli designs, on plain arrays."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from trackroller.analysis.indices import Estimates, constant, percentile_bounds


def sobol(y: np.ndarray, count: int, second_order: bool, seed: int = 0, resamples: int = 300) -> Estimates:
    """Sobol indices of a Saltelli design with bootstrap intervals.

    Two rows that share the factors u and no other have the correlation V_u / V. So S1_j is the correlation of
    B with AB_j (and of A with BA_j), ST_j one less that of A with AB_j (and of B with BA_j), and
    S2_jk = corr(BA_j, AB_k) - S1_j - S1_k (Monod 2006; Janon et al. 2014, ESAIM P&S 18, 342-364). The
    correlation of A with B, whose true value is 0, serves as control variate for each of them: an inert factor
    then has no noise at all, and neither has one that does everything.

    Parameters
    ----------
    y : output, shape (blocks * (k + 2),) or, with second order, (blocks * (2 k + 2),); blocks in the order
        A, AB_1 .. AB_k, (BA_1 .. BA_k), B
    count : number of factors k
    second_order : whether the BA rows are there
    resamples : bootstrap resamples of whole blocks

    Returns
    -------
    S1, ST shape (k,), S2 shape (k, k) with NaN on and below the diagonal, each with _low and _high;
    blocks_used, blocks. A block with one unusable row is left out as a whole: rows of A, B and their mixtures
    belong together. This conditions the indices on the rows that could be used; see `given_data`.
    Intervals treat the blocks as random; those of a Sobol sequence do better, so they are on the safe side.

    Validity: independent factors.
    """
    step = 2 * count + 2 if second_order else count + 2
    block = y[: y.size // step * step].reshape(-1, step)
    used = block[np.isfinite(block).all(axis=1)]
    out: Estimates = {"blocks": np.array(len(block)), "blocks_used": np.array(len(used))}
    shape = {"S1": (count,), "ST": (count,), "S2": (count, count)}
    names = ("S1", "ST", "S2") if second_order else ("S1", "ST")
    if len(used) < 8 or constant(used):
        for name in names:
            out |= {name + end: np.full(shape[name], np.nan) for end in ("", "_low", "_high")}
        return out
    terms = _pair_terms((used - used.mean()) / used.std(), count, second_order)
    beta = _control(*terms)
    best = _sobol_from(np.full((1, len(used)), 1 / len(used)), terms, beta, count)
    drawn = [_sobol_from(weights, terms, beta, count) for weights in _resampled(len(used), resamples, seed)]
    for name in names:
        low, high = percentile_bounds(np.concatenate([part[name] for part in drawn]))
        out |= {name: best[name][0], f"{name}_low": low, f"{name}_high": high}
    return out


def _resampled(rows: int, resamples: int, seed: int) -> Iterator[np.ndarray]:
    """Weights of the rows in each resample, as many resamples at once as memory bears, shape (some, rows)."""
    rng = np.random.default_rng(seed)
    some = max(1, 4_000_000 // rows)
    for start in range(0, resamples, some):
        picks = rng.integers(0, rows, (min(some, resamples - start), rows))
        yield np.stack([np.bincount(pick, minlength=rows) for pick in picks]) / rows


def _pair_terms(block: np.ndarray, count: int, second_order: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """What the correlations are made of, one row a block: half sums, half sums of squares, products.

    Columns: A with B; B with AB_j; A with AB_j; with second order BA_j with AB_k for all j, k, and the first
    two kinds averaged with their mirror images.
    """
    a, b, ab = block[:, :1], block[:, -1:], block[:, 1 : count + 1]
    ba = block[:, count + 1 : 2 * count + 1]

    def terms(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        return np.stack([(u + v) / 2, (u**2 + v**2) / 2, u * v])

    parts = [terms(a, b), terms(b, ab), terms(a, ab)]
    if second_order:
        parts[1] = (parts[1] + terms(a, ba)) / 2
        parts[2] = (parts[2] + terms(b, ba)) / 2
        pairs = terms(ba[:, :, None], ab[:, None, :])
        pairs = (pairs + pairs.transpose(0, 1, 3, 2)) / 2
        parts.append(pairs.reshape(3, len(block), -1))
    half, square, product = np.concatenate(parts, axis=2)
    return half, square, product


def _control(half: np.ndarray, square: np.ndarray, product: np.ndarray) -> np.ndarray:
    """Weight of the control variate for each correlation: regression of its influence on that of A with B."""
    mean, spread = half.mean(axis=0), square.mean(axis=0) - half.mean(axis=0) ** 2
    rho = (product.mean(axis=0) - mean**2) / spread
    influence = (product - rho * square - 2 * (1 - rho) * mean * half) / spread
    influence -= influence.mean(axis=0)
    control = influence[:, :1]
    return (influence * control).sum(axis=0) / max(float((control**2).sum()), 1e-300)


def _sobol_from(weights: np.ndarray, terms: tuple[np.ndarray, ...], beta: np.ndarray, count: int) -> Estimates:
    """Indices for each row of weights over the blocks, shape (resamples, ...)."""
    half, square, product = (weights @ part for part in terms)
    spread = square - half**2
    spread = np.where(spread > 1e-12, spread, np.nan)  # a resample may hold a rare event nowhere
    rho = (product - half**2) / spread
    rho = rho - beta * rho[:, :1]
    first, rest = rho[:, 1 : count + 1], rho[:, count + 1 : 2 * count + 1]
    out = {"S1": first, "ST": 1 - rest}
    if rho.shape[1] > 2 * count + 1:
        pairs = rho[:, 2 * count + 1 :].reshape(-1, count, count) - first[:, :, None] - first[:, None, :]
        out["S2"] = np.where(np.triu(np.ones((count, count), dtype=bool), 1), pairs, np.nan)
    return out
