"""Sensitivities: analytic test functions through the whole chain, files included, and no silent bias."""

import re

import numpy as np
import pytest
import xarray as xr
from known_functions import PI, ishigami, ishigami_indices
from synthetic_results import results_of

from trackroller.errors import InputError
from trackroller.results.sensitivity import analyse
from trackroller.study.file.load import parse_study
from trackroller.study.outputs import outputs


def solved(data, fake, path=None):
    """Return a study that went through the study reader and a file, with an analytic function as the solver."""
    study = parse_study(data)
    design = study.design()
    ds = design.copy()
    for name, values in fake(design).items():
        ds[name] = ("case", values)
    if path is not None:
        ds.to_netcdf(path)
    return ds


CARRIERS = {  # parameters of a case that carry the Ishigami function's inputs; they do not change the geometry
    "axial_force": {"uniform": [-PI, PI]},
    "motor_force": {"uniform": [-PI, PI]},
    "velocity": {"uniform": [1.0, 1.0 + 2 * PI]},
}


def carried(design):
    y = ishigami(design["axial_force"].values, design["motor_force"].values, design["velocity"].values - 1 - PI)
    return {"friction_power": y, "peak": 0 * y + 7.0, "life": 10 ** (y / 10)}


def test_ishigami_indices_come_right_through_the_whole_chain(tmp_path):
    """Study file to design, netCDF, Saltelli analysis, netCDF: indices within their intervals and within 0.03."""
    solved({"name": "ishigami", "method": "saltelli", "samples": 1024, "factors": CARRIERS}, carried, tmp_path / "s.nc")
    result = analyse(results_of(tmp_path / "s.nc"))
    first, total, pair = ishigami_indices()
    for output in ("friction_power", "life"):  # log10 of the life is the function itself
        part = result.sel(output=output)
        np.testing.assert_allclose(part["S1"], first, atol=0.03)
        np.testing.assert_allclose(part["ST"], total, atol=0.03)
        assert (part["ST_low"] <= total).all() and (total <= part["ST_high"]).all()
        assert float(part["S2"].sel(factor="axial_force", factor_2="velocity")) == pytest.approx(pair, abs=0.04)
        for one, other in (("axial_force", "motor_force"), ("motor_force", "velocity")):  # these act one by one
            assert float(part["S2"].sel(factor=one, factor_2=other)) == pytest.approx(0.0, abs=0.05)
        assert int(part["reliable"]) == 1
        np.testing.assert_allclose(part["first"], first, atol=0.05)
    constant = result.sel(output="peak")
    assert np.isnan(constant["S1"]).all() and "constant" in str(constant["note"].item())
    assert list(result["sample_size"].values) == [16, 32, 64, 128, 256, 512, 1024]
    error = np.abs(result["ST_course"].sel(output="life") - total)
    assert error.isel(sample_size=-1).max() < error.isel(sample_size=slice(0, 2)).max()


def run_chain(data, folder, function):
    """Run study reader, plan, chunks, gathering and analysis with an analytic function as the solver."""
    from trackroller.study.run import run_study

    def solver(design, **_):
        y = function(design)
        rows = np.zeros(y.size, dtype=np.int8)
        return xr.Dataset(
            {"friction_power": ("case", y, {"units": "W"}), "regime": ("case", rows), "converged": ("case", rows + 1)}
        )

    run_study(parse_study(data), folder, solver=solver)
    return analyse(results_of(folder / data["name"] / "study.nc"))


def test_ishigami_through_the_study_runner_with_a_case_that_raises(tmp_path):
    """Plan, chunks, gather, analysis: indices right although one case raised; its block is left out and said."""

    def function(design):
        if np.isclose(design["velocity"].values, worst).any():
            raise RuntimeError("this case cannot be solved")
        return carried(design)["friction_power"]

    data = {"name": "chain", "method": "saltelli", "samples": 256, "factors": CARRIERS, "outputs": ["forces"]}
    worst = float(parse_study(data).design()["velocity"].values[8 * 7 + 3])  # a mixture row: B's velocity, twice more
    result = run_chain(data, tmp_path, function).sel(output="friction_power")
    first, total, _ = ishigami_indices()
    np.testing.assert_allclose(result["S1"], first, atol=0.06)
    np.testing.assert_allclose(result["ST"], total, atol=0.06)
    assert re.findall(r"\d+", str(result["note"].item()))[:2] == ["255", "256"]


def test_categorical_grid_through_the_study_runner(tmp_path):
    """A grid unstacked by the gather, with a material pair, a derived factor and an infinite radius."""
    data = {
        "name": "grid",
        "outputs": ["forces"],
        "factors": {
            "velocity": {"values": [10.0, 20.0, 40.0]},
            "material_pair": {"values": [["PA6", "PA6"], ["POM", "PA6"]]},
            "guide_curve_radius": {"values": [float("inf"), 220.0]},
            "motor_force": {"expression": "-velocity / 2"},
        },
    }

    def function(design):
        bonus = 100.0 * (design["roller_material"].values == "POM") * np.isinf(design["guide_curve_radius"].values)
        return -2 * design["motor_force"].values + bonus

    result = run_chain(data, tmp_path, function).sel(output="friction_power")
    v = np.var([10, 20, 40.0])
    parts = np.array([v, 625, 625, 625])  # each category alone 25^2 and both together 25^2
    np.testing.assert_allclose(result["main_share"], parts[:3] / parts.sum())
    pair = result["interaction_share"].sel(factor="material_pair", factor_2="guide_curve_radius")
    assert float(pair) == pytest.approx(625 / parts.sum())


def test_table_of_own_cases_is_analysed_from_given_data(tmp_path):
    """A CSV of random cases through the runner: the factors are its columns, a pair of materials is one factor."""
    rng = np.random.default_rng(5)
    rows = [
        f"{10 + 50 * rng.random():.6f},{30 * rng.random():.6f},{rng.choice(['PA6', 'POM'])} / PA6" for _ in range(300)
    ]
    table = tmp_path / "cases.csv"
    table.write_text("velocity,axial_force,material_pair\n" + "\n".join(rows) + "\n", encoding="utf-8")
    data = {
        "name": "own",
        "method": "table",
        "table": str(table),
        "outputs": ["forces"],
        "factors": {"motor_force": {"expression": "-axial_force / 2"}},
    }

    def function(design):
        return design["velocity"].values + 30.0 * (design["roller_material"].values == "POM")

    result = run_chain(data, tmp_path, function)
    assert set(result["factor"].values) == {"velocity", "axial_force", "material_pair"}
    share = (50**2 / 12) / (50**2 / 12 + 225)
    part = result.sel(output="friction_power")
    assert float(part["first"].sel(factor="velocity")) == pytest.approx(share, abs=0.08)
    assert float(part["first"].sel(factor="material_pair")) == pytest.approx(1 - share, abs=0.08)
    assert float(part["delta"].sel(factor="axial_force")) < 1.3 * float(part["delta_noise"].sel(factor="axial_force"))


def test_unstacked_grid_file_gives_the_same_shares(tmp_path):
    """A grid unstacked into its factors, dimensions in another order, through a file."""
    data = {
        "name": "g",
        "factors": {
            "velocity": {"values": [10.0, 20.0, 40.0]},
            "material_pair": {"values": [["PA6", "PA6"], ["POM", "PA6"]]},
        },
    }
    ds = solved(data, lambda d: {"y": d["velocity"].values + 100.0 * (d["roller_material"].values == "POM")})
    y = ds["y"].values.reshape(3, 2)
    coords = {"velocity": [10.0, 20.0, 40.0], "material_pair": ["PA6 / PA6", "POM / PA6"]}
    grid = xr.Dataset({"y": (("material_pair", "velocity"), y.T)}, coords, ds.attrs)
    grid.to_netcdf(tmp_path / "study.nc")
    result = analyse(results_of(tmp_path / "study.nc"))
    v = np.var([10, 20, 40.0])
    np.testing.assert_allclose(result["main_share"].sel(output="y"), np.array([v, 2500]) / (v + 2500))


def test_one_failed_row_costs_a_block_and_no_index_goes_to_zero():
    """Where a NaN would make S1 = ST = 0 in silence, its block goes and the note says so."""
    ds = solved({"name": "i", "method": "saltelli", "samples": 256, "factors": CARRIERS}, carried)
    whole = analyse(results_of(ds))
    regime = np.zeros(ds.sizes["case"], dtype=np.int8)
    regime[[5, 100]] = 3
    broken = ds.assign(regime=("case", regime))
    broken["friction_power"] = broken["friction_power"].where(broken["regime"] == 0)
    part = analyse(results_of(broken))
    note = str(part["note"].sel(output="friction_power").item())
    assert re.findall(r"\d+", note) == ["254", "256", "2"] and note.endswith("failed")
    np.testing.assert_allclose(part["ST"].sel(output="life"), whole["ST"].sel(output="life"), atol=0.02)
    assert "2 failed" in part.attrs["treatment"] and "failed" in part["output"].values


def test_full_slip_rows_are_left_out_counted_and_analysed_on_their_own():
    """Rows in full slip follow another mechanism and must not change the indices of the other rows."""

    def fake(design):
        x, mu = design["axial_force"].values, design["velocity"].values
        slip = mu > 6.5
        return {"friction_power": np.where(slip, 1e6, x), "regime": slip.astype(np.int8)}

    data = {"name": "i", "method": "lhs", "samples": 600, "factors": CARRIERS}
    result = analyse(results_of(solved(data, fake)))
    assert float(result["first"].sel(output="friction_power", factor="axial_force")) > 0.97
    assert float(result["first"].sel(output="full_slip", factor="velocity")) > 0.8  # binned: the step is smeared
    assert "full slip" in str(result["note"].sel(output="friction_power").item())
    kept = analyse(results_of(solved(data | {"analysis": {"keep": ["rolling", "full_slip"]}}, fake)))
    assert float(kept["first"].sel(output="friction_power", factor="axial_force")) < 0.1


def test_mostly_unusable_saltelli_design_is_marked_and_given_data_still_stand():
    """30 % failed rows leave few whole blocks: marked as unreliable; the given-data share is still right."""
    rng = np.random.default_rng(0)

    def fake(design):
        y = design["axial_force"].values + 0.1 * design["velocity"].values
        return {"friction_power": np.where(rng.random(y.size) < 0.3, np.nan, y)}

    result = analyse(results_of(solved({"name": "i", "method": "saltelli", "samples": 512, "factors": CARRIERS}, fake)))
    part = result.sel(output="friction_power")
    assert int(part["reliable"]) == 0 and "whole range" in str(part["note"].item())
    assert float(part["first"].sel(factor="axial_force")) == pytest.approx(0.99, abs=0.03)


def test_note_of_a_grid_counts_the_cells_left_out_because_one_failed():
    """One failed corner of 4 by 5 cells removes a level, so that the remaining grid is full."""
    factors = {"axial_force": {"values": [0, 10, 20, 30]}, "velocity": {"values": [20, 40, 60, 80, 100]}}

    def fake(design):
        y = design["axial_force"].values + design["velocity"].values
        return {"friction_power": np.where(y == 130, np.nan, y)}

    result = analyse(results_of(solved({"name": "g", "factors": factors}, fake)))
    told = str(result["note"].sel(output="friction_power").item())
    assert re.findall(r"\d+", told)[:4] == ["16", "20", "1", "3"]


def test_rows_of_another_study_are_refused():
    """Rows and study file that do not belong together give no indices."""
    ds = solved({"name": "i", "method": "lhs", "samples": 100, "factors": CARRIERS}, carried)
    with pytest.raises(InputError, match="rows"):
        analyse(results_of(ds.isel(case=slice(0, 50))))
    with pytest.raises(InputError, match="belong together"):
        analyse(results_of(ds.assign(velocity=ds["velocity"] * 1.01)))


def test_outputs_of_a_solved_case_join_contacts_and_bodies():
    """Lives by the shorter contact, stresses by the higher, hours instead of cycles; one contact by its name."""
    rows = 40
    rng = np.random.default_rng(0)
    stress = rng.random((rows, 2, 2)) + 1
    ds = xr.Dataset(
        {
            "peak_stress": (("case", "contact", "body"), stress, {"units": "MPa"}),
            "life_cycles": (("case", "contact", "body"), 1e6 / stress),
            "roller_life_hours": ("case", (1 / stress[:, :, 0]).min(axis=1), {"units": "h"}),
        },
        {"contact": [1, 2], "body": ["roller", "guide"]},
    )
    found = {o.name: o for o in outputs(ds, ["velocity"])}
    assert set(found) == {"roller_life_hours", "life_cycles_guide", "peak_stress_roller", "peak_stress_guide"}
    np.testing.assert_allclose(found["life_cycles_guide"].values, np.log10(1e6 / stress[:, :, 1]).min(axis=1))
    np.testing.assert_allclose(found["peak_stress_roller"].values, stress[:, :, 0].max(axis=1))
    (one,) = outputs(ds, ["velocity"], ["peak_stress_guide_2"])
    np.testing.assert_allclose(one.values, stress[:, 1, 1])
    for name in ("peak_stres", "peak_stress"):
        with pytest.raises(InputError, match="peak_stress_roller"):
            outputs(ds, ["velocity"], [name])
