"""Odd Python objects and numbers far outside of what is built are refused by name; no warning, no other exception."""

from __future__ import annotations

import contextlib
import decimal
import warnings

import numpy as np
import pandas as pd
import pytest
import xarray as xr

import trackroller as tr
from trackroller.halfspace.peak import Peak
from trackroller.materials.edit import add_material
from trackroller.roller.stages.ellipse_stresses import EllipseStresses

ODD = [
    pd.NA,
    pd.NaT,
    10**400,
    np.ma.masked,
    np.array([1, 2]),
    object(),
    1j,
    np.bool_(True),
    b"3",
    decimal.Decimal("sNaN"),
    np.longdouble("1e4000"),
    np.datetime64("2020"),
    pd.Series([1.0, 2.0]),
]


def kind(value):
    return type(value).__name__


@pytest.fixture(autouse=True)
def warnings_fail():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        yield


@pytest.mark.parametrize("value", ODD, ids=kind)
@pytest.mark.parametrize("name", ["axial_force", "friction_coefficient", "friction_law", "guide_profile", "velocity"])
def test_odd_values_of_a_case(name, value):
    with pytest.raises(tr.InputError, match=name):
        tr.solve({name: value}, "forces", contact_model="sliding")


@pytest.mark.parametrize("value", ODD, ids=kind)
def test_odd_cases_and_databases(value):
    for call in (lambda: tr.solve(value), lambda: tr.solve([value]), lambda: tr.solve(tr.Case(), database=value)):
        with pytest.raises(tr.InputError):
            call()


@pytest.mark.parametrize("value", ODD, ids=kind)
def test_odd_studies(value):
    for call in (tr.load_study, tr.open_study):
        with pytest.raises(tr.InputError, match="study = "):
            call(value)


@pytest.mark.parametrize("value", ODD, ids=kind)
@pytest.mark.parametrize("key", ["name", "base", "factors", "design", "samples", "outputs", "analysis"])
def test_odd_values_of_a_study(key, value):
    study = {"name": "a", "factors": {"friction_coefficient": {"values": [0.1, 0.2]}}, "contact_model": "sliding"}
    with pytest.raises(tr.InputError, match=key):
        tr.load_study({**study, key: value})


def test_a_data_set_of_numbers_that_no_double_holds():
    for column in (np.array([10**400, 1], object), np.array([True, False]), np.array([1j, 0])):
        with pytest.raises(tr.InputError, match="axial_force"):
            tr.solve(xr.Dataset({"axial_force": ("case", column)}), "forces", contact_model="sliding")


@pytest.mark.parametrize("value", [pd.NA, object(), 1j, b"3"], ids=kind)
def test_odd_values_of_a_material(tmp_path, value):
    with pytest.raises(tr.InputError, match="youngs_modulus"):
        add_material(tmp_path / "materials.yaml", "new", like="PA6", youngs_modulus=value)


def test_numpy_values_of_a_material(tmp_path):
    values = {"youngs_modulus": np.float32(2500), "poisson_ratio": {"value": np.float64(0.25), "unit": "-"}}
    material = add_material(tmp_path / "materials.yaml", "new", like="PA6", note=np.str_("measured"), **values)
    assert (material.youngs_modulus, material.poisson_ratio) == (2500.0, 0.25)


@pytest.mark.parametrize("value", [pd.NA, 10**400, "a", 1j, [[1], [1, 2]], object()], ids=kind)
@pytest.mark.parametrize("place", range(7))
def test_odd_arrays_of_tractions(place, value):
    for function, last in ((tr.stress_from_tractions, [0, 0, 0]), (tr.stress_on_grid, [0.0])):
        given = [[-1, 0, 1], [-1, 0, 1], 200.0, 0.0, 0.0, last, 0.3]
        given[place] = value
        with pytest.raises(tr.InputError):
            function(*given)


@pytest.mark.parametrize("function", [tr.von_mises, tr.principal_stresses, tr.max_shear])
def test_odd_stresses(function):
    for value in (3.0, [1, 2, 3], np.zeros((6, 2)), ["a"] * 6, pd.NA, [[1] * 6, [2] * 5]):
        with pytest.raises(tr.InputError, match="stress"):
            function(value)
    both = function([[np.nan] * 6, [100.0, 0, 0, 0, 0, 0]])
    assert np.all(np.isnan(both[0])) and np.all(np.isfinite(both[1]))


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("axial_force", 1e308),
        ("radial_force", -1e100),
        ("motor_force", -1e13),
        ("axis_distance", 1e9),
        ("guide_profile_radius", 1e-300),
        ("roller_profile_radius", -1e-300),
        ("guide_curve_radius", 5e-324),
        ("contact_angle", 5e-324),
        ("velocity", 1e300),
    ],
)
def test_numbers_far_outside_of_what_is_built_are_refused_at_once(name, value):
    with pytest.raises(tr.InputError, match=name):
        tr.Case(**{name: value})


def test_moduli_that_no_solid_has_are_refused():
    soft = {"like": "PA6", "name": "soft", "youngs_modulus": 1e-300}
    with pytest.raises(tr.InputError, match="youngs_modulus"):
        tr.solve(tr.Case(roller_material=soft))


@pytest.mark.parametrize("model", ["sliding", "kalker"])
def test_numbers_at_the_bounds_have_finite_results_or_say_why_not(model):
    """All pairs of bounds of two parameters: a rolling, converged row has numbers, any other row a regime."""
    ends = {
        "axial_force": (-1e12, 1e-300, 1e12),
        "radial_force": (-1e12, -1e-300),
        "motor_force": (-1e12, -1e-300, 1e12),
        "axis_distance": (1e8,),
        "contact_angle": (1e-6, 89.9999999),
        "velocity": (1e-9, 1e9),
    }
    cases = []
    for first, values in ends.items():
        for second, others in ends.items():
            for pair in ({first: a, second: b} for a in values for b in others if first < second):
                with contextlib.suppress(tr.InputError):  # some pairs have no patch
                    cases.append(tr.Case(**pair))
    ds = tr.solve(cases, ("forces", "contact", "friction_work", "peak_stress"), contact_model=model, accuracy="preview")
    good = (ds.regime.values == 0) & (ds.converged.values == 1)
    assert good.sum() > 5
    for name in ("normal_force", "driving_force", "semi_axis_lateral", "max_pressure", "peak_stress"):
        assert np.all(np.isfinite(ds[name].values[good])), name


def test_a_rolling_row_without_a_number_is_not_converged(monkeypatch):
    """A contact model whose peaks overflow, as in materials that no bound foresees."""
    monkeypatch.setattr(EllipseStresses, "peaks", lambda self, asked: Peak(*np.full((6, asked.sum(), 2), np.nan)))
    ds = tr.solve([tr.Case(), tr.Case(motor_force=-80)], ("forces", "peak_stress"), contact_model="sliding")
    assert ds.regime.values.tolist() == [0, 1] and ds.converged.values.tolist() == [0, 1]
    assert "misses" in str(ds.reason.values[0])
