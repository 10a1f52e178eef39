"""The error of a ratio of two candidates is the measured one where it was measured."""

from __future__ import annotations

import numpy as np
import pytest
from synthetic_results import PAIRS, grid_study, results_of

from trackroller.results.comparison import Comparison
from trackroller.roller.expected_errors import ratio_error


def compared(error: float, accuracy: str, stated: bool, friction: float = 0.2) -> Comparison:
    """Return a comparison of two pairs of materials whose lives state an error."""
    ds = grid_study({"material_pair": list(PAIRS[:2]), "friction_coefficient": [0.1, friction]})
    ds["life_error_estimate"] = error + 0.0 * ds.life_cycles
    ds.attrs |= {"accuracy": accuracy, "contact_model": "kalker"}
    if stated:
        ds.life_cycles.attrs["expected_relative_error"] = 0.01
    found = Comparison.of(results_of(ds))
    assert found is not None
    return found


def test_a_measured_error_of_ratios_takes_the_place_of_independent_errors():
    own = compared(0.2, "preview", True)
    assert own.error_of_ratio(0, 1) == ratio_error("preview", "kalker")
    assert own.error_of_ratio(0, 1) < np.hypot(0.2, 0.2)


@pytest.mark.parametrize(
    ("accuracy", "stated", "friction"), [("peak 0.02", True, 0.2), ("preview", False, 0.2), ("preview", True, 0.5)]
)
def test_errors_that_were_not_measured_count_as_independent(accuracy, stated, friction):
    assert compared(0.2, accuracy, stated, friction).error_of_ratio(0, 1) == pytest.approx(np.hypot(0.2, 0.2))


def test_a_life_that_fatigue_does_not_end_shares_no_error():
    found = compared(0.2, "preview", True)
    found.ranges.__dict__["error"] = np.where(found.candidate == 0, 0.2, 0.0)  # fatigue ends the first candidate only
    assert found.error_of_ratio(0, 1) == pytest.approx(0.2)


def test_errors_of_different_contact_models_count_as_independent():
    ds = grid_study({"material_pair": list(PAIRS[:2]), "friction_coefficient": [0.1, 0.2]})
    ds["life_error_estimate"] = 0.2 + 0.0 * ds.life_cycles
    ds.attrs["accuracy"] = "preview"
    ds.attrs.pop("contact_model", None)
    ds.life_cycles.attrs["expected_relative_error"] = 0.01
    found = Comparison.of(results_of(ds))
    assert found is not None and found.error_of_ratio(0, 1) == pytest.approx(np.hypot(0.2, 0.2))


def test_a_ratio_without_stated_errors_has_none():
    assert compared(0.0, "preview", True).error_of_ratio(0, 1) == 0.0
