"""Designs are compared over draws of the use: rows that repeat others, or stand at ends of ranges, are none."""

import math

import numpy as np
import pandas as pd
import pytest

import trackroller as tr
from trackroller.report.words.verdict import verdict_sentences

LIFE = "pair_life_to_first_limit_hours"
STEEL = dict.fromkeys(("roller_material", "guide_material"), "1.7225-quenched-tempered")
FACTORS = {
    "roller_profile_radius": {"values": [-6.4, -7.5]},
    "friction_coefficient": {"uniform": [0.08, 0.25]},
    "radial_force": {"uniform": [-200, -80]},
}


def run(design, samples, **keys):
    study = {
        "name": "drawn",
        "base": {"motor_force": 0, "axial_force": 10, "guide_overrollings_per_hour": 200, **STEEL},
    }
    study |= {"factors": FACTORS, "design": design, "samples": samples, "contact_model": "sliding"}
    return tr.run(study | {"accuracy": "preview"} | keys, progress=False)


def test_the_mixed_rows_of_saltelli_do_not_narrow_an_interval():
    """Each base sample has the rows A, AB_1 to AB_3 and B; only A and B share no value with another row."""
    results = run("saltelli", 32, second_order=False)
    frame = pd.DataFrame({n: results.table[n].to_numpy() for n in FACTORS}).assign(life=results.column(LIFE))
    own = frame[np.isin(np.arange(len(frame)) % 5, (0, 4))]
    for one in results.verdict.candidates:
        lives = np.sort(own["life"][own["roller_profile_radius"] == one.choices["roller_profile_radius"]])
        assert one.conditions == len(lives) and one.low == lives[math.ceil(0.1 * len(lives)) - 1]
        assert one.interval[1] in lives and one.interval[0] in lives


def test_trajectories_of_morris_are_no_sample_of_the_use():
    """Their values stand at the ends of the ranges half of the time, so that no B10 follows."""
    results = run("morris", 16)
    assert results.candidates().size.min() >= 20
    found = results.verdict
    assert (found.kind, found.why) == ("cannot_tell", "conditions")
    assert "are no random sample of the use" in " ".join(one.text for one in verdict_sentences(results))


def test_the_scatter_of_the_material_enters_verdict_and_target():
    """Of a million rollers at the sampled conditions, each with its own life, nine of ten reach the stated one."""
    deviation = math.log10(4) / 2.5631  # T_N = N_90 / N_10
    keys = {"analysis": {"material_scatter": 4}}
    results = run("inner_outer", 64, **keys)
    found, lives = results.verdict, results.column(LIFE).reshape(2, 64)
    rng = np.random.default_rng(0)
    best = found.best[0]
    row = lives[[-6.4, -7.5].index(best.choices["roller_profile_radius"])]
    rollers = rng.choice(row, 1_000_000) * 10 ** (deviation * rng.standard_normal(1_000_000))
    assert best.low == pytest.approx(np.quantile(rollers, 0.1), rel=0.02)
    plain = run("inner_outer", 64).verdict.best[0].low
    assert best.low < 0.95 * plain and "with the scatter of the material" in verdict_sentences(results)[1].text
    least = 1.02 * plain  # reached without the scatter by the interval of the sample, at most
    judged = run("inner_outer", 64, analysis={"material_scatter": 4, "target": {"min": least}}).verdict
    wide = next(c for c in judged.candidates if c.choices == best.choices)
    assert wide.met == (row >= least).sum()  # of the conditions themselves
    assert judged.kind == ("none" if best.interval[1] < least else "cannot_tell")
