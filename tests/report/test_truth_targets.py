"""The truth test of sentences on targets: random studies with random outputs, each claim recomputed from their rows."""

from __future__ import annotations

import re

import numpy as np
import pytest
from synthetic_results import results_of

from trackroller.report.pages.study import contents
from trackroller.report.words.targets import target, target_tables
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


def check_levels(ds, met, text):
    """Check the least and the largest share over the levels of a factor: 'Fit changes it most: from 12 % (..)'."""
    found = re.search(rf"changes it most: from {CHANCE} at (.+) to {CHANCE} at (.+)\.$", text)
    if found is None:
        return 0
    least, most, ends = found[1], found[5], (found[4], found[8])
    shares = {}
    for name in LISTS:
        if name in ds.variables and ds[name].ndim:
            for level in np.unique(ds[name].values):
                words = f"{WORDS[name]} {level:g}" if name in WORDS else str(level)
                shares[words] = met[ds[name].values == level].mean()
    named = [[v for words, v in shares.items() if end.startswith(words)] for end in ends]
    if named[0] and named[1]:
        agrees(least, named[0][0])
        agrees(most, named[1][0])
        assert found[3] is None or float(found[3]) <= float(found[6])  # the intervals lie apart
    return 1


@pytest.mark.slow
@pytest.mark.parametrize("design", ["inner_outer", "lhs", "grid"])
def test_every_sentence_on_targets_is_true(design):
    levels = 0
    for seed in range(14):
        ds, data = random_aims(seed, design)
        sens = analyse(results_of(ds))
        rows = hits(ds, data)
        assert sens.sizes["target"] == len(rows)
        for number, met in enumerate(rows):
            said = target(sens, number)
            if design == "inner_outer":
                share = met.reshape(-1, 40).mean(axis=1)
                told = re.search(rf"probability {SHARE} \(95 % interval {SHARE} to {SHARE}\)", said.text)
                agrees(told[1], share.max())
                assert float(told[2]) - 0.51 <= 100 * share.max() <= float(told[3]) + 0.51
                if len(share) > 1 and np.ptp(share) > 0:
                    ties = int((np.abs(share - share.max()) < 1e-9).sum())  # intervals may differ, too
                    of_one = f"no other of the {len(share)} design points has more" in said.text
                    assert of_one or (ties > 1 and f" at {ties} of the {len(share)} design points." in said.text)
                    agrees(re.search(rf"The least, {SHARE}", said.text)[1], share.min())
                elif len(share) > 1:
                    assert f"at all {len(share)} design points" in said.text
            else:
                agrees(re.search(rf"(?:probability|met by) {SHARE}", said.text)[1], met.mean())
                assert ("95 % interval" in said.text) == (design == "lhs")
            levels += check_levels(ds, met, said.text)
        cells = [cell for table in target_tables(sens, results_of(ds)) for row in table.rows for cell in row[1:]]
        assert all(re.fullmatch(rf"{CHANCE}|\d+ of \d+|–", cell) for cell in cells)
    assert levels >= 3


def test_targets_stand_in_the_head_and_in_decide_of_the_report():
    ds, data = random_aims(3, "inner_outer")
    found = contents(results_of(ds, analyse(results_of(ds))))
    head = dict(found["summary"])["Decide"]
    assert head[0].kind == "target" and head == found["said"]["decide"]
    table = next(t for t in found["tables"]["decide"] if t.name == "targets")
    assert len(table.heads) == 1 + len(hits(ds, data))
