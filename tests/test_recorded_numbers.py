"""Today's numbers are the recorded ones: over all contact models, options, groups of outputs and kinds of studies."""

from __future__ import annotations

import functools
import warnings

import numpy as np
import pytest
from recorded_numbers import Computed, Numbers, compute, groups, load, names, studies

from trackroller.parameters import CONTACT_MODELS, OPTIONS
from trackroller.roller.differences import ROUNDING, apart

# Sentences may be rewritten without a change of any number.
SENTENCES = ("note", "treatment", "needs", "reason")


recorded = functools.cache(load)


def assert_same(name: str, now: Computed, before: dict[str, np.ndarray]) -> None:
    """Require that a group holds every recorded array with the recorded values; new arrays are allowed.

    A difference is allowed up to what rounding can cause on another processor; `roller/differences.py` gives the
    reasons for the scales and the tolerances.
    """
    own = {key: values for key, values in before.items() if key.partition("/")[0] == name}
    assert own, f"{name} is not recorded: python tests/recorded_numbers.py {name}"
    for key, values in own.items():
        assert key in now, f"{key} is missing"
        found, scale, allowed = now[key]
        assert found.shape == values.shape, key
        if key.rpartition("/")[2] in SENTENCES:
            continue
        if scale is None:
            np.testing.assert_array_equal(found, values, err_msg=key)
        else:
            difference = apart(values, found, scale)
            assert difference <= allowed, f"{key}: differs by {difference:.1e} of its scale, above {allowed:.0e}"


@pytest.mark.slow
@pytest.mark.parametrize("name", names())
def test_numbers_are_the_recorded_ones(name):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        assert_same(name, compute(name), recorded())


def test_the_recorded_cases_cover_what_can_be_chosen():
    options = [options for _, options in groups().values()]
    for name, option in OPTIONS.items():
        if option.kind in ("word", "words") and name not in ("outputs", "not_checked"):
            chosen = {word for given in options for word in np.atleast_1d(given.get(name, option.default))}
            assert chosen >= set(option.values), name
    assert {given["contact_model"] for given in options} == set(CONTACT_MODELS)
    assert {word for given in options for word in given["outputs"]} == set(OPTIONS["outputs"].values)
    assert {study["method"] for study in studies().values()} >= {"lhs", "sobol", "morris", "saltelli", "inner_outer"}


@pytest.mark.parametrize("change", ["value", "zero", "nan", "word", "missing"])
def test_a_difference_is_found(change):
    """A force that is off by 2e-6 of the load, a lost number, another regime and a lost variable fail."""
    load = np.array([300.0, 300.0, 300.0])
    before = {
        "case/lateral_force": np.array([200.0, 300.0, 1e-14]),
        "case/regime": np.array(["rolling", "full_slip"]),
    }
    now = {
        "case/lateral_force": Numbers(before["case/lateral_force"].copy(), load, ROUNDING),
        "case/regime": Numbers(before["case/regime"].copy()),
        "case/new": Numbers(np.zeros(1), np.ones(1), ROUNDING),
    }
    now["case/lateral_force"].values[:] += [1e-5, -1e-5, -4e-14]  # what rounding may do, also to zero by symmetry
    assert_same("case", now, before)
    if change == "missing":
        del now["case/regime"]
    elif change == "word":
        now["case/regime"].values[0] = "failed"
    elif change == "zero":
        now["case/lateral_force"].values[2] = 6e-4
    else:
        now["case/lateral_force"].values[1] *= np.nan if change == "nan" else 1 + 2e-6
    with pytest.raises(AssertionError):
        assert_same("case", now, before)
