"""Indices of groups of factors and within the levels of a category, against closed forms."""

import json

import numpy as np
import pytest
import xarray as xr
from synthetic_results import results_of

from trackroller.errors import InputError
from trackroller.methods.saltelli import pairs_sharing, sobol
from trackroller.results.sensitivity import analyse, within_levels
from trackroller.study.design.sampling import sample
from trackroller.study.file.load import parse_study
from validation.benchmarks.known_indices import functions

G = functions()["g-function"]
SHARE = 1 / (3 * (1 + np.array([0, 1, 4.5, 9, 99.0])) ** 2)
UNIT5 = {f"x{i}": {"uniform": [0, 1]} for i in range(5)}
PARTS = {"p": ("x0", "x3"), "q": ("x1", "x2", "x4")}
KINDS = ["sum", "turned", "product"]


def closed(members):
    """Return the closed index of some factors of the g-function."""
    return (np.prod(1 + SHARE[[int(name[1]) for name in members]]) - 1) / (np.prod(1 + SHARE) - 1)


def by_kind(a, b, kind):
    """Return a function whose indices depend on the category."""
    return np.select([kind == "sum", kind == "turned"], [a + 2 * b, 2 * a + b + 3], a * b - 5)


FIRST = {"sum": [0.2, 0.8], "turned": [0.8, 0.2], "product": [3 / 7, 3 / 7]}
TOTAL = {"sum": [0.2, 0.8], "turned": [0.8, 0.2], "product": [4 / 7, 4 / 7]}


@pytest.mark.parametrize("second_order", [True, False])
@pytest.mark.parametrize("count", [2, 3, 4, 6])
def test_rows_of_a_block_share_the_columns_that_the_pairs_are_sorted_by(count, second_order):
    spec = {f"x{i}": {"uniform": [0, 1]} for i in range(count)}
    design = sample(spec, "saltelli", 2, 1, second_order=second_order)
    step = 2 * count + 2 if second_order else count + 2
    block = design.unit.reshape(2, step, count)[1]
    pairs = pairs_sharing(count, second_order)
    for columns, found in pairs.items():
        for i, j in found:
            assert sum(1 << k for k in np.flatnonzero(block[i] == block[j])) == columns
    assert all(1 << j in pairs and (1 << count) - 1 - (1 << j) in pairs for j in range(count))


@pytest.mark.parametrize("second_order", [True, False])
def test_groups_of_the_g_function_lie_in_their_intervals(second_order):
    """Rows exchanged by group cost n (2 g + 2), or n (g + 2) without the second order."""
    first = np.array([closed(m) for m in PARTS.values()])
    total = 1 - first[::-1]
    hits, errors = [], []
    for seed in range(40):
        design = sample(UNIT5, "saltelli", 128, seed, groups=PARTS, second_order=second_order)
        found = design.method.group_indices(G.evaluate(design.unit), design, PARTS)
        for name, exact in (("group_S1", first), ("group_ST", total)):
            hits.append((found[f"{name}_low"] <= exact) & (exact <= found[f"{name}_high"]))
            errors.append(found[name] - exact)
    assert np.mean(hits) >= 0.93
    assert np.abs(np.mean(errors, axis=0)).max() < 0.015 and np.sqrt(np.mean(np.square(errors))) < 0.04
    assert design.size == 128 * (6 if second_order else 4)


def test_groups_of_ishigami_and_single_factors_have_their_known_indices():
    f = functions()["Ishigami"]
    spec = {f"x{i}": {"uniform": [0, 1]} for i in range(3)}
    groups = {"outer": ("x0", "x2"), "x1": ("x1",)}
    design = sample(spec, "saltelli", 1024, 1, groups=groups)
    found = design.method.group_indices(f.evaluate(design.unit), design, groups)
    exact = 1 - f.first[1]
    assert found["group_S1"] == pytest.approx([exact, f.first[1]], abs=0.02)
    assert found["group_ST"] == pytest.approx([exact, f.first[1]], abs=0.02)
    single = {name: (name,) for name in spec}
    design = sample(spec, "saltelli", 1024, 1, groups=single)
    y = f.evaluate(design.unit)
    alone = design.method.group_indices(y, design, single)
    plain = sobol(y, 3, True)
    np.testing.assert_allclose(alone["group_S1"], plain["S1"], atol=1e-12)
    np.testing.assert_allclose(alone["group_ST"], plain["ST"], atol=1e-12)


def test_groups_of_a_grid_are_exact():
    """y = a b + c on centred levels: the product belongs to the group of a and b, with or without other groups."""
    spec = {"a": {"values": [-1, 1]}, "c": {"values": [-2, 0, 2]}, "b": {"values": [-1, 0, 1]}}
    design = sample(spec, "grid", 0, 0)
    a, b, c = (design.columns[name] for name in "abc")
    found = design.method.group_indices(a * b + c, design, {"ab": ("a", "b"), "c": ("c",)})
    product, sole = 2 / 3, 8 / 3
    assert found["group_S1"] == pytest.approx(np.array([product, sole]) / (product + sole))
    assert found["group_ST"] == pytest.approx(found["group_S1"])
    apart = design.method.group_indices(a * b + c, design, {"ac": ("a", "c"), "b": ("b",)})
    assert apart["group_S1"] == pytest.approx([sole / (product + sole), 0])
    assert apart["group_ST"] == pytest.approx([1, product / (product + sole)])
    assert np.isnan(design.method.group_indices(np.ones(18), design, {"ab": ("a", "b"), "c": ("c",)})["group_S1"]).all()


SPEC = {"a": {"uniform": [0, 1]}, "kind": {"values": KINDS, "weights": [2, 1, 1]}, "b": {"uniform": [0, 1]}}


@pytest.mark.long
@pytest.mark.parametrize(
    ("method", "size", "options"),
    [("saltelli", 256, {}), ("saltelli", 512, {"second_order": False}), ("lhs", 600, {}), ("sobol", 512, {})],
)
def test_each_level_has_its_own_indices_within_their_intervals(method, size, options):
    hits, errors = [], []
    for seed in range(20):
        design = sample(SPEC, method, size, seed, **options)
        y = by_kind(design.columns["a"], design.columns["b"], design.columns["kind"])
        found = within_levels(y, design, "kind")
        assert np.isnan(found["conditional_S1"][:, 1]).all()
        for name, exact in (("conditional_S1", FIRST), ("conditional_ST", TOTAL)):
            if name not in found:
                assert method in ("lhs", "sobol")
                continue
            truth = np.array([exact[kind] for kind in KINDS])
            hits.append(
                (found[f"{name}_low"][:, ::2] <= truth + 1e-9) & (truth - 1e-9 <= found[f"{name}_high"][:, ::2])
            )
            errors.append(found[name][:, ::2] - truth)
    assert np.mean(hits) >= (
        0.91 if method == "sobol" else 0.93
    )  # 92 % in 60 Sobol sequences, any seed of the bootstrap
    if method != "sobol":  # RBD-FAST is up to 0.06 low on 128 rows of a Sobol sequence, within its interval
        assert np.abs(np.mean(errors, axis=0)).max() < 0.03


def test_levels_of_a_grid_are_exact_and_count_their_cells():
    spec = {"a": {"linspace": [0, 1, 3]}, "kind": {"values": KINDS}, "b": {"linspace": [0, 1, 4]}}
    design = sample(spec, "grid", 0, 0)
    y = by_kind(design.columns["a"], design.columns["b"], design.columns["kind"])
    found = within_levels(y, design, "kind")
    va, vb = np.var([0, 0.5, 1]), np.var([0, 1 / 3, 2 / 3, 1])
    assert found["conditional_S1"][0, ::2] == pytest.approx(np.array([va, 4 * vb]) / (va + 4 * vb))
    assert found["conditional_ST"][1, ::2] == pytest.approx(np.array([4 * va, vb]) / (4 * va + vb))
    product = va * vb + va / 4 + vb / 4
    assert found["conditional_S1"][2, ::2] == pytest.approx(np.array([va / 4, vb / 4]) / product)
    assert found["conditional_ST"][2, ::2] == pytest.approx(1 - np.array([vb / 4, va / 4]) / product)
    assert found["conditional_rows"].tolist() == [12, 12, 12]


def test_blocks_of_one_level_hold_no_row_of_another_level():
    """An output that is NaN at one level leaves the indices at the other levels unchanged."""
    design = sample(SPEC, "saltelli", 64, 3)
    y = by_kind(design.columns["a"], design.columns["b"], design.columns["kind"])
    whole = within_levels(y, design, "kind")
    lost = within_levels(np.where(design.columns["kind"] == "sum", np.nan, y), design, "kind")
    np.testing.assert_array_equal(lost["conditional_S1"][1:], whole["conditional_S1"][1:])
    assert np.isnan(lost["conditional_S1"][0]).all() and lost["conditional_rows"][0] == 0
    assert whole["conditional_rows"].sum() == 2 * 64


FILE = {
    "name": "n",
    "factors": {
        "axial_force": {"uniform": [0, 20]},
        "radial_force": {"uniform": [-300, -100]},
        "friction_coefficient": {"uniform": [0.1, 0.2]},
        "roller_material": {"values": ["PA6", "POM"]},
    },
    "method": "saltelli",
    "samples": 64,
}


def solved(data):
    """Return a gathered study whose life depends on the load for one material and on friction for the other."""
    study = parse_study(data)
    ds = study.design()
    load, friction = -ds["radial_force"] / 200 + ds["axial_force"] / 20, ds["friction_coefficient"] * 10
    log_life = xr.where(ds["roller_material"] == "PA6", load + 0.2 * friction, 3 + 0.2 * load + friction)
    ds["roller_life_hours"] = ("case", 10 ** (4 - log_life.values), {"units": "h", "long_name": "life"})
    ds.attrs["study"] = study.merged()
    return ds


def test_a_table_has_indices_within_the_levels_of_its_columns(tmp_path):
    rng = np.random.default_rng(1)
    lines = [f"{rng.uniform(0, 9)},{rng.uniform(-300, -100)},{('PA6', 'POM')[i % 2]}" for i in range(80)]
    (tmp_path / "cases.csv").write_text("\n".join(["axial_force,radial_force,roller_material", *lines]))
    data = {"name": "n", "method": "table", "table": str(tmp_path / "cases.csv")}
    study = parse_study(data | {"analysis": {"conditional_on": "roller_material"}})
    ds = study.design()
    ds["roller_life_hours"] = ("case", np.exp(ds["axial_force"].values), {"units": "h"})
    ds.attrs["study"] = json.dumps(study.as_dict())
    sens = analyse(results_of(ds))
    assert (sens["conditional_S1"].sel(output="roller_life_hours", factor="axial_force") > 0.8).all()
    with pytest.raises(InputError, match="Did you mean 'roller_material'"):
        parse_study(data | {"analysis": {"conditional_on": "roler_material"}})


@pytest.mark.parametrize(
    ("more", "says"),
    [
        ({"method": "lhs", "analysis": {"groups": {"g": ["axial_force"]}}}, "grid or saltelli, not lhs"),
        ({"analysis": {"groups": {"axial_force": ["axial_force"]}}}, "no factor.*Rename"),
        ({"analysis": {"groups": {"g": []}}}, "at least one"),
        ({"analysis": {"groups": {"g": ["axal_force"]}}}, "Did you mean 'axial_force'"),
        ({"analysis": {"groups": {"g": ["axial_force"], "h": ["axial_force"]}}}, "in one group"),
        ({"method": "morris", "analysis": {"conditional_on": "roller_material"}}, "not morris"),
        ({"analysis": {"conditional_on": "axial_force"}}, "list of at most 12"),
        ({"analysis": {"conditional_on": "material_roller"}}, "Did you mean 'roller_material'|roller_material"),
        (
            {"analysis": {"groups": {"g": ["axial_force"]}, "conditional_on": "roller_material"}},
            "not saltelli with analysis.groups",
        ),
    ],
)
def test_wrong_groups_and_categories_are_refused_when_the_study_is_read(more, says):
    with pytest.raises(InputError, match=says):
        parse_study(FILE | more)
