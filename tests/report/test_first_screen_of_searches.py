"""The first screen of a search: values that decide, intervals of sampled goals, and steps around the best design."""

import json

import numpy as np
import pytest
from scipy import stats

import trackroller as tr
from trackroller.report.numbers import percent, quantity, rounded
from trackroller.report.words.optimum import optimum_sentences, steps_table

LIFE = "pair_life_to_first_limit_hours"
STEEL = dict.fromkeys(("roller_material", "guide_material"), "1.7225-quenched-tempered")
BASE = {"axial_force": 8, "motor_force": 0, "guide_curve_radius": np.inf, "guide_overrollings_per_hour": 150}
DRAWN = {"radial_force": {"uniform": [-150, -70]}, "friction_coefficient": {"uniform": [0.05, 0.25]}}


def search(factors, base, **keys):
    study = {"name": "search", "base": BASE | base, "factors": factors, "design": "optimise"}
    study |= {"contact_model": "sliding", "accuracy": "preview", "budget": {"designs": 24}}
    return tr.run(study | keys, progress=False)


@pytest.mark.slow
def test_a_search_whose_range_leaves_the_target_open_says_what_to_measure():
    base = {"radial_force": -60, "guide_profile_radius": 7, "axis_distance": 26, "permissible_wear_depth": 0.1}
    base |= {"guide_material": "C45", "roller_material": "PA66-dry", "roller_profile_radius": -7.7}
    factors = {"contact_angle": {"uniform": [30, 48]}, "friction_coefficient": {"values": [0.1, 0.25]}}
    kept = search(factors, base, goals={LIFE: "max"})
    low, high = (kept.data[f"{LIFE}_{end}"].values.reshape(-1, 2).min(axis=1) for end in ("low", "high"))
    least = 1.05 * float(low.max())
    assert least < high.max()
    results = search(factors, base, goals={LIFE: "max"}, analysis={"target": {"min": least}})
    said = " ".join(one.text for one in optimum_sentences(results))
    assert said.startswith("Measure the wear coefficient of PA66-dry on C45. None of the ")
    best = json.loads(results.data.attrs["optimum"])["recommended"]
    own = float(results.data[f"{LIFE}_low"].values.reshape(-1, 2)[best].min())
    assert own < least and f"Below {quantity(2e-5 * own / least, 'mm3/(N m)')} it lasts long enough" in said
    missed = search(factors, base, goals={LIFE: "max"}, analysis={"target": {"min": 1e9}})
    said = " ".join(one.text for one in optimum_sentences(missed))
    assert said.startswith("None. None of the ") and "Measure" not in said and "long enough" not in said


@pytest.mark.slow
def test_sampled_goals_have_their_interval_beside_them():
    """The binomial intervals, from the rows of the recommended design."""
    factors = DRAWN | {"axis_distance": {"uniform": [15, 28]}}
    base = {"roller_profile_radius": -7.0, **STEEL}
    keys = {"samples": 32, "outputs": ["forces", "peak_stress", "life"]}
    goals = {"b10(pair_life_hours)": "max"}
    results = search(factors, base, goals=goals, **keys)
    best = json.loads(results.data.attrs["optimum"])["recommended"]
    lives = np.sort(np.where(results.valid, results.data["pair_life_hours"].values, 0.0).reshape(-1, 32)[best])
    ranks = [int(stats.binom.ppf(p, 32, 0.1)) for p in (0.025, 0.975)]
    ends = lives[max(0, ranks[0] - 1)], lives[ranks[1]]
    said = optimum_sentences(results)[0].text
    assert f" (95 % interval {rounded(ends[0])} to {rounded(ends[1])})" in said

    least = float(np.median(results.data["pair_life_hours"].values))
    goals = {"probability(pair_life_hours)": "max", "axis_distance": "min"}
    target = {"target": {"pair_life_hours": {"min": least}}}
    results = search(factors, base, goals=goals, analysis=target, **keys)
    found = json.loads(results.data.attrs["optimum"])
    hits = int((results.data["pair_life_hours"].values.reshape(-1, 32)[found["recommended"]] >= least).sum())
    exact = stats.binomtest(hits, 32).proportion_ci(method="exact")
    assert f"{100 * hits / 32:.0f} % (95 % interval {100 * exact.low:.0f} % to {100 * exact.high:.0f} %)" in (
        " ".join(one.text for one in optimum_sentences(results))
    )
    best = next(one for one in found["optima"] if one["design"] == found["recommended"])
    rows = {row[0]: row[2:] for row in steps_table(results).rows}
    assert rows.pop("Recommended") == [percent(best["values"][0]), best["values"][1]]
    assert list(rows.values()) == [[percent(one["values"][0]), one["values"][1]] for one in found["neighbours"]]


@pytest.mark.slow
def test_steps_around_a_recommended_design_are_those_of_solved_rollers():
    """Each neighbour is solved once more as a roller of its own, with the smallest life that is allowed as target."""
    base = STEEL | {"radial_force": -120, "axis_distance": 22}
    factors = {"roller_profile_radius": {"uniform": [-7.5, -6.5]}, "friction_coefficient": {"values": [0.05, 0.2]}}
    keys = {"goals": {"max_pressure": "min"}, "outputs": ["forces", "contact", "peak_stress", "life"]}
    results = search(factors, base, analysis={"target": {"pair_life_hours": {"min": 1}}}, **keys)
    table = steps_table(results)
    assert list(table.heads) == [
        "Design",
        "Surely meets the target",
        "Holds in",
        "Largest contact pressure at the worst condition [MPa]",
        "Life of the pair, shortest [h]",
    ]
    own = json.loads(results.data.attrs["optimum"])["recommended"]
    radius = float(results.table["roller_profile_radius"][2 * own])
    assert table.rows[0][0] == "Recommended" and len(table.rows) > 1
    for name, met, valid, pressure, life in table.rows:
        step = 0.0 if name == "Recommended" else float(name.split()[-2].replace("−", "-"))
        solved = [
            tr.solve(
                tr.Case(**BASE | base | {"friction_coefficient": friction, "roller_profile_radius": radius + step}),
                contact_model="sliding",
                accuracy="preview",
                outputs=keys["outputs"],
            )
            for friction in (0.05, 0.2)
        ]
        assert pressure == pytest.approx(max(float(ds["max_pressure"].max()) for ds in solved), rel=1e-6)
        least = min(float(ds["pair_life_hours"]) for ds in solved)
        assert life == pytest.approx(least, rel=1e-6)
        assert (met, valid) == ("yes" if least >= 1 else "no", "2 of 2")
