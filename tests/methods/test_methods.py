"""What each design of experiments says of itself holds: growth, randomness, places, and the index that leads."""

from __future__ import annotations

import ast
from pathlib import Path

import numpy as np
import pytest

from trackroller.methods import METHODS, method
from trackroller.study.design.sampling import sample

RANGES = {
    "a": {"uniform": [0, 1]},
    "b": {"triangular": [0, 1, 3]},
    "c": {"loguniform": [1, 9]},
    "kind": {"values": ["x", "y"]},
}
LISTS = {"a": {"values": [1, 2, 3]}, "kind": {"values": ["x", "y"]}}
POINTS = {"p": {"values": [1, 2]}} | RANGES
DRAWN = [name for name in METHODS if name != "table"]


def factors_of(name):
    return {"grid": LISTS, "inner_outer": POINTS}.get(name, RANGES)


def drawn(name, samples=16, seed=3, **options):
    if METHODS[name].proposes:
        options["conditions"] = ("b",)
    return sample(factors_of(name), name, samples, seed, **options)


@pytest.mark.parametrize("name", DRAWN)
def test_more_samples_keep_the_rows_where_the_method_grows(name):
    small, large = drawn(name), drawn(name, 32)
    points = small.meta.get("design_points", 1) if METHODS[name].points else 1
    rows = small.unit.reshape(points, -1, small.unit.shape[1])
    same = rows.shape[1] * points <= large.size and np.array_equal(
        large.unit.reshape(points, -1, small.unit.shape[1])[:, : rows.shape[1]], rows
    )
    if METHODS[name].grows:
        assert same and large.size == 2 * small.size
    elif METHODS[name].sampled:
        assert not same, f"{name} keeps its rows and does not say so"
    else:
        assert np.array_equal(small.unit, large.unit) or METHODS[name].proposes


@pytest.mark.parametrize("name", DRAWN)
def test_values_follow_from_places_and_another_seed_draws_other_rows(name):
    design, own = drawn(name), METHODS[name]
    for j, (factor_name, factor) in enumerate(design.factors.items()):
        assert np.array_equal(own.values(factor, design.unit[:, j]), design.columns[factor_name])
    assert np.array_equal(design.unit, drawn(name, seed=4).unit) != (own.sampled or own.proposes)


@pytest.mark.parametrize("name", [name for name in DRAWN if not METHODS[name].points and not METHODS[name].proposes])
def test_every_method_gives_the_index_that_leads(name):
    design, own = drawn(name, 64), METHODS[name]
    y = design.columns["a"] + 0.1 * (design.columns["kind"] == "y")
    found = own.estimate(y, design)
    lead = found.estimates[own.headline]
    assert abs(lead[list(design.factors).index("a")]) == np.nanmax(np.abs(lead)) and found.used == found.total > 0
    for name_of in own.judged:
        if name_of in found.estimates:
            assert {f"{name_of}_low", f"{name_of}_high"} <= set(found.estimates)
    assert own.needs and own.unit and own.samples_unit


@pytest.mark.parametrize("name", [name for name in METHODS if METHODS[name].grows and not METHODS[name].points])
def test_replicates_give_the_narrowed_indices_with_intervals(name):
    design = drawn(name, 128, replicates=16)
    found = METHODS[name].replicated(design.columns["a"], design, 64)
    for index in METHODS[name].narrowed:
        low, value, high = (found[index + end] for end in ("_low", "", "_high"))
        assert (low <= value).all() and (value <= high).all() and value.argmax() == 0


def test_groups_and_levels_are_those_of_the_methods_that_have_functions_for_them():
    own = ("grid", "lhs", "sobol", "saltelli", "morris", "table")
    assert [n for n in own if METHODS[n].grouped] == ["grid", "saltelli"]
    assert [n for n in own if METHODS[n].conditional] == ["grid", "lhs", "sobol", "saltelli", "table"]


def test_an_inner_sample_that_cannot_grow_has_no_replicates():
    with pytest.raises(ValueError, match="a sample that grows"):
        drawn("inner_outer", 32, inner="lhs", replicates=16)


def test_the_default_inner_array_is_a_sobol_sample():
    inner = sample({name: RANGES[name] for name in "abc"}, "sobol", 16, 3).unit
    assert np.array_equal(drawn("inner_outer").unit[:16, 1:4], inner)


def test_the_room_reads_no_files_and_labels_nothing():
    for path in Path(method.__file__).parent.glob("*.py"):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        modules = {a.name for n in ast.walk(tree) if isinstance(n, ast.Import) for a in n.names}
        modules |= {str(n.module) for n in ast.walk(tree) if isinstance(n, ast.ImportFrom)}
        assert not {m for m in modules if m.split(".")[0] in ("xarray", "pandas", "pathlib", "yaml")}, path.name
        assert not {m for m in modules if m.startswith(("trackroller.study", "trackroller.roller"))}, path.name


@pytest.mark.slow
def test_no_room_asks_for_a_method_by_its_name():
    """A method's name is compared in no file outside the room: traits and functions of `Method` serve instead."""
    package, asked = Path(method.__file__).parents[1], []
    for path in sorted(package.rglob("*.py")):
        if path.parent.name == "methods":
            continue
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Compare):
                words = {c.value for c in ast.walk(node) if isinstance(c, ast.Constant)}
                names = {a.attr for a in ast.walk(node) if isinstance(a, ast.Attribute)}
                if words & set(METHODS) and names & {"design", "method", "inner", "name"}:
                    asked.append(f"{path.relative_to(package)}:{node.lineno}")
    assert asked == []
