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
NUMBERS = ("friction_coefficient", "roller_profile_radius")


def study_of(name):
    """Return one of the twelve studies, and its rows as a plain table."""
    ds = sampled_study(SAMPLES[name]) if name in SAMPLES else grid_study(GRIDS[name])
    ds["peak"] = ds["peak_stress"].sel(body="roller").max("contact")
    table = ds[["regime", "converged", "validity", "roller_life_hours", "peak"]].to_dataframe().reset_index()
    if name not in SAMPLES:
        table = table[[*GRIDS[name], *table.columns.difference(list(GRIDS[name]))]]
    return ds.drop_vars("peak"), table


def said_of(results):
    """Return all sentences of the page."""
    return [sentence for _, own in contents(results)["summary"] for sentence in own]


@pytest.mark.slow
@pytest.mark.parametrize("name", [*GRIDS, *SAMPLES])
def test_a_sentence_that_should_appear_does(name):
    ds, table = study_of(name)
    grid = name in GRIDS
    said = said_of(results_of(ds, analyse(results_of(ds)) if grid else None))
    rolls, total = int((table["regime"] == 0).sum()), len(table)
    counts = {"full slip": int((table["regime"] == 1).sum()), "lift-off": int((table["regime"] == 2).sum())}
    (valid,) = (one for one in said if one.kind == "valid")
    assert (valid.values["rolling"], valid.values["total"]) == (rolls, total)
    assert valid.values["lost"] == {words: n for words, n in counts.items() if n}
    assert f"{rolls} of {total} cases roll" in valid.text
    for code, what in ((1, "full_slip"), (2, "lift_off")):
        hit = int((table["regime"] == code).sum())
        told = [(one.values["count"], one.values["of"]) for one in said if one.values.get("what") == what]
        assert told == [(hit, total)] * (hit > 0), (what, hit)
    inside = (table["regime"] == 0) & (table["validity"] & 15 == 0)
    assert valid.values["inside"] == inside.sum()
    if grid:
        expect_deciding_factor(table[table["regime"] == 0], list(GRIDS[name]), rolls == total, said)
        expect_largest_effect(table[inside], list(GRIDS[name]), said)


def expect_deciding_factor(rows, factors, complete, said):
    """On a complete grid the factor with the largest variance of its level means decides, with its share."""
    if not complete:
        return
    logs = np.log10(rows["roller_life_hours"])
    share = {f: logs.groupby(rows[f]).mean().var(ddof=0) / logs.var(ddof=0) for f in factors}
    lead = max(share, key=share.get)
    first = [one.values["first"] for one in said if one.kind == "index" and one.values["output"] == "roller_life_hours"]
    assert [rank.factor for rank in first] == [lead] and first[0].value == pytest.approx(share[lead])


def expect_largest_effect(rows, factors, said):
    """Of the two numbers the one with the larger median ratio between its ends stands in the figure's sentence."""
    folds = {}
    for name in (f for f in NUMBERS if f in factors):
        others = [f for f in factors if f != name]
        wide = rows.pivot_table(index=others, columns=name, values="roller_life_hours", dropna=False)
        steps = np.log10(wide[max(wide)] / wide[min(wide)]).replace([np.inf, -np.inf], np.nan).dropna()
        if len(steps) >= 5 and (steps > 0).mean() in (0.0, 1.0) and abs(10 ** steps.median() - 1) > 0.05:
            folds[name] = steps.median(), len(steps)
    if not folds:
        return
    name = max(folds, key=lambda n: abs(folds[n][0]))
    median, pairs = folds[name]
    effects = [one for one in said if one.kind == "pairs"]
    found = [one.values for one in effects if one.values["factor"] == name]
    assert found or len(effects) == 2, (name, effects)  # two factors of more effect may stand before it
    if found:
        values = found[0]
        assert (values["low"], values["high"]) == (rows[name].min(), rows[name].max())
        assert values["ratio"] == pytest.approx(10**median) and values["size"] == pairs
        assert (values["rising"], values["falling"]) == ((pairs, 0) if median > 0 else (0, pairs))
        assert values["verb"] == ("lengthens" if median > 0 else "shortens")


@pytest.mark.parametrize("name", CONSTRAINED)
def test_cases_that_meet_a_constraint_are_counted(name):
    ds, table = study_of(name)
    limit = "axial_force < 20" if name == "axial" else f"material_pair != '{PAIRS[2]}'"
    ds.attrs["study"] = yaml.safe_dump(yaml.safe_load(ds.attrs["study"]) | {"constraints": [limit]}, sort_keys=False)
    inside = (table["regime"] == 0) & (table["validity"] & 15 == 0)
    kept = inside & (table["axial_force"] < 20 if name == "axial" else table["material_pair"] != PAIRS[2])
    said = dict(contents(results_of(ds))["summary"])["Where it ends"][0].values
    assert (said["valid"], said["inside"], said["constraints"]) == (kept.sum(), inside.sum(), [f"`{limit}`"])


def test_pairs_of_materials_say_that_the_friction_of_the_database_changes_too():
    """Two materials, friction given as a word: designs that differ in the pair differ in its friction as well."""
    ds = grid_study({"material_pair": list(PAIRS[:2]), "axial_force": [0.0, 5.0, 10.0, 15.0, 20.0, 25.0]})
    same = results_of(ds)
    ds = ds.assign_coords(friction_coefficient_value=("material_pair", [0.19, 0.4]))
    both = results_of(ds)
    one, two = (effect_of(r, "roller_life_hours", "material_pair", r.valid).values["changed"] for r in (same, both))
    assert (one, two) == ([], ["friction_coefficient"])


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
    said = dict(contents(results_of(few))["summary"])["Where it ends"][1]
    assert said.kind == "only" and said.values["inside"] == said.values["count"] == 2 and said.values["of"] == 8
    assert dict(said.values["conditions"]) == {"radial_force": [-60.0, -50.0], "axial_force": [30.0]}
    assert "−60 N or −50 N" in said.text and "(" not in said.text.split(",", 1)[1]


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
    assert (said.kind == "frequent") == named
    assert (said.values["count"], said.values["of"]) == (hit.sum(), rows)
    if named:
        wanted = [f"contact angle {a}° ({hit[angle == a].sum():,} of {half:,} cases)" for a in (40, 30)]
        assert f"most often at {wanted[0]}." in said.text


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
    front.attrs = {"objectives": "a max, b min, c max", "factors": ""}
    results = results_of(grid_study(GRIDS["curves"] | {"axial_force": list(np.arange(8.0))}))
    rows = {row[0] for row in pareto_table(front, results, None).rows}
    a, b, c = (front[name].values for name in "abc")
    assert {int(a.argmax()), int(b.argmin()), int(c.argmax())} <= rows and len(rows) <= 15
