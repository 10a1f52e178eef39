"""Sentences that must appear: each is computed here from the raw rows, and its absence from the page is a failure.

The truth test (`test_truth.py`) checks the sentences that the report writes; this test checks that it writes them.
"""

from __future__ import annotations

import base64
import itertools
import zlib

import numpy as np
import pytest
from synthetic_results import PAIRS, grid_study, sampled_study

from trackroller.report.explorer.pack import pack, sample_rows
from trackroller.report.explorer.rows import ExplorerColumn
from trackroller.report.numbers import shortened

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


def test_long_lists_say_how_many_names_they_leave_out():
    for count in range(1, 30):
        names = [f"name{i}" for i in range(count)]
        text = shortened(names)
        shown = [n for n in names if n in text.replace(" and", ",").split(", ")]
        assert shown == names[: len(shown)] and len(shown) == min(count, 4 if count <= 4 else 3)
        assert ("more" in text) == (count > 4)
    assert shortened(list("abcdefg")) == "a, b, c and four more"
    assert list(itertools.islice(shortened(list("abcd")), 7)) == list("a, b, c")


@pytest.mark.parametrize("count", [2, 254, 255, 256, 65_534, 65_535, 65_536])
def test_columns_of_many_levels_survive_packing(count):
    """One byte holds 255 levels and none; the next level needs a second byte."""
    codes = np.arange(-1, count)
    column = ExplorerColumn(
        "x", "x", "", "factor", codes, tuple(map(float, range(count))), tuple(map(str, range(count)))
    )
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
