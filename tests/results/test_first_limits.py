"""The first limit of the pair: which one, over which factors, and what it does to the order of the designs."""

import numpy as np
import pandas as pd
import pytest

import trackroller as tr
from trackroller.damage import LIMITS
from trackroller.report.explorer.rows import collect
from trackroller.results.first_limits import deciding, first_limit, reached_by_body
from trackroller.study.file.load import parse_study

STUDY = {
    "name": "limits",
    "base": {"radial_force": -60, "axial_force": 5, "guide_overrollings_per_hour": 600, "motor_force": 0}
    | {"permissible_wear_depth": 0.3},
    "factors": {
        "material_pair": {"values": [["1.7225-normalised"] * 2, ["EN AW-7075", "1.7225-normalised"]]},
        "roller_profile_radius": {"values": [-6.3, -6.6, -7]},
        "friction_coefficient": {"values": [0.05, 0.2, 0.4]},
    },
    "contact_model": "sliding",
    "accuracy": "preview",
    "outputs": ["forces", "contact", "peak_stress", "life", "rating", "limits"],
}
TARGET = {"analysis": {"target": {"min": 50}}}
FACTORS = list(STUDY["factors"])


@pytest.fixture(scope="module")
def solved():
    return tr.run(parse_study(STUDY), progress=False)


@pytest.fixture(scope="module")
def rows(solved):
    """Return hours by case, limit and body, from utilisations and lives alone, and the lives by the S-N curve."""
    ds = solved.data
    stacked = ds[["life_hours_by_limit", "utilisation", "pair_life_hours", "pair_life_to_first_limit_hours"]]
    stacked = stacked.stack(row=FACTORS)
    hours, used = (stacked[n].transpose("row", "limit", "body").values for n in ("life_hours_by_limit", "utilisation"))
    names = ds["limit"].values.tolist()
    reached = np.where(np.isnan(hours), np.inf, hours)
    reached[:, names.index("rating")] = np.inf  # a second model of the fatigue
    reached[:, names.index("static")] = np.where(used[:, names.index("static")] > 1, 0.0, np.inf)  # breaks at once
    return reached, stacked["pair_life_hours"].values, stacked["pair_life_to_first_limit_hours"].values


def test_the_pair_ends_with_the_first_limit_of_either_body(solved, rows):
    reached, _, pair = rows
    assert np.allclose(pair, reached.min(axis=(1, 2)), rtol=1e-12)
    results = solved
    names = solved.data["limit"].values
    expected = [names[np.unravel_index(one.argmin(), one.shape)[0]] for one in reached]
    assert first_limit(results).tolist() == expected and len(set(expected)) > 1


def test_a_life_that_is_not_known_is_no_first_limit():
    """Above its fatigue limit a guide without a number of overrollings does not fail at once."""
    base = {key: value for key, value in STUDY["base"].items() if key != "guide_overrollings_per_hour"}
    unknown = tr.run(parse_study(STUDY | {"base": base | {"radial_force": -200}}), progress=False)
    used = unknown.data["utilisation"].sel(limit="fatigue", body="guide")
    assert (used > 1).any() and unknown.data["life_hours_by_limit"].sel(body="guide").isnull().all()
    pair = unknown.column("pair_life_to_first_limit_hours")
    np.testing.assert_allclose(reached_by_body(unknown).min(axis=(1, 2)), pair, rtol=1e-12)


def test_designs_are_ranked_by_the_first_limit(solved, rows):
    _, fatigue, pair = rows
    results, designs = solved, solved.candidates()
    assert designs.goal[0] == "pair_life_to_first_limit_hours"
    low = results.data["pair_life_to_first_limit_hours_low"].stack(row=FACTORS).values  # the low ends rank
    frame = pd.DataFrame({n: results.table[n] for n in FACTORS[:2]}).assign(first=pair, low=low, fatigue=fatigue)
    worst = frame.groupby(FACTORS[:2], sort=False)[["first", "low", "fatigue"]].min()
    best = designs.table.iloc[0]
    own = tuple(best[n] for n in FACTORS[:2])
    assert worst["low"].idxmax() == own and best["worst"] == worst["first"].loc[own]


def test_the_factors_that_decide_the_limit_carry_its_information(solved):
    """A factor that changes no first limit is left out; the strongest one splits the limits best."""
    results = solved
    table = results.table
    made = np.where((table["friction_coefficient"] > 0.1) & (table["roller_profile_radius"] < -6.5), "rating", "heat")
    assert set(deciding(results, made.astype(object))) == {"friction_coefficient", "roller_profile_radius"}
    alone = np.where(table["material_pair"].str.startswith("EN"), "rating", "heat").astype(object)
    assert deciding(results, alone) == ["material_pair"]


def test_results_of_limits_serve_as_goals_constraints_targets_and_outputs(solved):
    """A limit and a body choose one number a case; the limits not asked for are unknown names."""
    used = {"utilisation_guide_rating": "min", "pair_life_to_first_limit_hours": "max"}
    stacked = solved.data["utilisation"].sel(limit="rating", body="guide").stack(row=FACTORS).values
    middle = float(np.median(stacked))
    more = {
        "pareto": used,
        "constraints": [f"utilisation_guide_rating < {middle}"],
        "analysis": {
            "target": {"utilisation_guide_rating": {"max": middle}},
            "outputs": ["life_hours_by_limit_roller_fatigue"],
        },
    }
    found = tr.run(parse_study(STUDY | more), progress=False)
    assert found.allowed.tolist() == (stacked < middle).tolist()
    indices = found.indices()
    assert indices.output.values.tolist() == ["life_hours_by_limit_roller_fatigue"]
    assert float(indices.target_probability[0]) == pytest.approx(np.mean(stacked < middle))
    worst = (
        pd.DataFrame({n: solved.table[n] for n in FACTORS[:2]}).assign(used=stacked).groupby(FACTORS[:2])["used"].max()
    )
    front = found.pareto()
    for row in front.row.values:
        own = front.sel(row=row)
        place = (str(own["material_pair"].values), float(own["roller_profile_radius"]))
        assert float(own["utilisation_guide_rating"]) <= worst[place] * (1 + 1e-12)
    for name in ("utilisation_rating", "utilisation"):
        with pytest.raises(tr.InputError, match="pareto"):
            parse_study(STUDY | {"pareto": used | {name: "min"}})


def test_robust_designs_have_the_b10_and_the_worst_condition_of_the_first_limit():
    factors = {"roller_profile_radius": {"values": [-6.3, -7]}, "friction_coefficient": {"uniform": [0.05, 0.4]}}
    goals = {"b10(pair_life_to_first_limit_hours)": "max", "mean(utilisation_roller_rating)": "min"}
    study = tr.run(
        parse_study(STUDY | {"factors": factors, "method": "inner_outer", "samples": 16, "pareto": goals}),
        progress=False,
    )
    hours = study.column("pair_life_to_first_limit_hours").reshape(2, 16)
    by_point = study.robustness().sel(output="pair_life_to_first_limit_hours")
    assert by_point.b10.values.tolist() == np.sort(hours, axis=1)[:, 1].tolist()  # 10 % of 16: the second shortest
    assert study.best()["worst"].tolist() == sorted(hours.min(axis=1), reverse=True)
    front = study.pareto()
    used = study.data["utilisation"].sel(limit="rating", body="roller").values.reshape(2, 16).mean(axis=1)
    assert front["mean(utilisation_roller_rating)"].values == pytest.approx(used)


def test_the_explorer_colours_by_the_first_limit(solved):
    columns = {column.name: column for column in collect(solved)}
    pair = columns["limiting_mechanism"]
    assert [pair.texts[i] for i in pair.values] == [LIMITS[name].title for name in first_limit(solved)]
    for body in ("roller", "guide"):
        own = columns[f"limiting_mechanism_{body}"]
        flags = solved.column(f"limiting_mechanism_{body}").astype(int)
        assert own.role == "state" and [own.texts[i] for i in own.values] == [
            LIMITS[solved.limits[i]].title for i in flags
        ]
