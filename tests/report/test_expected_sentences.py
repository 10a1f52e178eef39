"""Sentences that must appear: each is computed here from the raw rows, and its absence from the page is a failure.

The truth test (`test_truth.py`) checks the sentences that the report writes; this test checks that it writes them.
"""

from __future__ import annotations

import base64
import itertools
import zlib

import numpy as np
import pytest
import xarray as xr
import yaml
from synthetic_results import PAIRS, grid_study, results_of, sampled_study
from told import effect_of, occurrence

from trackroller.report.explorer.pack import pack, sample_rows
from trackroller.report.explorer.rows import Column
from trackroller.report.numbers import shortened
from trackroller.report.pages.study import contents
from trackroller.report.words.pareto import pareto_table
from trackroller.results.sensitivity import analyse

CALM = {"friction_coefficient": [0.2, 0.3, 0.4], "roller_profile_radius": [-9.0, -8.0, -7.0]}  # all of it rolls
GRIDS = {
    "two numbers": CALM,
    "drives": CALM | {"motor_force": [-30.0, 0.0]},
    "materials": CALM | {"material_pair": list(PAIRS[:3])},
    "loads": CALM | {"radial_force": [-300.0, -200.0]},
    "axial": CALM | {"axial_force": [0.0, 10.0, 30.0]},
    "angles": CALM | {"contact_angle": [30.0, 40.0]},
    "curves": CALM | {"guide_curve_radius": [220.0, float("inf"), -100.0]},
    "lift-off": CALM | {"axial_force": [0.0, 130.0]},
    "skidding": {"friction_coefficient": [0.02, 0.3], "motor_force": [-30.0, 0.0], "axial_force": [0.0, 30.0]},
    "all regimes": {"friction_coefficient": [0.02, 0.3], "motor_force": [-30.0, 0.0], "axial_force": [0.0, 130.0]},
}
SAMPLES = {"a sample": 300, "a small sample": 60}
CONSTRAINED = ("axial", "materials")
NAMES = {"friction_coefficient": "friction coefficient", "roller_profile_radius": "roller profile radius"}


def study_of(name):
    """Return one of the twelve studies, and its rows as a plain table."""
    ds = sampled_study(SAMPLES[name]) if name in SAMPLES else grid_study(GRIDS[name])
    ds["peak"] = ds["peak_stress"].sel(body="roller").max("contact")
    table = ds[["regime", "converged", "validity", "roller_life_hours", "peak"]].to_dataframe().reset_index()
    if name not in SAMPLES:
        table = table[[*GRIDS[name], *table.columns.difference(list(GRIDS[name]))]]
    return ds.drop_vars("peak"), table


def page(results):
    """Return all sentences and tables of the page."""
    told = contents(results)
    lines = [s.text for _, said in told["summary"] for s in said]
    lines += [str(cell) for key in ("decide", "ends") for t in told["tables"][key] for row in t.rows for cell in row]
    return " ".join([*lines, *(t.note for key in ("decide", "ends") for t in told["tables"][key])])


@pytest.mark.slow
@pytest.mark.parametrize("name", [*GRIDS, *SAMPLES])
def test_a_sentence_that_should_appear_does(name):
    ds, table = study_of(name)
    grid = name in GRIDS
    text = page(results_of(ds, analyse(results_of(ds)) if grid else None))
    rolls, total = int((table["regime"] == 0).sum()), len(table)
    counts = {"full slip": int((table["regime"] == 1).sum()), "lift-off": int((table["regime"] == 2).sum())}
    why = ", ".join(f"{n} {words}" for words, n in counts.items() if n)
    assert f"{rolls} of {total} cases roll" + (f" (the others: {why})" if why else "") in text
    for code, words in ((1, "Full slip"), (2, "Lift-off")):
        hit = int((table["regime"] == code).sum())
        where = f"occurs in all {total}" if hit == total else f"occurs in {hit} of {total} cases"
        assert (f"{words} {where}" in text) == (hit > 0), (words, hit)
    inside = (table["regime"] == 0) & (table["validity"] & 15 == 0)
    outside = rolls - int(inside.sum())
    assert ("all of them lie inside the model" in text) == (outside == 0 < rolls)
    assert (f"{inside.sum()} of them stay inside the model" in text) == (0 < outside < rolls)
    for bit, words in ((4, "the peak stress exceeds the tensile strength"), (8, "the patch reaches the edge")):
        hit = int(((table["regime"] == 0) & (table["validity"] & bit > 0)).sum())
        assert (f"{words}" in text) == (hit > 0) and (hit == 0 or f"({hit})" in text)
    if grid:
        expect_deciding_factor(table[table["regime"] == 0], list(GRIDS[name]), rolls == total, text)
        expect_largest_effect(table[inside], list(GRIDS[name]), text)


def expect_deciding_factor(rows, factors, complete, text):
    """On a complete grid the factor with the largest variance of its level means decides, with its share."""
    if not complete:
        return
    logs = np.log10(rows["roller_life_hours"])
    share = {f: logs.groupby(rows[f]).mean().var(ddof=0) / logs.var(ddof=0) for f in factors}
    lead = max(share, key=share.get)
    words = {"material_pair": "Material pair", "motor_force": "Motor force", "axial_force": "Axial force"} | {
        "radial_force": "Radial force",
        "contact_angle": "Contact angle",
        "guide_curve_radius": "Guide curve radius",
        **{k: v.capitalize() for k, v in NAMES.items()},
    }
    exact = 100 * share[lead]
    shown = [f"{exact:.0f} %", f"{exact:.4g} %"]
    assert any(f"{words[lead]} explains {s} of the variance of log life of the roller" in text for s in shown), lead


def expect_largest_effect(rows, factors, text):
    """Of the two numbers the one with the larger median ratio between its ends stands in the figure's sentence."""
    folds = {}
    for name in (f for f in NAMES if f in factors):
        others = [f for f in factors if f != name]
        wide = rows.pivot_table(index=others, columns=name, values="roller_life_hours", dropna=False)
        steps = np.log10(wide[max(wide)] / wide[min(wide)]).replace([np.inf, -np.inf], np.nan).dropna()
        if len(steps) >= 5 and (steps > 0).mean() in (0.0, 1.0) and abs(10 ** steps.median() - 1) > 0.05:
            folds[name] = steps.median(), len(steps)
    if not folds:
        return
    name = max(folds, key=lambda n: abs(folds[n][0]))
    median, pairs = folds[name]
    fold = 10 ** abs(median)
    written = f"{float(f'{fold:.3g}' if fold < 10 else f'{fold:.2g}'):.10g}-fold"
    verb = "lengthens" if median > 0 else "shortens"
    levels = [f"{v:.10g}".replace("-", "−") for v in (rows[name].min(), rows[name].max())]
    head = f"{NAMES[name].capitalize()} {levels[0]} → {levels[1]}"
    found = [s for s in text.replace(" mm ", " ").split(". ") if s.strip().startswith(head)]
    others = [s for s in text.split(". ") if "-fold, the median of" in s]
    assert found or len(others) == 2, (head, others)  # two factors of more effect may stand before it
    if found:
        assert f"{verb} the life of the roller {written}, the median of {pairs} pairs" in found[0], found[0]
        assert f"{'rises' if median > 0 else 'falls'} in all pairs" in found[0]


@pytest.mark.parametrize("name", CONSTRAINED)
def test_what_a_constraint_removes_is_named(name):
    """Constraints that leave one level, and one that removes a level, each with its counts."""
    ds, table = study_of(name)
    limit = "axial_force < 20" if name == "axial" else f"material_pair != '{PAIRS[2]}'"
    ds.attrs["study"] = yaml.safe_dump(yaml.safe_load(ds.attrs["study"]) | {"constraints": [limit]}, sort_keys=False)
    inside = (table["regime"] == 0) & (table["validity"] & 15 == 0)
    kept = inside & (table["axial_force"] < 20 if name == "axial" else table["material_pair"] != PAIRS[2])
    text = dict(contents(results_of(ds))["summary"])["Where it ends"][0].text
    assert f"{kept.sum()} of the {inside.sum()} meet `{limit}`" in text
    gone = "Axial force 30 N" if name == "axial" else "EN AW-7075 on 1.7225-normalised"
    assert f"{gone} meets the constraints nowhere." in text
    one = yaml.safe_dump(yaml.safe_load(ds.attrs["study"]) | {"constraints": ["friction_coefficient > 0.35"]})
    ds.attrs["study"] = one
    assert (
        "Only friction coefficient 0.4 meets the constraints."
        in dict(contents(results_of(ds))["summary"])["Where it ends"][0].text
    )


def test_pairs_of_materials_say_that_the_friction_of_the_database_changes_too():
    """Two materials, friction given as a word: designs that differ in the pair differ in its friction as well."""
    ds = grid_study({"material_pair": list(PAIRS[:2]), "axial_force": [0.0, 5.0, 10.0, 15.0, 20.0, 25.0]})
    same = results_of(ds)
    ds = ds.assign_coords(friction_coefficient_value=("material_pair", [0.19, 0.4]))
    both = results_of(ds)
    one, two = (effect_of(r, "roller_life_hours", "material_pair", r.valid).text for r in (same, both))
    assert "pairs of valid cases that differ in nothing else;" in one
    assert "that differ in nothing else than the friction coefficient that follows from it" in two


def test_an_index_over_a_grid_with_gaps_is_not_given():
    """Lives without end leave gaps: no share of variance is told, but the effects of pairs are."""
    ds = grid_study(CALM | {"axial_force": [0.0, 10.0, 20.0, 30.0]})
    whole = results_of(ds, analyse(results_of(ds)))
    assert "index" in [s.kind for s in dict(contents(whole)["summary"])["Why"]]
    ds["roller_life_hours"] = ds["roller_life_hours"].where(ds["friction_coefficient"] > 0.25, np.inf)
    results = results_of(ds, analyse(results_of(ds)))
    kinds = [s.kind for s in dict(contents(results)["summary"])["Why"]]
    assert float(results.analysis["used_share"].sel(output="roller_life_hours")) < 1
    assert "index" not in kinds and "pairs" in kinds


def test_small_sets_are_named_by_their_common_property_and_radial_loads_by_their_weight():
    """Two light loads at 30 N lift off: the sentence names the loads, not the numbers of the cases."""
    ds = grid_study({"radial_force": [-300.0, -250.0, -60.0, -50.0], "axial_force": [0.0, 30.0], **CALM})
    hit = (ds["radial_force"] > -100) & (ds["axial_force"] == 30)
    few = ds.isel(friction_coefficient=[1], roller_profile_radius=[1])
    few["regime"] = xr.where(hit, 2, 0).broadcast_like(few["regime"]).transpose(*few["regime"].dims)
    said = dict(contents(results_of(few))["summary"])["Where it ends"][1].text
    assert said.startswith("Lift-off occurs in 2 of 8 cases (25 %), only at ") and "in all cases there" in said
    assert "radial force −60 N or −50 N" in said and "axial force 30 N" in said and "(" not in said.split(",", 1)[1]


def test_long_lists_say_how_many_names_they_leave_out():
    for count in range(1, 30):
        names = [f"name{i}" for i in range(count)]
        text = shortened(names)
        shown = [n for n in names if n in text.replace(" and", ",").split(", ")]
        assert shown == names[: len(shown)] and len(shown) == min(count, 4 if count <= 4 else 3)
        assert ("more" in text) == (count > 4)
    assert shortened(list("abcdefg")) == "a, b, c and four more"
    assert list(itertools.islice(shortened(list("abcd")), 7)) == list("a, b, c")


@pytest.mark.parametrize(
    ("rows", "low", "high", "named"), [(40, 0.3, 0.45, False), (8000, 0.3, 0.45, True), (8000, 0.3, 0.38, False)]
)
def test_a_difference_between_levels_is_named_above_noise_and_a_tenth(rows, low, high, named):
    """Three standard errors of the difference of two shares, and at least 10 %: 40 rows prove nothing."""
    half = rows // 2
    angle = np.repeat([30.0, 40.0], half)
    hit = np.concatenate([np.arange(half) < low * half, np.arange(half) < high * half])
    ds = xr.Dataset({"regime": ("case", hit.astype("i1"))}, {"contact_angle": ("case", angle), "case": np.arange(rows)})
    ds.attrs["study"] = yaml.safe_dump({"factors": {"contact_angle": {"values": [30.0, 40.0]}}})
    said = occurrence(results_of(ds), hit, "Full slip")
    assert (said.kind == "frequent") == named and said.text.startswith(f"Full slip occurs in {hit.sum():,} of {rows:,}")
    if named:
        wanted = [f"contact angle {a}° ({hit[angle == a].sum():,} of {half:,} cases)" for a in (40, 30)]
        assert f"most often at {wanted[0]} and least at {wanted[1]}." in said.text


@pytest.mark.parametrize("count", [2, 254, 255, 256, 65_534, 65_535, 65_536])
def test_columns_of_many_levels_survive_packing(count):
    """One byte holds 255 levels and none; the next level needs a second byte."""
    codes = np.arange(-1, count)
    column = Column("x", "x", "", "factor", codes, tuple(map(float, range(count))), tuple(map(str, range(count))))
    (entry,), block = pack([column])
    raw = np.frombuffer(zlib.decompress(base64.b64decode(block)), np.uint8)
    kind = np.dtype("<" + entry["type"])
    assert np.array_equal(raw.reshape(kind.itemsize, -1).T.copy().view(kind).ravel().astype(int) - 1, codes)
    assert kind.itemsize == (1 if count < 255 else 2 if count < 65_535 else 4)


def test_a_sample_for_the_page_keeps_a_thousand_cases_of_each_state():
    """A share of half a percent would be 250 of 50,000 cases; a state of up to 1,000 cases keeps all of them."""
    state = np.repeat([0, 1, 2, 3], [990_000, 5_000, 1_000, 3])
    shown = np.bincount(state[sample_rows(state, np.zeros(len(state), dtype=bool), 50_000)])
    assert shown[1:].tolist() == [1_000, 1_000, 3] and 47_000 < shown[0] < 50_000


def test_end_points_that_the_sentence_names_stand_in_the_table():
    """Of 200 optimal designs for three goals the best of each stands among the dozen that the table shows."""
    rng = np.random.default_rng(5)
    goals = {name: ("row", values) for name, values in zip("abc", rng.random((3, 200)), strict=True)}
    front = xr.Dataset(goals | {"optimal": ("row", np.ones(200, np.int8))}, {"row": np.arange(200)})
    front.attrs = {"objectives": "a max, b min, c max", "excluded": "none", "factors": ""}
    results = results_of(grid_study(GRIDS["curves"] | {"axial_force": list(np.arange(8.0))}))
    rows = {row[0] for row in pareto_table(front, results, None).rows}
    a, b, c = (front[name].values for name in "abc")
    assert {int(a.argmax()), int(b.argmin()), int(c.argmax())} <= rows and len(rows) <= 15
