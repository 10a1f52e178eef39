"""Sensitivities: analytic test functions through the whole chain, files included, and no silent bias."""

import re

import numpy as np
import pytest
import xarray as xr
from synthetic_results import results_of

from trackroller.errors import InputError
from trackroller.methods import convergence
from trackroller.methods import morris as elementary
from trackroller.methods.arrays import effects
from trackroller.methods.given_data import first_order, given_data, prcc
from trackroller.methods.grid import grid_shares
from trackroller.methods.saltelli import sobol
from trackroller.results.sensitivity import analyse
from trackroller.study.design.sampling import sample
from trackroller.study.file.load import parse_study
from trackroller.study.outputs import outputs

PI = np.pi
X3 = {f"x{i}": {"uniform": [-PI, PI]} for i in (1, 2, 3)}


def ishigami(x1, x2, x3):
    """Return the function of Ishigami & Homma (1990) with a = 7, b = 0.1."""
    return np.sin(x1) + 7 * np.sin(x2) ** 2 + 0.1 * x3**4 * np.sin(x1)


def ishigami_indices():
    """Return first-order and total indices and the one second-order index that is not 0, from the closed forms."""
    v1, v2, v13 = 0.5 * (1 + 0.1 * PI**4 / 5) ** 2, 49 / 8, 8 * 0.01 * PI**8 / 225
    v = v1 + v2 + v13
    return np.array([v1, v2, 0]) / v, np.array([v1 + v13, v2, v13]) / v, v13 / v


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
    solved({"name": "ishigami", "design": "saltelli", "samples": 1024, "factors": CARRIERS}, carried, tmp_path / "s.nc")
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


def test_sobol_g_function_matches_its_closed_form():
    """g-function with a = 0, 1, 4.5, 9, 99: first and total indices from prod (1 + V_i) - 1."""
    a = np.array([0, 1, 4.5, 9, 99.0])
    design = sample({f"x{i}": {"uniform": [0, 1]} for i in range(5)}, "saltelli", 2048, 1, second_order=False)
    y = np.prod([(abs(4 * c - 2) + ai) / (1 + ai) for c, ai in zip(design.columns.values(), a, strict=True)], axis=0)
    part = 1 / (3 * (1 + a) ** 2)
    v = np.prod(1 + part) - 1
    total = part * np.prod(1 + part) / (1 + part) / v
    found = sobol(y, 5, False)
    np.testing.assert_allclose(found["S1"], part / v, atol=0.03)
    np.testing.assert_allclose(found["ST"], total, atol=0.03)
    assert found["ST_high"][4] - found["ST_low"][4] < 1e-3  # nearly inert: nearly no noise


def test_sobol_agrees_with_salib_and_is_not_wider():
    """SALib on the same rows: within its own interval; our intervals are no wider."""
    from SALib.analyze import sobol as oracle

    design = sample(X3, "saltelli", 512, 2)
    y = ishigami(*design.columns.values())
    ours = sobol(y, 3, True)
    theirs = oracle.analyze({"num_vars": 3, "names": list(X3), "bounds": [[-PI, PI]] * 3}, y, seed=1)
    assert (np.abs(ours["S1"] - theirs["S1"]) <= theirs["S1_conf"]).all()
    assert (np.abs(ours["ST"] - theirs["ST"]) <= theirs["ST_conf"]).all()
    assert (ours["S1_high"] - ours["S1_low"]).max() < 2 * theirs["S1_conf"].max()


def test_sobol_error_falls_with_sample_size():
    """Mean error over seeds falls at least as one over the root of the samples: 16 times the samples, 1/4."""
    first, total, _ = ishigami_indices()

    def error(n):
        found = [
            sobol(ishigami(*sample(X3, "saltelli", n, s).columns.values()), 3, True, resamples=2) for s in range(8)
        ]
        return np.mean([np.abs(np.r_[f["S1"] - first, f["ST"] - total]) for f in found])

    assert error(512) < 0.25 * error(32)


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

    data = {"name": "chain", "design": "saltelli", "samples": 256, "factors": CARRIERS, "outputs": ["forces"]}
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
        "design": "table",
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


def categorical(x, c):
    return x + np.array([{"a": 0.0, "b": 0.0, "c": 3.0}[k] for k in c])


def test_categorical_function_comes_right_in_every_analysis():
    """y = x + g(c), x uniform on 0..1, g = 0, 0, 3: V_x = 1/12, V_c = 2; Sobol, grid, Morris, given data."""
    spec = {"x": {"uniform": [0.0, 1.0]}, "c": {"values": ["a", "b", "c"]}}
    share = (1 / 12) / (1 / 12 + 2)
    design = sample(spec, "saltelli", 1024, 1)
    found = sobol(categorical(**design.columns), 2, True)
    np.testing.assert_allclose(found["S1"], [share, 1 - share], atol=0.02)
    np.testing.assert_allclose(found["ST"], [share, 1 - share], atol=0.02)

    design = sample(spec, "lhs", 1500, 1)
    given = given_data(categorical(**design.columns), design.places, np.array([True, False]))
    np.testing.assert_allclose(given["first"], [share, 1 - share], atol=0.03)
    assert np.isnan(given["prcc"][1]) and given["prcc"][0] > 0.95  # the category taken out

    design = sample(spec, "morris", 300, 1)
    morris = elementary.morris(categorical(**design.columns), design.unit, np.array([False, True]))
    assert morris["mu_star"][0] == pytest.approx(1.0)
    assert morris["sigma"][0] == pytest.approx(0.0, abs=1e-9)
    assert morris["mu_star"][1] == pytest.approx(2.0, abs=0.2)  # pairs ab 0, ac 3, bc 3

    levels = {"x": {"linspace": [0.0, 1.0, 5]}, "c": spec["c"]}
    design = sample(levels, "grid", 0, 0)
    grid = grid_shares(categorical(**design.columns).reshape(design.meta["shape"]))
    np.testing.assert_allclose(grid["main_share"], np.array([0.125, 2.0]) / 2.125)
    assert grid["interaction_share"][0, 1] == pytest.approx(0.0, abs=1e-12)


def test_grid_shares_of_a_product_are_exact():
    """y = x1 x2 + x3 on {-1, 1}^3: all of the product is interaction."""
    x1, x2, x3 = np.meshgrid([-1, 1], [-1, 1], [-1, 1], indexing="ij")
    found = grid_shares((x1 * x2 + x3).astype(float))
    np.testing.assert_allclose(found["main_share"], [0, 0, 0.5], atol=1e-12)
    assert found["interaction_share"][0, 1] == pytest.approx(0.5)
    triple = grid_shares((x1 * x2 * x3).astype(float))
    assert float(triple["higher_share"]) == pytest.approx(1.0)


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
    ds = solved({"name": "i", "design": "saltelli", "samples": 256, "factors": CARRIERS}, carried)
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

    data = {"name": "i", "design": "lhs", "samples": 600, "factors": CARRIERS}
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

    result = analyse(results_of(solved({"name": "i", "design": "saltelli", "samples": 512, "factors": CARRIERS}, fake)))
    part = result.sel(output="friction_power")
    assert int(part["reliable"]) == 0 and "whole range" in str(part["note"].item())
    assert float(part["first"].sel(factor="axial_force")) == pytest.approx(0.99, abs=0.03)


def test_grid_with_holes_drops_levels_and_says_how_many_cells():
    """A corner without results removes levels; the remaining levels stay balanced."""
    y = np.add.outer(np.arange(5.0) ** 2, 10 * np.arange(4.0))
    y[4, 3] = np.nan
    found = grid_shares(y)
    assert int(found["cells"]) == 20 and int(found["cells_used"]) in (15, 16)
    assert found["interaction_share"][0, 1] == pytest.approx(0, abs=1e-12)
    assert np.isnan(grid_shares(np.full((3, 3), np.nan))["main_share"]).all()


def test_note_of_a_grid_counts_the_cells_left_out_because_one_failed():
    """One failed corner of 4 by 5 cells removes a level, so that the remaining grid is full."""
    factors = {"axial_force": {"values": [0, 10, 20, 30]}, "velocity": {"values": [20, 40, 60, 80, 100]}}

    def fake(design):
        y = design["axial_force"].values + design["velocity"].values
        return {"friction_power": np.where(y == 130, np.nan, y)}

    result = analyse(results_of(solved({"name": "g", "factors": factors}, fake)))
    told = str(result["note"].sel(output="friction_power").item())
    assert re.findall(r"\d+", told)[:4] == ["16", "20", "1", "3"]


def test_morris_agrees_with_salib_and_uses_what_is_left():
    """mu, mu*, sigma as SALib gives them; a lost row costs its two effects only."""
    from SALib.analyze import morris as oracle

    design = sample(X3, "morris", 50, 3)
    table = np.stack(list(design.columns.values()), axis=1)
    y = ishigami(*table.T)
    none = np.zeros(3, dtype=bool)
    found = elementary.morris(y, design.unit, none)
    theirs = oracle.analyze({"num_vars": 3, "names": list(X3), "bounds": [[-PI, PI]] * 3}, table, y)
    for name in ("mu", "mu_star", "sigma"):
        np.testing.assert_allclose(found[name], theirs[name], atol=1e-9)
    y[1] = np.nan
    assert elementary.morris(y, design.unit, none)["effects_used"].sum() == 150 - 2


def test_partial_rank_correlation_sees_through_other_factors():
    """y = x1^3 - 2 x2: +1 and -1 with each other taken out, 0 for the inert one, inside its interval."""
    rng = np.random.default_rng(1)
    unit = rng.random((400, 3))
    value, low, high = prcc((unit[:, 0] - 0.5) ** 3 * 8 - 2 * unit[:, 1], unit, np.ones(3, dtype=bool))
    assert value[0] > 0.85 and value[1] < -0.95 and low[2] < 0 < high[2]


def test_share_from_groups_is_free_of_bias_for_noise():
    """The index of an inert grouping of pure noise is 0 on average (the raw ratio is 10 %)."""
    rng = np.random.default_rng(2)
    found = [first_order(rng.normal(size=200), rng.integers(0, 20, 200))[0] for _ in range(60)]
    assert abs(np.mean(found)) < 0.02


@pytest.mark.parametrize("method", ["central_composite", "box_behnken"])
def test_response_surface_recovers_a_quadratic(method):
    """y = 1 + 2a - 3b + a b + 4 c^2 in coded units: effects 4, -6, 0; interaction 2; curvature 4."""
    design = sample({k: {"uniform": [0, 10]} for k in "abc"}, method, 0, 1)
    a, b, c = design.unit.T
    found = effects(1 + 2 * a - 3 * b + a * b + 4 * c**2, design.unit, np.zeros(3, dtype=bool), True)
    np.testing.assert_allclose(found["effect"], [4, -6, 0], atol=1e-9)
    assert found["interaction"][0, 1] == pytest.approx(2) and found["curvature"][2] == pytest.approx(4)
    assert float(found["r_squared"]) == pytest.approx(1)


def test_plackett_burman_keeps_main_effects_clear_of_interactions():
    """Folded over: a strong interaction does not leak into any main effect."""
    design = sample({k: {"uniform": [0, 1]} for k in "abcdefg"}, "plackett_burman", 0, 1)
    u = design.unit
    found = effects(u[:, 0] + 5 * u[:, 1] * u[:, 2], u, np.zeros(7, dtype=bool), False)
    np.testing.assert_allclose(found["effect"], [2, 0, 0, 0, 0, 0, 0], atol=1e-9)


def test_advice_on_sample_size_follows_the_width():
    """Half width 0.1 against 0.05 wants 4 times the samples; 0.04 is enough."""
    assert convergence.take_times(np.array([0.4]), np.array([0.6]), 0.05) == 4
    assert convergence.take_times(np.array([0.46]), np.array([0.54]), 0.05) == 1


def test_rows_of_another_study_are_refused():
    """Rows and study file that do not belong together give no indices."""
    ds = solved({"name": "i", "design": "lhs", "samples": 100, "factors": CARRIERS}, carried)
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
