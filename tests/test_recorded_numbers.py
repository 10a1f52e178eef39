"""Today's numbers are the recorded ones: over all contact models, options, groups of outputs and kinds of studies."""

from __future__ import annotations

import functools
import warnings

import numpy as np
import pytest
from recorded_numbers import compute, groups, load, names, studies

from trackroller.parameters import CONTACT_MODELS, OPTIONS

# With other threads, processors or releases of NumPy and Numba, sums are formed in another order and differ by 1e-15 of
# their value. The iterations of the solver can amplify this to 1e-10. If a formula, a quadrature node or a random draw
# of the program changes, numbers change by far more than 1e-9.
TOLERANCE = 1e-9
# Between two processors, lives and estimated errors differed by up to 5e-9. Both amplify rounding errors: a life is a
# high power of the peak stress, and an estimated error is the difference of two nearly equal stresses.
MAGNIFIED = 1e-8
RESIDUAL = 1e-8  # a residual is what rounding leaves of a balance, which differs with the processor
SECTIONS = 2e-4  # sections pass through the peak, whose place depends on rounding in the search
SINGLE = 1e-5  # stresses on planes below a patch are sums in single precision
# Sentences may be rewritten without a change of any number.
SENTENCES = ("note", "treatment", "needs", "reason")


recorded = functools.cache(load)


def assert_same(name: str, now: dict[str, np.ndarray], before: dict[str, np.ndarray]) -> None:
    """Require that a group holds every recorded array with the recorded values; new arrays are allowed."""
    own = {key: values for key, values in before.items() if key.partition("/")[0] == name}
    assert own, f"{name} is not recorded: python tests/recorded_numbers.py {name}"
    for key, values in own.items():
        assert key in now, f"{key} is missing"
        if key.rpartition("/")[2] in SENTENCES:
            assert now[key].shape == values.shape, key
        elif values.dtype.kind in "U":
            np.testing.assert_array_equal(now[key], values, err_msg=key)
        else:
            scale = np.max(np.abs(values), where=np.isfinite(values), initial=0.0)
            tolerance = SINGLE if name.startswith("limits") else TOLERANCE
            if "life" in key or key.endswith("error_estimate"):
                tolerance = max(tolerance, MAGNIFIED)
            rounding = RESIDUAL if key.endswith("residual") else max(1e-12 * scale, 1e-15)
            if key.endswith(("_xz", "_yz")):
                rounding = SECTIONS * scale
            np.testing.assert_allclose(now[key], values, rtol=tolerance, atol=rounding, err_msg=key)


@pytest.mark.parametrize("name", names())
def test_numbers_are_the_recorded_ones(name):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        assert_same(name, compute(name), recorded())


def test_the_recorded_cases_cover_what_can_be_chosen():
    options = [options for _, options in groups().values()]
    for name, option in OPTIONS.items():
        if option.kind in ("word", "words") and name != "outputs":
            chosen = {word for given in options for word in np.atleast_1d(given.get(name, option.default))}
            assert chosen >= set(option.values), name
    assert {given["contact_model"] for given in options} == set(CONTACT_MODELS)
    assert {word for given in options for word in given["outputs"]} == set(OPTIONS["outputs"].values)
    assert {study["design"] for study in studies().values()} >= {"lhs", "sobol", "morris", "saltelli", "inner_outer"}


@pytest.mark.parametrize("change", ["value", "nan", "word", "missing"])
def test_a_difference_is_found(change):
    """A force that is altered by 1e-8, a lost number, another regime and a lost variable fail."""
    before = {
        "case/normal_force": np.array([200.0, 300.0]),
        "case/regime": np.array(["rolling", "full_slip"]),
    }
    now = {key: values.copy() for key, values in before.items()} | {"case/new": np.zeros(1)}
    assert_same("case", now, before)
    if change == "missing":
        del now["case/regime"]
    elif change == "word":
        now["case/regime"][0] = "failed"
    else:
        now["case/normal_force"][1] *= np.nan if change == "nan" else 1 + 1e-8
    with pytest.raises(AssertionError):
        assert_same("case", now, before)
