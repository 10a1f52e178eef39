"""Sobol' indices of few base samples: none below 32 blocks; from there on their intervals hold the truth."""

from __future__ import annotations

import numpy as np
import pytest

from trackroller.methods.saltelli import MIN_BLOCKS, draw, sobol

WEIGHTS = np.array([3.0, 2.0, 1.0, 0.5, 0.2])
TOTAL = WEIGHTS**2 / np.sum(WEIGHTS**2)  # of a sum of independent uniform numbers


def indices(blocks, seed):
    rows = draw(blocks, list(range(len(WEIGHTS))), True, seed)
    return sobol(rows @ WEIGHTS, len(WEIGHTS), True)


def test_fewer_blocks_give_no_index():
    """Of 16 blocks with ten columns some columns are the same but for their order."""
    found = indices(MIN_BLOCKS // 2, 3)
    assert np.isnan(found["ST"]).all() and np.isnan(found["ST_high"]).all()
    assert found["blocks_used"] == MIN_BLOCKS // 2


def test_intervals_of_the_fewest_blocks_hold_the_total_indices():
    hits, errors = [], []
    for seed in range(20):
        found = indices(MIN_BLOCKS, seed)
        hits.append((found["ST_low"] <= TOTAL + 1e-3) & (TOTAL - 1e-3 <= found["ST_high"]))
        errors.append(np.abs(found["ST"] - TOTAL).max())
    assert np.mean(hits) >= 0.89
    assert np.median(errors) == pytest.approx(0.04, abs=0.03)
