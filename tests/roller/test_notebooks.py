"""What people of notebooks give to `solve`, `Case`, `load_study` and spectra: taken, or refused with what to write."""

from __future__ import annotations

from decimal import Decimal
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr

import trackroller as tr
from trackroller.study.spectrum.file import Spectrum

AXIAL = ("case", [0.0, 70.0])


def forces(cases, **options):
    return tr.solve(cases, "forces", **{"contact_model": "sliding"} | options).normal_force.values


@pytest.fixture(scope="module")
def expected():
    return forces([{"axial_force": 0.0}, {"axial_force": 70.0}])


@pytest.mark.parametrize(
    "cases",
    [
        xr.Dataset({"axial_force": AXIAL}),
        xr.Dataset(coords={"axial_force": AXIAL}),
        xr.Dataset({"axial_force": ("case", [0.0, 0.07], {"units": "kN"})}),
        xr.Dataset({"axial_force": ("case", [0.0, 0.07], {"Unit": "kN"})}),
        xr.Dataset({"axial_force": ("case", np.array([0, 0.07], dtype=object), {"units": "kN"})}),
        xr.Dataset(coords={"axial_force": [0.0, 70.0]}).stack(case=["axial_force"]),
        pd.DataFrame({"axial_force": [0, 70]}).to_xarray().rename(index="case"),
        pd.DataFrame({"axial_force": [0, 70]}),
        pd.DataFrame({"axial_force": ["0 N", "0.07 kN"]}),
        pd.Series([{"axial_force": 0}, {"axial_force": np.int64(70)}]),
        np.array([{"axial_force": 0}, {"axial_force": Decimal(70)}], dtype=object),
    ],
    ids=range(11),
)
def test_cases_of_any_form(cases, expected):
    assert np.array_equal(forces(cases), expected)


def test_scalar_coordinates_and_aliases_of_a_data_set_are_used(expected):
    ds = xr.Dataset({"motor_force": ("case", [-30.0, -30.0])}, coords={"axial_force": 70.0})
    ds = ds.assign_coords(mu=0.1)
    slippery = forces({"axial_force": 70, "motor_force": -30, "friction_coefficient": 0.1})
    assert np.array_equal(forces(ds), [slippery, slippery])
    assert not np.allclose(slippery, expected[1])


def test_a_row_of_a_frame_is_one_case(expected):
    assert np.array_equal(forces(pd.DataFrame({"axial_force": [0, 70]}).iloc[1]), expected[1])


@pytest.mark.parametrize(
    ("ds", "words"),
    [
        (xr.Dataset(coords={"axial_force": [0.0, 70.0]}), r"axial_force = .*stack\(case=\['axial_force'\]\)"),
        (xr.Dataset({"axial_force": ("index", [0.0])}), r"rename\(index='case'\)"),
        (xr.Dataset({"axial_force": (("case", "contact"), np.zeros((2, 2)))}), "isel"),
        (xr.Dataset({"motor_force": AXIAL}, attrs={"axial_force": 70.0}), "axial_force = 'an attribute'"),
        (xr.Dataset({"motor_force": AXIAL}, attrs={"mu": 0.1}), "mu = 'an attribute'"),
        (xr.Dataset({"motor_force": AXIAL}, attrs={"accuracy": "preview"}), "accuracy = 'an attribute'"),
        (xr.Dataset({"mu": AXIAL}, coords={"friction_coefficient": AXIAL}), "Remove one of the two"),
        (xr.Dataset(coords={"frction_coefficient": AXIAL}), "Did you mean 'friction_coefficient'"),
        (xr.Dataset({"axial_force": AXIAL}, coords={"run": ("case", [1, 2])}), r"drop_vars\('run'\)"),
        (xr.Dataset({"axial_force": AXIAL, "contact_model": "sliding"}), r"set_coords\('contact_model'\)"),
        (xr.Dataset(coords={"material_pair": ("case", ["PA6 / PA6"])}), "roller_material and guide_material"),
        (xr.Dataset({"outer_radius": 30.0, "groove_depth": 2.0}), "axis_distance"),
        (xr.Dataset({"axial_force": ("case", [1.0], {"units": "mm"})}), "axial_force = 'mm'"),
    ],
    ids=range(13),
)
def test_what_a_data_set_says_is_used_or_refused_by_name(ds, words):
    with pytest.raises(tr.InputError, match=words):
        tr.solve(ds, "forces")


@pytest.mark.parametrize(
    ("cases", "words"),
    [
        ({"axial_force": np.array([0, 10])}, r"\[tr.Case\(axial_force=value\) for value in values\]"),
        (xr.DataArray([0.0, 1.0], dims="case", name="axial_force"), "to_dataset"),
        (np.zeros((2, 2)), "a list of mappings"),
        ({1, 2}, "sorted"),
        (pd.DataFrame({"axial_force": [0, None]}), r"axial_force \(case 1\) = nan"),
        (pd.DataFrame([[1, 2]], columns=["axial_force"] * 2), "it stands twice"),
    ],
    ids=range(6),
)
def test_refused_cases_say_what_to_write(cases, words):
    with pytest.raises(tr.InputError, match=words):
        tr.solve(cases, "forces")


def test_a_case_takes_the_names_that_a_file_takes():
    assert tr.Case(mu=0.2) == tr.Case(friction_coefficient=0.2)
    radii = {"outer_radius": 25, "groove_depth": 1.5}
    assert tr.Case(**radii) == tr.Case.from_dict(radii)
    for values, words in (({"mu": 0.2, "friction_coefficient": 0.2}, "Remove one"), ({"frction": 1}, "frction")):
        with pytest.raises(tr.InputError, match=words):
            tr.Case(**values)
    with pytest.raises(tr.InputError, match=r"Case\(\*\*values\)"):
        tr.Case({"mu": 0.2})


def test_numbers_of_libraries_leave_no_trace_in_a_case():
    law = {"kind": "table", "speed": pd.Series([0, 50]), "friction": np.array([0.3, 0.1])}
    own = {"like": "PA6", "name": "own", "youngs_modulus": np.float32(2500)}
    given = tr.Case(axial_force=np.int64(70), friction_law=law, roller_material=own, velocity=Decimal(12))
    plain_law = {"kind": "table", "speed": [0, 50], "friction": [0.3, 0.1]}
    plain_own = {"like": "PA6", "name": "own", "youngs_modulus": 2500.0}
    assert given == tr.Case(axial_force=70, friction_law=plain_law, roller_material=plain_own, velocity=12)
    assert tr.solve(given, "forces").attrs["case"] == tr.solve(tr.Case(**given.as_dict()), "forces").attrs["case"]


@pytest.mark.parametrize(
    "take", [np.array, pd.Series, pd.Index, xr.DataArray, tuple, lambda v: (np.int64(v[0]), *v[1:])]
)
def test_lists_of_a_study_may_be_arrays(take):
    study = {"name": "notebook", "contact_model": "sliding", "outputs": ["forces"]}
    listed = study | {"factors": {"axial_force": {"values": [0, 10]}}}
    assert (
        tr.load_study(study | {"factors": {"axial_force": {"values": take([0, 10])}}}).merged()
        == tr.load_study(listed).merged()
    )
    drawn = study | {"method": "lhs", "samples": np.int32(8), "base": pd.Series({"motor_force": 0.0})}
    drawn["factors"] = {"axial_force": {"uniform": take([0, 10])}}
    assert tr.load_study(drawn).design().sizes["case"] == 8


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"factors": {"axial_force": {"values": {0, 10}}}}, "Write sorted"),
        ({"factors": {"axial_force": {"values": iter([0, 10])}}}, "Write list"),
        ({"factors": {"axial_force": np.array([0, 10])}}, r"Write \{values: \[0, 10\]\}"),
        ({"base": {"motor_force": np.array([0, 10])}}, r"motor_force: \{values: \[0, 10\]\}"),
        ({"method": "table", "table": pd.DataFrame({"axial_force": [0, 10]})}, "to_csv"),
        (
            {"factors": {"load": {"values": ["0.2 kN", "0.3 kN"]}, "radial_force": {"expression": "-load"}}},
            "'0.2 kN'.*Only parameters take units",
        ),
        (
            {
                "method": "lhs",
                "factors": {"load": {"uniform": ["1 N", "2 N"]}, "radial_force": {"expression": "-load"}},
            },
            "Only parameters take units",
        ),
    ],
    ids=range(7),
)
def test_refused_lists_of_a_study_say_what_to_write(change, words):
    with pytest.raises(tr.InputError, match=words):
        tr.load_study({"name": "notebook", "factors": {"motor_force": {"values": [0, -10]}}} | change).design()


def test_levels_can_be_selected_and_are_those_of_a_written_list():
    study = {"name": "levels", "contact_model": "sliding", "outputs": ["forces"]}

    def designed(spec):
        return tr.load_study(study | {"factors": {"friction_coefficient": spec}}).design()

    listed = designed({"values": [0.05, 0.1, 0.15, 0.2, 0.25]})
    for spec in ({"linspace": [0.05, 0.25, 5]}, {"values": np.arange(0.05, 0.26, 0.05)}):
        assert np.array_equal(designed(spec).friction_coefficient, listed.friction_coefficient)
    powers = designed({"logspace": [1e-6, 1e-2, 5]}).friction_coefficient
    assert powers.values.tolist() == [1e-6, 1e-5, 1e-4, 1e-3, 1e-2]
    solved = tr.run(study | {"factors": {"friction_coefficient": {"linspace": [0.05, 0.25, 5]}}}, progress=False)
    assert np.isfinite(solved.data.sel(friction_coefficient=0.15).normal_force).all()


def test_a_spectrum_of_a_notebook():
    blocks = [{"name": "a", "distance": 100, "radial_force": -200}, {"name": "b", "distance": 50, "radial_force": -300}]
    listed = Spectrum.from_dict({"blocks": blocks})
    for given in (pd.DataFrame(blocks), np.array(blocks, dtype=object), tuple(blocks)):
        assert (
            Spectrum.from_dict({"blocks": given, "base": pd.Series({"axial_force": 30})}).blocks[1]
            == (Spectrum.from_dict({"blocks": blocks, "base": {"axial_force": 30}}).blocks[1])
        )
    assert Spectrum.from_dict({"blocks": blocks, "critical_damage": np.float32(1)}) == listed


def test_paths_and_options_of_a_notebook(tmp_path):
    (tmp_path / "cases.csv").write_text("axial_force\n0\n10\n")
    study = {"name": "table", "method": "table", "table": Path(tmp_path / "cases.csv"), "outputs": ["forces"]}
    assert tr.load_study(study).design().sizes["case"] == 2
    given = {
        "outputs": np.array(["forces", "life"]),
        "failure_probability": np.float32(0.1),
        "shortcuts": np.bool_(True),
    }
    ds = tr.solve(tr.Case(), contact_model=np.str_("sliding"), **given)
    assert ds.attrs["failure_probability"] == "0.1" and "roller_life_hours" in ds


def test_wear_names_an_unknown_option_and_takes_one_group():
    with pytest.raises(tr.InputError, match="Did you mean 'accuracy'"):
        tr.wear(tr.Case(), 1, acuracy="preview")
    with pytest.raises(tr.InputError, match="outputs = 'force'"):
        tr.wear(tr.Case(), 1, "force")
