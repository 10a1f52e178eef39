"""Values of notebooks become plain numbers, texts, lists and mappings; computed levels what a person writes."""

from collections import deque
from decimal import Decimal
from fractions import Fraction
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from trackroller.errors import InputError
from trackroller.numerics.numbers import written
from trackroller.numerics.plain import mapping_of, plain


def with_unit(values):
    values.attrs["units"] = "kN"
    return values


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (np.int64(3), 3),
        (np.float32(0.1), 0.1),
        (np.bool_(True), True),
        (np.str_("a"), "a"),
        (np.array(2.5), 2.5),
        (np.arange(3), [0, 1, 2]),
        (np.array([0.1, 0.2], np.float32), [0.1, 0.2]),
        (np.array([[1, 2]]), [[1, 2]]),
        (np.array([{"a": np.int8(1)}], object), [{"a": 1}]),
        (np.ma.array([1, 2]), [1, 2]),
        (pd.Series([1, 2]), [1, 2]),
        (pd.Index(["a", "b"]), ["a", "b"]),
        (pd.Categorical(["a", "b"]), ["a", "b"]),
        (pd.DataFrame({"a": [1, 2], "b": "c"}), [{"a": 1, "b": "c"}, {"a": 2, "b": "c"}]),
        (xr.DataArray([1.0, 2.0]), [1.0, 2.0]),
        (xr.DataArray([0.2], attrs={"units": "kN"}), ["0.2 kN"]),
        (xr.DataArray([0.2], attrs={"Unit": "kN"}), ["0.2 kN"]),
        (xr.DataArray([0.2], attrs={"units": "1"}), [0.2]),
        (with_unit(pd.Series([0.2])), ["0.2 kN"]),
        (xr.Dataset({"a": 1}, coords={"b": 2}), {"a": 1, "b": 2}),
        (Decimal("0.15"), 0.15),
        (Decimal(8), 8),
        (Fraction(1, 4), 0.25),
        (range(3), [0, 1, 2]),
        (deque([1]), [1]),
        ({"a": 1}.values(), [1]),
        (("a", ("b", np.int64(1))), ["a", ["b", 1]]),
        (Path("a") / "b.csv", str(Path("a") / "b.csv")),
    ],
    ids=lambda value: type(value).__name__,
)
def test_values_of_libraries(value, expected):
    made = plain(value)
    assert made == expected
    assert repr(made) == repr(expected)  # the same types, too


@pytest.mark.parametrize("value", [b"3", {1, 2}, np.longdouble(3), 1j, object()], ids=lambda v: type(v).__name__)
def test_other_values_stay_for_the_field_to_refuse(value):
    assert plain(value) is value


@pytest.mark.parametrize("value", [np.ma.masked, np.ma.array([1.0, 2.0], mask=[False, True])], ids=["one", "some"])
def test_masked_values_are_refused_with_the_call_to_write(value):
    with pytest.raises(InputError, match=r"loads = .* Allowed: values that are not masked.*values\.compressed\(\)"):
        plain({"loads": value}, "")


def test_what_can_be_read_once_or_is_ambiguous_is_refused():
    endless = []
    endless.append(endless)
    doubled = pd.DataFrame([[1, 2]], columns=["a", "a"])
    for value, words in ((iter([1]), "Write list"), (endless, "in each other"), (doubled, "it stands twice")):
        with pytest.raises(InputError, match=words):
            plain(value)


def test_a_row_of_a_frame_is_a_mapping_and_a_column_is_not():
    frame = pd.DataFrame({"axial_force": [0, 70], "name": ["a", "b"]})
    assert mapping_of(frame.iloc[1]) == {"axial_force": 70, "name": "b"}
    assert mapping_of(frame["axial_force"]) is not None and not isinstance(mapping_of(frame["axial_force"]), dict)


@pytest.mark.parametrize("seed", range(40))
def test_computed_levels_are_those_that_a_person_writes(seed):
    pick = np.random.default_rng(seed)
    digits, first, step, n = pick.integers(0, 7), pick.integers(-999, 999), pick.integers(1, 999), pick.integers(3, 80)
    listed = [float(f"{first + i * step}e-{digits}") for i in range(n)]
    width = float(f"{step}e-{digits}")
    made = np.linspace(listed[0], listed[-1], n), np.arange(listed[0], listed[-1] + 0.5 * width, width), listed
    for values in made:
        assert written([float(value) for value in values]) == listed


@pytest.mark.parametrize("seed", range(40))
def test_other_levels_keep_their_digits(seed):
    pick = np.random.default_rng(seed)
    values = (pick.normal(size=7) * 10.0 ** pick.uniform(-300, 300, 7)).tolist()
    assert np.allclose(written(values), values, rtol=1e-14, atol=0)
    own = [round(value, int(pick.integers(0, 10))) for value in pick.uniform(-100, 100, 7)]
    assert written(own) == own
    assert written([1 / 3, 2 / 3, 5.0, np.inf]) == [1 / 3, 2 / 3, 5.0, np.inf]
    assert written(np.geomspace(1e-6, 1e-2, 5).tolist()) == [1e-6, 1e-5, 1e-4, 1e-3, 1e-2]
