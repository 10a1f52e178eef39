"""The simulated campaigns of the evidence, on a few of them."""

from __future__ import annotations

import pytest

from validation.fits.campaigns import campaigns


@pytest.mark.slow
def test_chosen_tests_narrow_b10_more_than_random_ones():
    found = campaigns(3)
    assert found["factor_chosen"] < found["factor_random"]
    assert found["narrower"] > 0.5
