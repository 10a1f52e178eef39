"""Designs: every method takes every kind of factor and draws what its name promises."""

import numpy as np
import pytest
from SALib.sample import sobol as salib

from trackroller.errors import InputError
from trackroller.methods import METHODS, saltelli
from trackroller.methods import arrays as designs
from trackroller.methods.factor import Factor, parse
from trackroller.study.design.sampling import sample

MIXED = {
    "friction_coefficient": {"truncnormal": [0.2, 0.1, 0.05, 0.4]},
    "ratio": {"uniform": [1.1, 1.4]},
    "radial_force": {"loguniform": [-400, -100]},
    "material_pair": {"values": [["steel", "steel"], ["PA6", "steel"], ["POM", "steel"]]},
    "guide_curve_radius": {"values": [220, float("inf"), -220]},
    "roller_profile_radius": {"expression": "-ratio * guide_profile_radius"},
}


@pytest.mark.parametrize(
    "method", ["lhs", "sobol", "saltelli", "morris", "central_composite", "box_behnken", "inner_outer"]
)
def test_every_sampled_method_takes_every_kind_of_factor(method):
    """Mixed factors: right lengths, right ranges, derived factor follows, same seed same design."""
    design = sample(MIXED, method, 16, 3, base={"guide_profile_radius": 6.0})
    again = sample(MIXED, method, 16, 3, base={"guide_profile_radius": 6.0})
    assert set(design.columns) == set(MIXED) and len(design.unit) == design.size
    assert "roller_profile_radius" not in design.factors
    np.testing.assert_allclose(design.columns["roller_profile_radius"], -6 * design.columns["ratio"])
    mu, force = design.columns["friction_coefficient"], design.columns["radial_force"]
    assert mu.min() >= 0.05 and mu.max() <= 0.4 and force.min() >= -400 and force.max() <= -100
    assert set(design.columns["material_pair"]) <= {("steel", "steel"), ("PA6", "steel"), ("POM", "steel")}
    for name in MIXED:
        assert list(design.columns[name]) == list(again.columns[name])
    assert method in METHODS


@pytest.mark.parametrize(
    ("spec", "mean", "deviation"),
    [
        ({"uniform": [1.0, 3.0]}, 2.0, 2 / np.sqrt(12)),
        ({"normal": [5.0, 0.5]}, 5.0, 0.5),
        ({"loguniform": [1.0, np.e]}, np.e - 1, np.sqrt((np.e**2 - 1) / 2 - (np.e - 1) ** 2)),
        ({"triangular": [0.0, 0.5, 2.0]}, 2.5 / 3, np.sqrt((0 + 0.25 + 4 - 0 - 0 - 1.0) / 18)),
        ({"truncnormal": [0.0, 1.0, 0.0, 50.0]}, np.sqrt(2 / np.pi), np.sqrt(1 - 2 / np.pi)),
        ({"values": [1.0, 2.0, 6.0]}, 3.0, np.sqrt(14 / 3)),
        ({"lognormal": [2.0, 0.4]}, 2 * np.exp(0.08), 2 * np.exp(0.08) * np.sqrt(np.expm1(0.16))),
        ({"lognormal": [-2.0, 0.4]}, -2 * np.exp(0.08), 2 * np.exp(0.08) * np.sqrt(np.expm1(0.16))),
        ({"weibull": [3.0, 2.0]}, 3 * np.sqrt(np.pi) / 2, 3 * np.sqrt(1 - np.pi / 4)),
    ],
)
def test_distributions_have_their_moments(spec, mean, deviation):
    """Mean and standard deviation of a Latin hypercube match the closed forms."""
    values = sample({"x": spec}, "lhs", 20000, 1).columns["x"]
    assert values.mean() == pytest.approx(mean, rel=2e-3)
    assert values.std() == pytest.approx(deviation, rel=1e-2)


def test_latin_hypercube_has_one_point_in_each_slice():
    """Each of n slices of every factor holds exactly one point."""
    design = sample({"a": {"uniform": [0, 1]}, "b": {"uniform": [0, 1]}}, "lhs", 50, 2)
    for values in design.columns.values():
        assert sorted((values * 50).astype(int)) == list(range(50))


def test_categories_are_drawn_equally_often():
    """Equal-probability bins: a Latin hypercube of 300 has each of three categories 100 times."""
    pair = sample(MIXED, "lhs", 300, 5, base={"guide_profile_radius": 6.0}).columns["material_pair"]
    assert [sum(p == q for p in pair) for q in parse("p", MIXED["material_pair"]).levels] == [100, 100, 100]


def test_grid_runs_through_all_combinations_with_the_last_factor_fastest():
    """2 x 3 grid in C order, single values kept as columns, linspace and logspace by their ends."""
    spec = {"a": {"values": [1, 2]}, "b": {"logspace": [1, 100, 3]}, "c": {"values": ["only"]}}
    design = sample(spec, "grid", 0, 0)
    assert design.meta["shape"] == (2, 3) and list(design.factors) == ["a", "b"]
    np.testing.assert_allclose(design.columns["a"], [1, 1, 1, 2, 2, 2])
    np.testing.assert_allclose(design.columns["b"], [1, 10, 100] * 2)
    assert set(design.columns["c"]) == {"only"}
    np.testing.assert_allclose(sample({"b": {"linspace": [0, 1, 3]}}, "grid", 0, 0).columns["b"], [0, 0.5, 1])


def test_morris_steps_change_one_factor_and_categories_reach_every_value():
    """Each step moves exactly one factor; five categories are all visited (four levels by bins would miss one)."""
    spec = {"x": {"uniform": [0, 1]}, "c": {"values": list("abcde")}, "z": {"normal": [0, 1]}}
    design = sample(spec, "morris", 60, 1)
    table = np.stack([design.columns["x"], [ord(c) for c in design.columns["c"]], design.columns["z"]], axis=1)
    steps = np.diff(table.reshape(60, 4, 3), axis=1) != 0
    assert (steps.sum(axis=2) == 1).all() and (steps.sum(axis=1) == 1).all()
    assert set(design.columns["c"]) == set("abcde")
    assert np.isfinite(design.columns["z"]).all() and abs(design.columns["z"]).max() < 2.4  # cut at 1 and 99 %


@pytest.mark.parametrize("second", [True, False])
@pytest.mark.parametrize("groups", [[0], [0, 1, 2], [0, 1, 2, 3, 4, 5], [0, 1, 0, 2], [0, 0, 0, 1, 1]])
def test_saltelli_rows_are_those_of_salib(groups, second):
    k = len(groups)
    problem = {"num_vars": k, "names": [f"x{j}" for j in range(k)], "bounds": [[0.0, 1.0]] * k}
    if len(set(groups)) < k:
        problem["groups"] = [f"group {group}" for group in groups]
    for seed in (0, 77):
        theirs = salib.sample(problem, 32, calc_second_order=second, seed=seed)
        assert np.array_equal(saltelli.draw(32, groups, second, seed), theirs)


def test_saltelli_rows_are_mixtures_of_two_samples():
    """Row AB_j differs from A in factor j only, there it equals B; base samples go up to a power of two."""
    spec = {k: {"uniform": [0, 1]} for k in "abc"}
    design = sample(spec, "saltelli", 12, 4)
    assert design.meta["base_samples"] == 16 and design.size == 16 * 8
    block = np.stack(list(design.columns.values()), axis=1).reshape(16, 8, 3)
    for j in range(3):
        assert (block[:, 1 + j, j] == block[:, -1, j]).all()
        others = [i for i in range(3) if i != j]
        assert (block[:, 1 + j][:, others] == block[:, 0][:, others]).all()
    assert sample(spec, "saltelli", 16, 4, second_order=False).size == 16 * 5


@pytest.mark.parametrize("order", [3, 7, 11, 15, 19, 23, 40, 47])
def test_plackett_burman_columns_are_balanced_and_orthogonal(order):
    """Every column has as many -1 as +1 and no two correlate, powers of two and Paley orders alike."""
    design = designs.plackett_burman(order)
    np.testing.assert_array_equal(design.T @ design, len(design) * np.eye(order))
    assert (design.sum(axis=0) == 0).all()


def test_response_surface_designs_have_their_known_sizes():
    """Box-Behnken 3, 4, 6, 7 factors: 12, 24, 48, 56 runs and the centre; central composite 2^k + 2k + 1."""
    assert [len(designs.box_behnken(k)) for k in (3, 4, 6, 7)] == [13, 25, 49, 57]
    assert [len(designs.central_composite(k)) for k in (2, 3, 5)] == [9, 15, 43]
    for k in (3, 6, 7):
        design = designs.box_behnken(k)
        assert np.unique(design, axis=0).shape == design.shape
        off = design.T @ design
        assert (off[~np.eye(k, dtype=bool)] == 0).all()


def test_inner_outer_design_repeats_one_inner_sample_at_every_point():
    """Common random numbers: the scatter is the same at each design point."""
    spec = {"p": {"values": [1, 2, 3]}, "x": {"normal": [0, 1]}, "c": {"values": ["a", "b"], "scatter": True}}
    design = sample(spec, "inner_outer", 10, 1)
    assert design.meta["design_points"] == 3 and design.meta["inner"] == ["x", "c"]
    inner = design.columns["x"].reshape(3, 10)
    assert (inner == inner[0]).all()
    np.testing.assert_array_equal(design.columns["p"].reshape(3, 10)[:, 0], [1, 2, 3])


def test_table_of_own_cases_is_taken_with_a_derived_column(tmp_path):
    """A CSV gives its columns; what varies is a factor, text columns are categories, expressions may follow."""
    path = tmp_path / "cases.csv"
    path.write_text("axial_force,material_pair,velocity\n10,PA6 / steel,60\n20,steel / steel,60\n\n")
    design = sample({"motor_force": {"expression": "-axial_force / 2"}}, "table", 1, 1, table=path)
    assert list(design.factors) == ["axial_force", "material_pair"]
    np.testing.assert_array_equal(design.columns["motor_force"], [-5, -10])
    path.write_text("axial_force,velocity\n10,\n20,60\n")
    with pytest.raises(InputError, match="line 2"):
        sample({}, "table", 1, 1, table=path)


@pytest.mark.parametrize(
    ("factors", "method", "says"),
    [
        ({"x": {"unifrm": [0, 1]}}, "lhs", "Did you mean 'uniform'"),
        ({"x": {"uniform": [1, 0]}}, "lhs", "low < high"),
        ({"x": {"uniform": [0, "2*y"]}}, "lhs", "expression"),
        ({"x": {"normal": [0, -1]}}, "lhs", "> 0"),
        ({"x": {"loguniform": [-1, 1]}}, "lhs", "one sign"),
        ({"x": {"lognormal": [0, 0.2]}}, "lhs", "median other than 0"),
        ({"x": {"lognormal": [1, 50]}}, "lhs", "sd of ln"),
        ({"x": {"weibull": [1, 0]}}, "lhs", "a shape"),
        ({"x": {"values": [1, 1.0]}}, "lhs", "once"),
        ({"x": {"values": []}}, "lhs", "not empty"),
        ({"x": {"values": [1], "uniform": [0, 1]}}, "lhs", "exactly one"),
        ({"x": {"linspace": [0, 1, 2.5]}}, "grid", "whole number"),
        ({"x": {"uniform": [0, 1]}}, "grid", "linspace"),
        ({"x": {"uniform": [0, 1]}}, "soboll", "Did you mean 'sobol'"),
        ({"x": {"values": [1, 2]}}, "inner_outer", "scatters"),
        ({"x": {"values": [1, 2, 3]}}, "plackett_burman", "two values"),
        ({"x": {"uniform": [0, 1]}}, "box_behnken", "3 to 7"),
        ({"x": {"values": [1]}}, "lhs", "at least one factor that varies"),
        ({"x": {"uniform": [0, 1]}, "a": {"expression": "b"}, "b": {"expression": "a"}}, "lhs", "circle"),
        ({"x": {"uniform": [-1, 1]}, "a": {"expression": "sqrt(x)"}}, "lhs", "not a number"),
        ({"friction_coefficient": {"normal": [0.1, 0.1]}}, "lhs", "truncnormal"),
        ({"x": 3}, "lhs", "a mapping with one of"),
    ],
)
def test_wrong_factors_are_refused_with_a_remedy(factors, method, says):
    """Every mistake in the factor table is an InputError that says what to change."""
    with pytest.raises(InputError, match=says):
        sample(factors, method, 50, 1)


def test_unknown_option_of_a_method_is_refused():
    """Options belong to their method."""
    with pytest.raises(InputError, match="second_order"):
        sample({"x": {"uniform": [0, 1]}}, "saltelli", 8, 1, second_ordr=True)


def test_quantiles_of_listed_values_fall_into_equal_bins():
    """from_unit at the ends and the middle of [0, 1]."""
    factor = Factor("c", "values", levels=("a", "b", "c"))
    assert list(factor.from_unit(np.array([0.0, 0.3, 0.34, 0.99, 1.0]))) == ["a", "a", "b", "c", "c"]
