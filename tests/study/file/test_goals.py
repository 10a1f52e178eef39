"""Keys analysis, pareto and constraints of a study file, in analysis and report; delta index; S-N diagram."""

import dataclasses
import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from synthetic_results import results_of

from trackroller.damage.sn_curve import SNCurve
from trackroller.errors import InputError
from trackroller.materials import load_database
from trackroller.methods.b10 import b10
from trackroller.methods.delta import delta
from trackroller.methods.given_data import given_data
from trackroller.parameters import expressions
from trackroller.report.figures.sn_diagram import sn_diagram
from trackroller.results.robustness import material_deviations
from trackroller.results.sensitivity import analyse
from trackroller.roller.stored_inputs import as_material
from trackroller.study.file.goals import Analysis
from trackroller.study.file.load import parse_study

LHS = {
    "name": "a",
    "method": "lhs",
    "samples": 400,
    "outputs": ["forces", "contact", "friction_work", "life"],
    "factors": {
        "axial_force": {"uniform": [0.0, 1.0]},
        "velocity": {"uniform": [1.0, 2.0]},
        "roller_material": {"values": ["PA6", "POM"]},
    },
}
LIVES = LHS | {"analysis": {"outputs": ["roller_life_hours"]}}
GOALS = {"pareto": {"roller_life_hours": "max", "friction_power": "min", "axis_distance": "min"}}
STEEL = {
    "name": "steel",
    "tensile_strength": 720.0,
    "fatigue_strength_ratio": 0.5,
    "cycles_at_tensile_strength": 1e4,
    "cycles_at_fatigue_limit": 5e6,
    "youngs_modulus": 2.1e5,
    "poisson_ratio": 0.3,
}


def solved(data=LHS, regime=None, **fake):
    """Return a study through its reader, with functions of axial force and velocity as the solver."""
    study = parse_study(data)
    ds = study.design()
    x, v = ds["axial_force"].values, ds["velocity"].values
    for name, of in fake.items():
        ds[name] = ("case", of(x, v), {"units": "h" if "life" in name else "W"})
    ds["regime"] = ("case", (np.zeros(x.size) if regime is None else regime(x, v)).astype(np.int8))
    ds.attrs["materials"] = json.dumps({"PA6": STEEL, "POM": STEEL})
    return ds


@pytest.mark.parametrize(
    ("data", "parts"),
    [
        ({"analysis": {"outputs": ["roller_life_hour"]}}, ["analysis.outputs", "roller_life_hours"]),
        ({"analysis": {"outputs": ["peak_stress_roller"]}}, ["analysis.outputs", "Add peak_stress"]),
        ({"analysis": {"outputs": ["normal_force"]}}, ["one number a case", "normal_force_1"]),
        ({"analysis": {"outputs": []}}, ["analysis.outputs"]),
        ({"analysis": {"scales": 100}}, ["scales", "scale"]),
        ({"analysis": {"scale": {"friction_power": "log"}}}, ["analysis.scale.friction_power", "log10"]),
        ({"analysis": {"keep": ["full_slip"]}}, ["analysis.keep", "rolling"]),
        ({"analysis": {"material_scatter": True}}, ["material_scatter", "inner_outer"]),
        ({"analysis": 3}, ["analysis"]),
        ({"pareto": {"friction_power": "min"}}, ["pareto", "two or more"]),
        ({"pareto": {"friction_power": "min", "roller_life_hours": "up"}}, ["pareto.roller_life_hours", "max"]),
        ({"pareto": {"friction_power": "min", "roller_material": "max"}}, ["pareto", "number"]),
        (GOALS | {"constraints": ["regime != full_slp"]}, ["constraints", "full_slip"]),
        (GOALS | {"constraints": ["regime < 2"]}, ["constraints", "regime < 2"]),
        (GOALS | {"constraints": ["max_pressure + 2"]}, ["constraints", "comparison"]),
        (GOALS | {"constraints": "slip < 1"}, ["constraints", "list"]),
        (GOALS | {"constraints": ["().__class__ == 1"]}, ["constraints", "not allowed"]),
        ({"constraints": ["slop < 1"]}, ["constraints", "slip"]),
    ],
)
def test_wrong_goals_of_a_study_are_refused_with_field_and_remedy(data, parts):
    with pytest.raises(InputError) as error:
        parse_study(LHS | data)
    for part in parts:
        assert part in str(error.value)


def test_material_scatter_needs_materials_that_have_some():
    data = {"name": "n", "method": "inner_outer", "factors": {"axial_force": {"uniform": [0.0, 1.0]}}}
    with pytest.raises(
        InputError, match=r"materials with scatter; the database has none for 1\.7225-normalised \(roller\)"
    ):
        parse_study(data | {"analysis": {"material_scatter": True}})
    assert parse_study(data | {"analysis": {"material_scatter": 4}}).config.analysis.material_scatter == 4


@pytest.mark.parametrize(
    ("outputs", "refused"),
    [
        (["roller_life_hours"], ""),
        (["life_cycles_roller_1", "max_pressure"], ""),
        (["max_pressure"], ""),
        (["life_cycles_guide"], "guide"),
        (["life_cycles_roller", "life_cycles_guide_2"], "guide"),
        (None, "guide"),
    ],
)
def test_material_scatter_is_refused_only_for_a_body_whose_life_is_asked_for(tmp_path, outputs, refused):
    """The roller's material scatters, the guide's does not."""
    own = "{like: 1.7225-normalised, scatter_in_cycles: 4}"
    (tmp_path / "own.yaml").write_text(f"materials: {{tested: {own}}}")
    database = load_database(tmp_path / "own.yaml")
    data = {
        "name": "n",
        "method": "inner_outer",
        "base": {"roller_material": "tested"},
        "factors": {"axial_force": {"uniform": [0.0, 1.0]}},
        "analysis": {"material_scatter": True, "outputs": outputs},
    }
    if not refused:
        assert parse_study(data, database=database).config.analysis.material_scatter is True
        return
    with pytest.raises(InputError, match=rf"\({refused}\).*other body"):
        parse_study(data, database=database)


def test_material_scatter_is_refused_for_a_table_too(tmp_path):
    (tmp_path / "cases.csv").write_text("axial_force\n1\n2\n")
    data = {"name": "n", "method": "table", "table": str(tmp_path / "cases.csv")}
    with pytest.raises(InputError, match="method: inner_outer"):
        parse_study(data | {"analysis": {"material_scatter": True}})


def test_conditions_compare_join_and_treat_what_is_not_a_number_as_not_met():
    values = {"a": np.array([1.0, 2.0, np.nan]), "kind": np.array(["x", "y", "x"], dtype=object), "x": "x"}
    cases = {
        "a < 2": [1, 0, 0],
        "a != 1": [0, 1, 0],
        "0 < a <= 2 and kind != x": [0, 1, 0],
        "not a > 1": [1, 0, 0],
        "a > 1 or kind == 'x'": [1, 1, 0],
        "kind == x": [1, 0, 1],
    }
    for text, meets in cases.items():
        np.testing.assert_array_equal(expressions.condition(text, values), np.array(meets, dtype=bool), err_msg=text)


def test_half_of_the_cases_in_full_slip_bias_nothing_and_are_told():
    """The rolling half alone decides the index; what drives the slip has an output of its own."""
    ds = solved(
        LHS,
        lambda x, v: x > 0.5,
        roller_life_hours=lambda x, v: np.where(x > 0.5, 1e-9, 10**v),
        friction_power=lambda x, v: 0 * x + 7.0,
    )
    sens = analyse(results_of(ds))
    life = sens.sel(output="roller_life_hours")
    assert float(life["first"].sel(factor="velocity")) > 0.9 and not int(life["reliable"])
    assert "200 of 400 rows used" in life["note"].item() and "200 full slip" in life["note"].item()
    assert float(sens["first"].sel(output="full_slip", factor="axial_force")) > 0.9
    assert "constant" in sens["note"].sel(output="friction_power").item()
    assert np.isnan(sens["delta"].sel(output="friction_power")).all()


def test_zero_and_infinite_lives_are_left_out_and_counted():
    ds = solved(LIVES, roller_life_hours=lambda x, v: np.where(x < 0.1, np.inf, np.where(x > 0.9, 0.0, 10**v)))
    sens = analyse(results_of(ds))
    note = sens["note"].item()
    assert "40 unlimited" in note and "40 not positive" in note and "320 of 400" in note
    assert np.isfinite(sens["first"]).any()


def test_delta_agrees_with_salib_knows_categories_and_keeps_the_inert_in_the_noise():
    from SALib.analyze import delta as oracle

    x = np.random.default_rng(0).random((600, 3)) * 2 * np.pi - np.pi
    y = x[:, 0] + 2 * x[:, 1]
    own = [delta(y, x[:, j], seed=1) for j in range(3)]
    problem = {"num_vars": 3, "names": ["a", "b", "c"], "bounds": [[-np.pi, np.pi]] * 3}
    theirs = oracle.analyze(problem, x, y, num_resamples=3, seed=1, method="delta")["delta_raw"]
    np.testing.assert_allclose([d[0] for d in own[:2]], theirs[:2], atol=0.08)
    assert own[2][0] <= own[2][3] and own[1][1] < own[1][0] < own[1][2]
    group = np.arange(1200) % 3
    exact, low, high, _ = delta((group == 1).astype(float), group, ordered=False)
    assert exact == pytest.approx(4 / 9, abs=0.02) and low <= 4 / 9 <= high


def test_every_measure_has_an_interval():
    x = np.random.default_rng(3).random((300, 2))
    found = given_data(x[:, 0], x, np.array([True, True]))
    ends = [f"{name}{end}" for name in ("first", "delta", "prcc") for end in ("", "_low", "_high")]
    assert set(found) == {*ends, "delta_noise", "rows_used"}
    assert found["delta"][0] > 0.6 > found["delta_noise"][0]


def test_lines_of_the_diagram_are_those_of_pylife():
    """S-N lines at 10, 50 and 90 % from T_N, at and above the knee."""
    pytest.importorskip("pylife.materiallaws.woehlercurve")
    import pylife.materiallaws.woehlercurve  # noqa: F401

    k = np.log(5e6 / 1e4) / np.log(2)
    line = pd.Series({"SD": 360.0, "ND": 5e6, "k_1": k, "k_2": k, "TN": 4.0, "TS": 4.0 ** (1 / k)})
    cycles = np.geomspace(1e4, 1e7, 7)
    for probability in (0.1, 0.5, 0.9):
        expected = line.woehler.load(cycles, failure_probability=probability)
        curve = SNCurve.of(as_material(STEEL | {"scatter_in_cycles": 4.0})).changed(failure_probability=probability)
        found = curve.allowable_stress(cycles)
        np.testing.assert_allclose(found, expected, rtol=1e-6)


@pytest.mark.parametrize("rule", ["elementary", "haibach", "unlimited"])
def test_the_diagram_shows_cases_and_scatter(rule):
    ds = xr.Dataset(coords={"contact": [1, 2], "body": ["roller", "guide"], "case": np.arange(40)})
    ds["axial_force"] = ("case", np.arange(40.0))
    stress = np.linspace(100, 800, 40)[:, None, None] * np.array([1.0, 0.9])[None, :, None] * np.ones(2)
    ds["peak_stress"] = (("case", "contact", "body"), stress)
    ds["life_cycles"] = (("case", "contact", "body"), SNCurve(720.0, 360.0, 1e4, 5e6, rule).life_cycles(stress))
    ds["regime"] = ("case", (np.arange(40) % 4 == 0).astype(np.int8))
    study = {
        "name": "a",
        "factors": {"axial_force": {"values": list(range(40))}},
        "life_rule": rule,
        "base": {"roller_material": "steel", "guide_material": "steel"},
    }
    ds.attrs = {"study": json.dumps(study), "materials": json.dumps({"steel": STEEL | {"scatter_in_cycles": 4.0}})}
    _, info = sn_diagram(results_of(ds))
    assert "10 % have failed at 0.5 times its median life" in info.caption


def test_scatter_of_each_material_widens_its_own_cases():
    """s = lg(T_N) / 2.563 by material and body; T_S counts by its power k."""

    def found(wanted):
        config = results.config.model_copy(update={"analysis": Analysis(material_scatter=wanted)})
        study = dataclasses.replace(results.study, config=config)
        return material_deviations(dataclasses.replace(results, study=study))

    ds = solved()
    k = np.log(500) / np.log(2)
    ds.attrs["materials"] = json.dumps(
        {
            "PA6": STEEL | {"scatter_in_cycles": 4.0},
            "1.7225-normalised": STEEL,
            "POM": STEEL | {"scatter_in_stress": 4.0 ** (1 / k)},
        }
    )
    results = results_of(ds)
    np.testing.assert_allclose(found(True)["roller"], np.log10(4) / 2.5631, rtol=1e-4)
    assert (found(True)["guide"] == 0).all() and found(False) == {}
    np.testing.assert_allclose(found(4)["guide"], np.log10(4) / 2.5631, rtol=1e-4)
    lives = np.full(400, 1e3)
    half = np.where(np.arange(400) % 2, 0.5, 0.0)
    t = b10(lives, half)[0]  # mean of the two distributions: Phi((lg t - 3) / 0.5) / 2 = 0.1
    assert np.log10(t) == pytest.approx(3 - 0.5 * 0.8416, abs=2e-3)


def test_correlated_columns_of_a_table_are_told(tmp_path):
    rows = [f"{-50 - i},{0.1 + 0.002 * i},{(i * 37) % 101}" for i in range(60)]
    (tmp_path / "t.csv").write_text("radial_force,friction_coefficient,axial_force\n" + "\n".join(rows))
    study = parse_study(
        {"name": "t", "method": "table", "table": "t.csv"} | {"analysis": LIVES["analysis"]}, Path(tmp_path / "s.yaml")
    )
    ds = study.design()
    ds["roller_life_hours"] = ("case", ds["friction_coefficient"].values)
    assert results_of(ds).design.method.name == "table"
    assert "are correlated (rank correlation -1.00)" in analyse(results_of(ds)).attrs["treatment"]


def test_the_life_of_the_pair_counts_to_its_first_limit_in_constraints_and_goals():
    """Unless the limits are left out, or the study names both lives: then each of them means what it says."""
    first, fatigue = "pair_life_to_first_limit_hours", "pair_life_hours"
    study = {"name": "s", "factors": {"axial_force": {"values": [5, 10]}}, "contact_model": "sliding"}
    asked = {"pareto": {fatigue: "max", "max_pressure": "min"}, "constraints": [f"{fatigue} > 2 * axial_force"]}
    config = parse_study(study | asked).config
    assert list(config.pareto) == [first, "max_pressure"] and config.constraints == (f"{first} > 2 * axial_force",)
    config = parse_study(study | asked | {"outputs": ["life", "contact"]}).config
    assert list(config.pareto) == [fatigue, "max_pressure"]
    config = parse_study(study | asked | {"constraints": [f"{first} < {fatigue}"]}).config
    assert list(config.pareto) == [fatigue, "max_pressure"] and config.constraints == (f"{first} < {fatigue}",)
    search = {"method": "optimise", "goals": {f"mean({fatigue})": "max", f"probability({fatigue})": "max"}}
    config = parse_study(study | search | {"analysis": {"target": {"min": 9}}, "pareto": {}}).config
    assert list(config.goals) == [f"mean({first})", f"probability({fatigue})"]
