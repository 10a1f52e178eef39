"""The truth test of tables of targets: random studies with random outputs, each cell recomputed from their rows."""

from __future__ import annotations

import re

import numpy as np
import pytest
from synthetic_results import results_of

from trackroller.report.pages.study import contents
from trackroller.report.words.targets import target_tables
from trackroller.results.sensitivity import analyse
from trackroller.study.file.load import parse_study

SHARE = r"([\d.]+) %"
BOUND = rf"(?:over |below )?{SHARE}"
CHANCE = rf"{BOUND}(?: \({BOUND} to {BOUND}\))?"
LISTS = {
    "velocity": [30.0, 45.0, 60.0],
    "contact_angle": [30.0, 36.0],
    "roller_material": ["PA6", "POM"],
    "axial_force": [0.0, 5.0, 10.0],
}
WORDS = {"velocity": "mean travel speed", "contact_angle": "contact angle", "axial_force": "axial force"}


def random_aims(seed, design):
    """Return a study with random targets; outputs depend on all factors, some slip, some are undefined, some tie."""
    rng = np.random.default_rng(seed)
    names = [str(n) for n in rng.permutation(list(LISTS))][: rng.integers(1, 4)]
    factors = {n: {"values": LISTS[n][: rng.integers(1, 4)]} for n in names}
    if design != "grid":
        factors |= {"friction_coefficient": {"uniform": [0.1, 0.3]}, "radial_force": {"normal": [-150.0, 5.0]}}
    else:
        factors["friction_coefficient"] = {"values": [0.1, 0.2, 0.3]}
    wanted = {"roller_life_hours": {"min": float(np.round(10 ** rng.uniform(2.0, 4.0), 1))}}
    if rng.random() < 0.5:
        wanted["friction_power"] = {"max": 9.0} | ({"min": 2.0} if rng.random() < 0.5 else {})
    analysis = {"target": wanted}
    data = {"name": "a", "design": design, "factors": factors, "analysis": analysis, "seed": int(seed)}
    data |= {"outputs": ["forces", "friction_work", "life"]} | ({"samples": 40} if design != "grid" else {})
    if rng.random() < 0.3:
        data["constraints"] = ["friction_coefficient < 0.25"]
    study = parse_study(data)
    ds = study.design()
    n = ds.sizes["case"]
    codes = [np.unique(ds[f].values, return_inverse=True)[1] for f in factors if f in ds]
    logs = 3 + sum(rng.normal(0, 0.4) * code / max(code.max(), 1) for code in codes)
    life = np.round(10**logs, 0)
    life[rng.random(n) < 0.05], life[rng.random(n) < 0.05] = np.nan, np.inf
    ds["roller_life_hours"] = ("case", life, {"units": "h"})
    ds["friction_power"] = ("case", 3 * logs, {"units": "W"})
    ds["regime"] = ("case", (rng.random(n) < rng.choice([0.0, 0.1])).astype("i1"))
    return ds, data


def hits(ds, data):
    """Return which rows meet each target and all targets, without the code under test: name -> (n,)."""
    usable = ds["regime"].values == 0
    if "constraints" in data:
        usable = usable & (ds["friction_coefficient"].values < 0.25)
    found = {}
    for name, limits in data["analysis"]["target"].items():
        values = ds[name].values
        found[name] = usable & (values >= limits.get("min", -np.inf)) & (values <= limits.get("max", np.inf))
    return list(found.values()) + ([np.all(list(found.values()), axis=0)] if len(found) > 1 else [])


def agrees(told, exact):
    """Return whether a written share is the exact one to its figures, with 0 and 100 % only for none and all."""
    assert float(told) == pytest.approx(100 * exact, abs=0.51)
    assert (told == "0") == (exact == 0) and (told == "100") == (exact == 1)


@pytest.mark.slow
@pytest.mark.parametrize("design", ["inner_outer", "lhs", "grid"])
def test_every_cell_of_targets_is_true(design):
    """Recompute each probability over all cases, at each design point and at each level from the rows."""
    levels = 0
    for seed in range(14):
        ds, data = random_aims(seed, design)
        results = results_of(ds)
        rows = hits(ds, data)
        first, *more = target_tables(analyse(results), results)
        parts = {"All cases": np.ones(ds.sizes["case"], dtype=bool)}
        for name in (n for n in LISTS if n in ds.variables and ds[n].ndim):
            for level in np.unique(ds[name].values):
                words = f"{WORDS[name]} {level:g}" if name in WORDS else str(level)
                parts[words[0].upper() + words[1:]] = ds[name].values == level
        points = [tuple(row) for row in np.arange(ds.sizes["case"]).reshape(-1, 40)] if design == "inner_outer" else []
        for table in (first, *more):
            for row in table.rows:
                for cell, met in zip(row[len(row) - len(rows) :], rows, strict=True):
                    found = re.fullmatch(CHANCE, cell)
                    assert (found[2] is not None) == (design != "grid")
                    if table is first and points:
                        assert any(round(100 * met[list(p)].mean()) == round(float(found[1])) for p in points)
                        continue
                    own = [part for words, part in parts.items() if row[0].startswith(words)]
                    if own:
                        agrees(found[1], met[own[0]].mean())
                        levels += 1
        if points:
            told = [float(re.match(BOUND, row[-1])[1]) for row in first.rows]
            shares = [100 * rows[-1][list(p)].mean() for p in points]
            assert told == sorted(told, reverse=True) and told[0] == pytest.approx(max(shares), abs=0.51)
    assert levels >= 30


def test_targets_stand_in_decide_of_the_report():
    ds, data = random_aims(3, "inner_outer")
    found = contents(results_of(ds, analyse(results_of(ds))))
    table = next(t for t in found["tables"]["decide"] if t.name == "targets")
    assert len(table.heads) == 1 + len(hits(ds, data))
