"""A solved study keeps its meaning in memory, in its folder and in `study.nc`, and each way gives the same numbers."""

from __future__ import annotations

import shutil
from pathlib import Path

import netCDF4
import numpy as np
import pytest
import xarray as xr

import trackroller as tr
from trackroller.parameters import PARAMETERS
from trackroller.results.lives_by_tests import beyond_sn_data
from trackroller.roller.differences import scale
from trackroller.study.file.load import parse_study
from trackroller.study.run import run_study

ROOT = Path(__file__).parents[2]
SHIPPED = sorted((ROOT / "config" / "studies").glob("*.yaml"))
SMALL = {"name": "s", "factors": {"friction_coefficient": {"values": [0.1, 0.2]}}, "contact_model": "sliding"}


def few_cases(path: Path):
    """Return a shipped study with its design, factors, goals and analysis, but few cases and a quick model."""
    told = tr.load_study(path).as_dict() | {"contact_model": "sliding", "accuracy": "preview"}
    told["samples"] = 32 if told["method"] == "inner_outer" else 8
    if "until" in told:  # stops at the first look
        told |= {"samples": 128, "until": told["until"] | {"half_width": 9.0}}
    for spec in told["factors"].values() if told["method"] == "grid" else ():
        kind = next(key for key in ("values", "linspace", "logspace") if key in spec)
        spec[kind] = spec[kind][:2] if kind == "values" else [*spec[kind][:2], 2]
    return parse_study(told)


@pytest.mark.long
@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_a_shipped_study_gives_the_same_indices_in_memory_and_through_its_files(path, tmp_path):
    study = few_cases(path)
    here = tr.run(study, progress=False)
    folder = run_study(study, tmp_path).folder
    alone = shutil.copy(folder.gathered, tmp_path / "alone.nc")
    wanted, front = here.indices(), here.pareto()
    assert wanted.data_vars, "the study has indices"
    for again in (tr.open_study(folder.root), tr.open_study(alone), tr.open_study(tr.solve(study.design()))):
        assert again.config == study.config and again.study.merged() == study.merged()
        assert again.design.method == here.design.method and list(again.design.factors) == list(here.design.factors)
        np.testing.assert_array_equal(again.design.unit, here.design.unit)
        for name, column in here.design.columns.items():
            np.testing.assert_array_equal(again.design.columns[name], column)
        xr.testing.assert_identical(again.indices(), wanted)
        assert front is None or again.pareto().identical(front)
        assert again.to_table().equals(here.to_table())


def test_solve_takes_the_options_of_the_study_that_a_design_comes_from():
    study = parse_study(SMALL | {"accuracy": "preview", "outputs": ["forces"]})
    ds = tr.solve(study.design())
    assert ds.attrs["contact_model"] == "sliding" and ds.attrs["accuracy"] == "preview" and "peak_stress" not in ds
    given = tr.solve(study.design(), contact_model="kalker_table")
    assert given.attrs["contact_model"] == "kalker_table" and given.attrs["accuracy"] == "preview"


def test_solve_takes_the_contact_model_of_each_case_and_refuses_another_one():
    models = ["sliding", "kalker_table"]
    study = parse_study(SMALL | {"contact_model": models, "accuracy": "preview", "outputs": ["forces"]})
    design = study.design()
    ds = tr.solve(design)
    assert sorted(set(ds["contact_model"].values.tolist())) == sorted(models)
    for model in models:
        own = design["contact_model"].values == model
        part = tr.solve(design.isel(case=own).drop_vars("contact_model"), contact_model=model)
        np.testing.assert_array_equal(ds["normal_force"].values[own], part["normal_force"].values)
        np.testing.assert_array_equal(ds["driving_force"].values[own], part["driving_force"].values)
    with pytest.raises(tr.InputError, match=r"contact_model = .kalker. .* of the cases, which vary it \(sliding"):
        tr.solve(design, contact_model="kalker")


def test_rows_that_are_not_those_of_the_design_are_refused():
    ds = tr.solve(parse_study(SMALL | {"method": "lhs", "samples": 8, "factors": LOADS}).design(), accuracy="preview")
    tr.open_study(ds)
    with pytest.raises(tr.InputError, match="the 8 rows of its design lhs"):
        tr.open_study(ds.isel(case=slice(0, 4)))
    with pytest.raises(tr.InputError, match="the values of its design"):
        tr.open_study(ds.assign_coords(axial_force=ds["axial_force"] * 1.01))
    with pytest.raises(tr.InputError, match="results with their study file"):
        tr.open_study(ds.drop_attrs())


CONSTANTS = {
    "grid": {"factors": {"friction_coefficient": {"values": ["dry"]}, "axial_force": {"values": [10, 20]}}},
    "lhs": {
        "method": "lhs",
        "samples": 4,
        "factors": {"axial_force": {"uniform": [10, 40]}, "velocity": {"expression": "60 + 0*axial_force"}},
    },
}


@pytest.mark.parametrize("kind", CONSTANTS)
def test_what_all_cases_share_is_an_attribute_with_its_unit(kind, tmp_path):
    given = {"name": kind, "contact_model": "sliding", "accuracy": "preview", "base": {"axis_distance": 24}}
    study = parse_study(given | CONSTANTS[kind])
    folder = run_study(study, tmp_path).folder
    cases = study.design()  # the columns of the cases, which the solver takes
    with netCDF4.Dataset(folder.gathered) as file:
        assert not [name for name, variable in file.variables.items() if not variable.dimensions]
        attrs = {name: file.getncattr(name) for name in file.ncattrs()}
    if kind == "grid":  # the number of a word
        assert attrs["friction_coefficient"] == 0.5
    for name in PARAMETERS.keys() - {"axial_force"}:
        values = np.unique(cases[name].values)
        assert len(values) == 1
        np.testing.assert_equal(attrs[name], values[0])
        assert attrs[f"{name}_units"] == PARAMETERS[name].units
    opened = tr.open_study(folder.root)
    for again in (opened, tr.open_study(opened.data), tr.open_study(tr.solve(cases))):
        assert again.base["axis_distance"] == 24.0 and again.base["velocity"] == 60.0
        assert again.data.attrs["axis_distance_units"] == "mm"
        assert again.data.attrs["roller_material"] == cases["roller_material"].values[0]
        np.testing.assert_array_equal(again.design.unit, opened.design.unit)
        assert not [name for name in again.data.coords if not again.data[name].ndim]
    assert len(repr(opened).splitlines()) <= 10


LOADS = {"axial_force": {"uniform": [10, 40]}, "velocity": {"uniform": [20, 60]}}


def test_a_study_file_that_would_be_read_with_another_meaning_is_refused(monkeypatch):
    ds = tr.solve(parse_study(SMALL).design(), accuracy="preview")
    changed = ds.assign_attrs(study=ds.attrs["study"].replace("friction_coefficient", "radius_of_luck"))
    with pytest.raises(tr.InputError):
        tr.open_study(changed)
    text = ds.attrs["study"].replace("contact_model: sliding", "contact_model: [sliding]")
    with pytest.raises(tr.InputError, match="has another contact_model in this version"):
        tr.open_study(ds.assign_attrs(study=text))


@pytest.mark.long
def test_a_report_takes_the_indices_that_are_known(tmp_path, monkeypatch):
    solved = tr.run(SMALL, progress=False)
    solved.indices().to_netcdf(tmp_path / "indices.nc")
    opened = tr.open_study(solved.data, tmp_path / "indices.nc")

    def again(_):
        raise AssertionError("the indices were computed a second time")

    monkeypatch.setattr("trackroller.results.sensitivity.analyse", again)
    for name, study in (("computed", solved), ("given", opened)):
        assert "friction coefficient" in study.report(tmp_path / f"{name}.html").read_text(encoding="utf-8")


@pytest.mark.long
def test_report_explorer_and_best_cases_come_from_the_same_object(tmp_path):
    grooves = {"roller_profile_radius": {"values": [-7, -8, -9]}}
    study = parse_study(SMALL | {"factors": SMALL["factors"] | grooves})
    ds = tr.solve(study.design(), accuracy="preview")
    solved = tr.open_study(ds)
    assert solved.table is solved.table, "the table of cases is made once"
    best = solved.best(2)
    worst = solved.to_table().groupby("roller_profile_radius")[solved.life[0]].min().sort_values(ascending=False)
    assert best["roller_profile_radius"].tolist() == worst.index[:2].tolist()
    assert best["worst"].tolist() == worst[:2].tolist()
    page = solved.report(tmp_path / "report.html").read_text(encoding="utf-8")
    again = tr.report(ds, tmp_path / "again.html").read_text(encoding="utf-8")
    assert "Where it ends" in page and len(page) == pytest.approx(len(again), rel=0.01)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["again.html", "report.html"]
    assert "data-count" in solved.explore(tmp_path / "explorer.html").read_text(encoding="utf-8")
    with pytest.raises(tr.InputError, match="inner_outer"):
        solved.robustness()


@pytest.mark.slow
def test_a_run_with_a_folder_goes_on_where_it_stopped(tmp_path):
    first = tr.run(parse_study(SMALL), cores=1, progress=False, results=tmp_path)
    again = tr.run(parse_study(SMALL), progress=False, results=tmp_path)
    xr.testing.assert_equal(first.data, again.data)
    assert (tmp_path / "s" / "study.nc").is_file()


def test_best_refuses_a_sample_in_which_no_design_repeats():
    """A Latin hypercube has each design once, at one condition: the error names the design that can answer."""
    factors = {"roller_profile_radius": {"uniform": [-8, -6.5]}, "friction_coefficient": {"uniform": [0.1, 0.3]}}
    data = {"name": "sample", "method": "lhs", "samples": 8, "factors": factors, "contact_model": "sliding"}
    with pytest.raises(tr.InputError, match="method: inner_outer"):
        tr.run(data, progress=False).best()


def test_only_a_life_by_the_sn_curve_can_lie_beyond_its_data():
    """A roller under a small load lasts for ever by the S-N curve; the life of its bearing rests on no such data."""
    bearing = {"rows": 2, "row_distance": 8, "kind": "ball", "dynamic_rating": 3000, "static_rating": 1500}
    bearing |= {"e": 0.3, "X": 0.56, "Y": 1.5, "X0": 0.6, "Y0": 0.5}
    base = {"radial_force": -20, "axial_force": 2, "motor_force": 0, "bearing": bearing}
    study = SMALL | {"base": base, "accuracy": "preview", "outputs": ["forces", "contact", "life", "bearing"]}
    results = tr.run(parse_study(study), progress=False)
    assert np.isfinite(results.data["bearing_life_hours"]).all()
    for name in ("roller_life_hours", "life_cycles_roller"):
        assert beyond_sn_data(results, name).all()
    for name in ("bearing_life_hours", "friction_power"):
        assert not beyond_sn_data(results, name).any()


@pytest.mark.parametrize("name", ["normal_force", "regime", "converged"])
def test_a_dimension_that_was_added_is_refused_and_can_be_selected_away(name):
    study = {"name": "wide", "factors": {"axial_force": {"values": [0, 10]}}, "contact_model": "sliding"}
    ds = tr.solve(tr.load_study(study).design(), ("forces",), accuracy="preview", contact_model="sliding")
    gathered = tr.open_study(ds).data
    wide = gathered.assign({name: gathered[name].expand_dims({"load": 3})})
    with pytest.raises(tr.InputError, match=rf"{name} = 'load' is a dimension that was added.*isel\(load=0\)"):
        tr.open_study(wide)
    assert tr.open_study(wide.isel(load=0)).table.shape == tr.open_study(gathered).table.shape


def test_scales_of_differences_know_parameters_that_all_cases_share():
    """A shared load and axis distance are attributes of a study; the scales are those with coordinates."""
    factors = {"friction_coefficient": {"values": [0.1, 0.3]}}
    study = {"name": "scales", "factors": factors, "contact_model": "sliding", "accuracy": "preview"}
    data = tr.run(study, progress=False).data
    assert "axis_distance" in data.attrs and "radial_force" in data.attrs
    coordinates = data.assign_coords({name: data.attrs[name] for name in ("axis_distance", "radial_force")})
    for name in ("peak_x", "spin_moment", "lateral_force"):
        np.testing.assert_array_equal(scale(data, name), scale(coordinates, name))
