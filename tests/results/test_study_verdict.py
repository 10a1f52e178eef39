"""The verdict of a study: each rule on hand-made lives, against loops over the raw rows."""

import dataclasses
import functools
import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import trackroller as tr
from trackroller.parameters import REGIMES
from trackroller.results.verdict import verdict_of
from trackroller.roller.requirement import checked_requirement
from trackroller.study.file.load import parse_study

LIFE = "pair_life_to_first_limit_hours"
STEEL, POM, ALUMINIUM = "1.7225-normalised", "POM", "EN AW-7075"
PAIRS = [[STEEL, STEEL], [POM, STEEL], [ALUMINIUM, STEEL]]
GIVEN = {"radial_force": -90, "axial_force": 5, "guide_overrollings_per_hour": 600, "motor_force": 0}
OUTPUTS = ["forces", "contact", "peak_stress", "life", "wear", "limits"]


@functools.cache
def solved(pairs=3, radii=2, frictions=3, left_out="", places=()):
    """Return a grid of materials, grooves and friction coefficients, solved with full sliding."""
    factors = {
        "material_pair": {"values": PAIRS[:pairs]},
        "roller_profile_radius": {"values": [-6.4 - 0.4 * i for i in range(radii)]},
        "friction_coefficient": {"values": [0.05 + 0.1 * i for i in range(frictions)]},
    }
    base = {name: value for name, value in GIVEN.items() if name != left_out} | {"permissible_wear_depth": 0.1}
    study = {"name": "made", "base": base, "factors": factors, "outputs": OUTPUTS}
    if places:
        factors["placeholder_position"] = {"values": list(places)}
    return tr.run(parse_study(study | {"contact_model": "sliding", "accuracy": "preview"}), progress=False)


def made(low, high=None, target=None, error=0.0, limit="fatigue", regime=None, flags=None, results=None, **data):
    """Return results with these lives by material, groove and friction; `low` alone has no range."""
    low = np.asarray(low, dtype=float)
    results = solved(*low.shape) if results is None else results
    ds, dims = results.data.drop_vars("limit_state"), results.dims  # `with_states` sets it
    shape = tuple(ds.sizes[d] for d in dims)  # a factor of one level is no dimension
    low, high = low.reshape(shape), None if high is None else np.asarray(high, dtype=float).reshape(shape)
    regime, flags = (None if values is None else np.reshape(values, shape) for values in (regime, flags))
    known = ds["limiting_mechanism"].attrs["flag_meanings"].split()
    high = low if high is None else high
    values = {LIFE: (low + high) / 2, f"{LIFE}_low": low, f"{LIFE}_high": high}
    values["regime"] = np.zeros(low.shape, np.int8) if regime is None else regime
    values["validity"] = np.zeros(low.shape, np.int32) if flags is None else flags
    values["converged"] = np.ones(low.shape, np.int8)
    ds = ds.assign({name: (dims, value, ds[name].attrs if name in ds else {}) for name, value in values.items()})
    two = np.stack([low, 2 * low], axis=-1)
    for name, value in (
        ("life_to_first_limit_hours", two),
        ("limiting_mechanism", np.full(two.shape, known.index(limit), np.int8)),
        ("validity_body", np.zeros(two.shape, np.int32)),
    ):
        ds = ds.assign({name: ((*dims, "body"), value, ds[name].attrs)})
    checked = np.isfinite(ds["life_hours_by_limit"].transpose(*dims, "limit", "body").values)
    for end, hours in (("", values[LIFE]), ("_low", low), ("_high", high)):  # by this limit alone, the guide later
        name = f"life_hours_by_limit{end}"
        own = np.where(checked, 1e12, np.nan)
        own[..., ds["limit"].values.tolist().index(limit), :] = np.stack([hours, 2 * hours], axis=-1)
        ds = ds.assign({name: ((*dims, "limit", "body"), own, ds["life_hours_by_limit"].attrs)})
    wide = ds["life_error_estimate"].transpose(*dims, "contact", "body")
    error = np.broadcast_to(np.asarray(error, dtype=float), low.shape)[..., None, None] + np.zeros(wide.shape)
    ds = ds.assign(life_error_estimate=(wide.dims, error), **data)
    config = results.config
    if target is not None:
        config = config.model_copy(update={"requirement": checked_requirement(target)})
    study = dataclasses.replace(results.study, config=config)
    return dataclasses.replace(results, study=study, data=ds)


def names(found):
    """Return the numbers of the candidates that a verdict names; candidates count in the order of the grid."""
    return [one.number for one in found.best]


def flag(results, name):
    """Return the bit of a validity flag."""
    return 1 << results.data["validity"].attrs["flag_meanings"].split().index(name)


def code(name):
    """Return the number of a regime."""
    return REGIMES.index(name)


# each kind of verdict


def test_one_unbeaten_candidate_is_built_and_the_next_is_the_next_by_the_same_measure():
    lives = [[[900, 400, 300], [120, 800, 900]], [[250, 260, 270], [10, 20, 30]], [[5, 6, 7], [8, 9, 9]]]
    found = made(lives).verdict
    assert found.kind == "build" and names(found) == [0] and found.best[0].low == 300
    assert found.next.number == 2 and found.next.low == 250  # not the groove with the longer median
    assert found.best[0].case == 2 and found.best[0].ends == "fatigue" and found.best[0].body == "roller"
    assert found.best[0].choices["roller_profile_radius"] == -6.4 and found.best[0].median == 400
    assert [one.low for one in found.candidates] == [300, 250, 120, 10, 8, 5]
    assert {"bearing", "heat"} == set(found.not_checked)


def test_a_lead_within_the_error_is_a_or_b_and_beyond_it_a_build():
    lives = np.array([[[102.4, 500, 500], [100, 900, 900]]] * 3) * np.array([1, 0.1, 0.1])[:, None, None]
    for error, kind in ((0.07, "a_or_b"), (0.01, "build")):
        found = made(lives, error=error).verdict
        assert found.kind == kind and found.why == ("error" if kind == "a_or_b" else "")
        assert names(found) == ([0, 1] if kind == "a_or_b" else [0])
    assert found.best[0].error == 0.01
    both = math.hypot(0.01, 0.02)
    errors = np.array([0.01, 0.02, 0.0])[:, None, None] + np.zeros(lives.shape)
    for lead, kind in ((1 + 1.01 * both, "build"), (1 + 0.99 * both, "a_or_b")):
        pairs = np.array([[[100 * lead] * 3, [1] * 3], [[100] * 3, [1] * 3], [[1] * 3, [1] * 3]])
        assert made(pairs, error=errors).verdict.kind == kind


def test_nine_ties_are_all_named():
    found = made(np.full((3, 3, 2), 77.0)).verdict
    assert found.kind == "a_or_b" and found.why == "tie" and sorted(names(found)) == list(range(9))
    assert found.next is None


def test_a_target_builds_the_best_that_meets_it_and_judges_by_the_life_to_the_first_limit():
    lives = [[[900, 400, 300], [120, 800, 900]], [[250, 260, 270], [10, 20, 30]], [[5, 6, 7], [8, 9, 9]]]
    for name in (LIFE, "pair_life_hours", "roller_life_hours"):  # fatigue alone lasts longer, and does not count
        found = made(lives, target={name: {"min": 200}}).verdict
        assert found.kind == "build" and names(found) == [0] and found.required == 200
        assert [one.status for one in found.candidates] == ["met", "met", "missed", "missed", "missed", "missed"]
        assert found.next.number == 2


def test_none_names_the_candidate_that_meets_the_target_in_most_conditions():
    """Met in two of three conditions before one in three, although the latter has the longer worst life."""
    lives = [[[10, 400, 300], [50, 60, 900]], [[40, 45, 50], [1, 2, 3]], [[5, 6, 7], [8, 9, 9]]]
    found = made(lives, target={LIFE: {"min": 200}}).verdict
    assert found.kind == "none" and found.candidates[0].number == 0
    assert (found.candidates[0].met, found.candidates[0].conditions) == (2, 3)
    assert found.candidates[1].number == 1 and found.candidates[1].met == 1
    assert found.fails.count == 1 and found.fails.reasons == {"fatigue": 1}
    assert dict(found.fails.where[0]) == {"friction_coefficient": (0.05,)}


def test_an_open_target_asks_for_the_wear_coefficient_at_which_it_turns():
    """POM on steel: 3e-7 to 1e-5; at its high end it lasts 50 h, and wear is inversely proportional."""
    low = np.array([[[5.0] * 3, [4.0] * 3], [[50.0] * 3, [40.0] * 3], [[1.0] * 3, [1.0] * 3]])
    found = made(low, low * [[[10.0]], [[30.0]], [[10.0]]], target={LIFE: {"min": 200}}, limit="wear").verdict
    assert found.kind == "measure" and names(found) == [2] and found.best[0].status == "open"
    turn = found.turns[0]
    assert (turn.what, turn.of, turn.on, turn.units) == ("wear_coefficient", POM, STEEL, "mm3/(N m)")
    assert (turn.low, turn.high) == (3e-7, 1e-5) and turn.value == pytest.approx(1e-5 * 50 / 200)
    assert made(low, low * 30, target={LIFE: {"min": 2000}}, limit="wear").verdict.kind == "none"


def test_ranges_of_other_materials_that_overlap_ask_for_the_wider_one():
    low = np.array([[[10.0] * 3, [8.0] * 3], [[50.0] * 3, [40.0] * 3], [[1.0] * 3, [1.0] * 3]])
    high = low * [[[10.0]], [[1.6]], [[10.0]]]
    found = made(low, high, limit="wear").verdict
    assert found.kind == "measure" and found.why == "range" and sorted(names(found)) == [0, 2]
    turn = found.turns[0]
    assert turn.of == STEEL and turn.candidate == 0 and (turn.low, turn.high) == (1e-5, 1e-4)
    assert turn.value == pytest.approx(1e-4 * 10 / 80) and turn.until == pytest.approx(1e-4 * 10 / 50)
    apart = made(low, np.minimum(high, 49.0 + 40 * (low >= 40)), limit="wear").verdict
    assert apart.kind == "build" and names(apart) == [2]


def test_candidates_of_the_same_materials_are_compared_at_equal_ends():
    """Both grooves of steel span a decade, and one is better at both ends."""
    low = np.array([[[10.0] * 3, [8.0] * 3], [[1.0] * 3, [1.0] * 3], [[1.0] * 3, [1.0] * 3]])
    high = low * [[[100.0]], [[2.0]], [[2.0]]]
    found = made(low, high).verdict
    assert found.kind == "build" and names(found) == [0] and found.next.high == 800
    crossed = made(low, np.where(low == 10, 700.0, high)).verdict
    assert crossed.kind == "measure" and sorted(names(crossed)) == [0, 1]


def test_a_candidate_that_is_not_met_in_one_condition_is_not_built():
    """The longest life everywhere else, but it skids, lifts off, breaks, yields or misses a constraint once."""
    lives = np.array([[[900, 900, 900], [100, 110, 120]], [[5, 6, 7], [8, 9, 9]], [[5, 6, 7], [8, 9, 9]]], float)
    results, once = solved(*lives.shape), np.zeros(lives.shape, int)
    once[0, 0, 1] = 1
    for word, changes in {
        "skids": {"regime": once * code("full_slip")},
        "lifts off": {"regime": once * code("lift_off")},
        "breaks": {"flags": once * flag(results, "static")},
        "yields": {"flags": once * flag(results, "yield")},
    }.items():
        found = made(lives, **changes).verdict
        assert found.kind == "build" and names(found) == [1] and found.best[0].low == 100
        lost = next(one for one in found.candidates if one.number == 0)
        assert (lost.low, lost.high, lost.ends, lost.met, lost.conditions) == (0, 0, word, 2, 3)


def test_a_candidate_that_is_not_judged_is_set_aside_with_what_it_would_last():
    lives = np.array([[[900, 800, 900], [100, 110, 120]], [[5, 6, 7], [8, 9, 9]], [[5, 6, 7], [8, 9, 9]]], float)
    results, flags = solved(*lives.shape), np.zeros(lives.shape, int)
    flags[0, 0] = flag(results, "half_space")
    found = made(lives, flags=flags).verdict
    assert found.kind == "build" and names(found) == [1]
    aside = found.not_judged
    assert [one.number for one in aside] == [0] and (aside[0].low, aside[0].high) == (0, math.inf)
    assert aside[0].holds == 800 and aside[0].ends == "outside the half-space"
    flags[0, 0, 0] = 0  # now one condition bounds its life
    lives[0, 0, 0] = 50
    found = made(lives, flags=flags).verdict
    assert found.not_judged == () and next(one for one in found.candidates if one.number == 0).high == 50
    flags[:] = flag(results, "conformal")
    found = made(lives, flags=flags).verdict
    assert (found.kind, found.why) == ("cannot_tell", "model") and names(made(lives).verdict) == [1]


def test_a_condition_without_any_candidate_is_left_out_of_the_ranking_but_not_of_the_target():
    lives = np.array([[[900, 1, 300], [100, 1, 120]], [[500, 1, 70], [8, 1, 9]], [[5, 1, 7], [8, 1, 9]]], float)
    regime = np.zeros(lives.shape, int)
    regime[:, :, 1] = code("lift_off")
    found = made(lives, regime=regime).verdict
    assert found.kind == "build" and found.best[0].low == 300
    assert (found.best[0].met, found.best[0].conditions) == (2, 2)
    out = found.out_of_reach
    assert (out.count, out.of, dict(out.reasons)) == (1, 3, {"lifts off": 6})
    assert dict(out.where[0]) == {"friction_coefficient": (0.15,)}
    missed = made(lives, regime=regime, target={LIFE: {"min": 200}}).verdict
    assert missed.kind == "none" and (missed.candidates[0].met, missed.candidates[0].conditions) == (2, 3)
    assert missed.fails.reasons == {"lifts off": 1}


def test_a_value_that_was_not_given_is_asked_for_where_it_decides():
    """Lift-off at the paper's axial force: with a target always, without one from half of the conditions on."""
    results = solved(3, 2, 3, "axial_force")
    lives = np.array([[[900, 1, 300], [100, 1, 120]], [[500, 1, 70], [8, 1, 9]], [[5, 1, 7], [8, 1, 9]]], float)
    regime = np.zeros(lives.shape, int)
    regime[:, :, 1] = code("lift_off")
    found = made(lives, regime=regime, target={LIFE: {"min": 200}}, results=results).verdict
    assert found.kind == "give" and [turn.what for turn in found.turns] == ["axial_force"] and found.turns[0].low == 30
    assert found.rest.kind == "build" and found.rest.best[0].low == 300 and found.rest.best[0].status == "met"
    aside = made(lives, regime=regime, results=results).verdict
    assert aside.kind == "build" and dict(aside.out_of_reach.not_given) == {"axial_force": 30}
    regime[:, :, 0] = code("lift_off")  # two of three
    found = made(lives, regime=regime, results=results).verdict
    assert found.kind == "give" and (found.out_of_reach.count, found.out_of_reach.of) == (2, 3)
    assert made(lives, regime=regime).verdict.kind == "build"  # the axial force was given there
    regime[:] = code("lift_off")
    assert made(lives, regime=regime).verdict.kind == "none"


# limits without hours, and columns that a study of another version lacks


def with_states(results, state):
    """Return results in which the shakedown limit has a state in all cases of the first material."""
    words = "unknown kept open exceeded".split()
    ds = results.data
    shape = (*(ds.sizes[d] for d in results.dims), ds.sizes["limit"], 2)
    values = np.full(shape, words.index("kept"), np.int8)
    values[0, ..., ds["limit"].values.tolist().index("static"), 0] = words.index(state)
    attrs = {"flag_values": np.arange(4, dtype=np.int8), "flag_meanings": " ".join(words)}
    return dataclasses.replace(results, data=ds.assign(limit_state=((*results.dims, "limit", "body"), values, attrs)))


def test_an_exceeded_limit_is_not_met_and_an_open_one_asks_for_its_value():
    lives = [[[900, 400, 300], [120, 800, 900]], [[250, 260, 270], [10, 20, 30]], [[5, 6, 7], [8, 9, 9]]]
    found = with_states(made(lives), "exceeded").verdict
    assert names(found) == [2] and found.candidates[-1].ends == "limit static"
    found = with_states(made(lives), "open").verdict
    assert found.kind == "build" and names(found) == [0] and found.best[0].open_limits == ("static",)
    found = with_states(made(lives, target={LIFE: {"min": 200}}), "open").verdict
    assert found.kind == "build" and names(found) == [2]  # it meets the target for certain
    found = with_states(made(lives, target={LIFE: {"min": 280}}), "open").verdict
    assert found.kind == "measure" and names(found) == [0] and found.turns[0].of == STEEL
    assert names(with_states(made(lives), "kept").verdict) == [0]


def test_a_study_of_fatigue_or_of_stress_alone_has_a_verdict_too():
    ds = solved(3, 2, 3)
    without = ds.data.drop_vars([n for n in ds.data if "limit" in str(n) or "limit" in ds.data[n].dims])
    found = dataclasses.replace(ds, data=without).verdict
    assert found.goal[0] == "pair_life_hours" and {"wear", "bearing", "shakedown", "heat"} == set(found.not_checked)
    rows = ds.table.groupby(["material_pair", "roller_profile_radius"], sort=False).pair_life_hours.min()
    good = [one for one in found.candidates if one.judged and one.low > 0]
    assert good and all(one.low == rows.iloc[one.number] for one in good)
    lives = [n for n in without if "life" in str(n) or n in ("first_to_fail",)]
    found = dataclasses.replace(ds, data=without.drop_vars(lives)).verdict
    largest = ds.table.groupby(["material_pair", "roller_profile_radius"], sort=False).peak_stress_roller.max()
    assert (found.goal[0], found.kind, found.why) == ("peak_stress_roller", "cannot_tell", "materials")
    good = [one for one in found.candidates if one.judged and np.isfinite(one.low)]
    assert all(one.low == pytest.approx(largest.iloc[one.number]) for one in good)
    assert found.best[0].low == min(one.low for one in good)


# sampled conditions, and rows that do not repeat


SAMPLE = {
    "name": "sampled",
    "design": "inner_outer",
    "samples": 64,
    "seed": 3,
    "base": {name: value for name, value in GIVEN.items() if name != "radial_force"},
    "factors": {
        "roller_profile_radius": {"values": [-6.5, -6.6, -8]},
        "friction_coefficient": {"uniform": [0.05, 0.3]},
        "radial_force": {"uniform": [-120, -60]},
    },
    "outputs": ["forces", "contact", "peak_stress", "life"],
    "contact_model": "sliding",
    "accuracy": "preview",
}


@functools.cache
def sample():
    """Return a sampled study."""
    return tr.run(parse_study(SAMPLE), progress=False)


def test_sampled_conditions_are_judged_by_the_life_that_nine_of_ten_reach():
    results = sample()
    found, table = results.verdict, results.table
    assert found.sampled and found.kind == "build"
    for one in found.candidates:
        own = np.sort(table.pair_life_hours[table.roller_profile_radius == one.choices["roller_profile_radius"]])
        assert one.low == own[math.ceil(0.1 * len(own)) - 1] and one.interval[0] <= one.low <= one.interval[1]
        assert table.pair_life_hours[one.case] == one.low
    assert found.best[0].choices["roller_profile_radius"] == -6.5  # better in every condition: its lead is no chance
    assert (table.pair_life_hours[:64].to_numpy() > table.pair_life_hours[64:128].to_numpy()).all()
    shuffled = results.data["pair_life_hours"].values.copy()
    shuffled[64:128] = 1.02 * np.random.default_rng(1).permutation(shuffled[:64])
    mixed = dataclasses.replace(results, data=results.data.assign(pair_life_hours=("case", shuffled)))
    assert mixed.verdict.kind == "a_or_b" and len(mixed.verdict.best) == 2  # 2 % by chance of the sample


def test_rows_that_do_not_repeat_cannot_tell_or_are_the_best_of_those_that_were_tried():
    factors = SAMPLE["factors"] | {"roller_profile_radius": {"uniform": [-8, -6.5]}}
    found = tr.run(parse_study(SAMPLE | {"design": "lhs", "samples": 40, "factors": factors}), progress=False).verdict
    assert (found.kind, found.why, found.candidates) == ("cannot_tell", "conditions", ())
    alone = {"roller_profile_radius": {"uniform": [-8, -6.5]}}
    results = tr.run(parse_study(SAMPLE | {"design": "lhs", "samples": 40, "factors": alone}), progress=False)
    found = results.verdict
    assert (
        found.tried == 40
        and found.kind in ("build", "a_or_b")
        and found.best[0].low == results.table.pair_life_hours.max()
    )
    forgotten = {name: value for name, value in SAMPLE["base"].items() if name != "axial_force"}
    light = factors | {"radial_force": {"uniform": [-50, -20]}}
    changes = {"design": "lhs", "samples": 40, "factors": light, "base": forgotten}
    lifted = tr.run(parse_study(SAMPLE | changes), progress=False)
    assert (lifted.regime == code("lift_off")).mean() > 0.5
    assert lifted.verdict.kind == "give" and lifted.verdict.turns[0].what == "axial_force"


@pytest.mark.slow
def test_the_places_of_placeholders_span_the_range_and_are_no_conditions():
    """A factor at three places: the same verdict as with the columns of both ends."""
    results = solved(3, 2, 2, "", (-1, 0, 1))
    low = np.array([[[10.0] * 2, [8.0] * 2], [[50.0] * 2, [40.0] * 2], [[1.0] * 2, [1.0] * 2]])
    high = low * [[[10.0]], [[1.6]], [[10.0]]]
    lives = np.stack([low, (low + high) / 2, high], axis=-1)
    found = made(lives, limit="wear", results=results).verdict
    columns = made(low, high, limit="wear").verdict
    for one, other in ((found, columns), (made(lives[..., :], results=results).verdict, made(low, high).verdict)):
        assert (one.kind, names(one)) == (other.kind, names(other)) == ("measure", names(found))
        assert [(c.low, c.high, c.met, c.conditions) for c in one.candidates] == [
            (c.low, c.high, c.met, c.conditions) for c in other.candidates
        ]
    assert found.turns == columns.turns and np.isfinite(found.turns[0].value)
    for least, kind in ((45, "build"), (70, "measure"), (101, "none")):
        target = {LIFE: {"min": least}}
        assert made(lives, target=target, results=results).verdict.kind == kind
        assert made(low, high, target=target).verdict.kind == kind


# against brute force


CASES = st.lists(st.tuples(st.integers(1, 9), st.integers(0, 3), st.sampled_from("jjjjjjsu")), min_size=18, max_size=18)


def brute(table):
    """Return intervals, conditions out of reach and unbeaten candidates by loops; `table[pair][groove][friction]`."""
    keys = list(itertools.product(range(3), range(2)))
    of = {key: [table[key[0]][key[1]][c] for c in range(3)] for key in keys}
    ends = {
        key: [(0, 0) if kind == "s" else (0, math.inf) if kind == "u" else (low, low + more) for low, more, kind in own]
        for key, own in of.items()
    }
    reached = [c for c in range(3) if any(0 < ends[key][c][1] < math.inf for key in keys)]
    reach = reached or [0, 1, 2]
    span = {key: tuple(min((own[c][i] for c in reach), default=0) for i in (0, 1)) for key, own in ends.items()}
    judged = [key for key in keys if all(of[key][c][2] != "u" for c in reach) and span[key][1] > 0]
    unbeaten = []
    for key in judged:
        beaten = False
        for other in judged:
            if other[0] == key[0]:
                better = all(a >= b for a, b in zip(span[other], span[key], strict=True)) and span[other] != span[key]
            else:
                better = span[other][0] > span[key][1]
            beaten |= other != key and better
        if not beaten:
            unbeaten.append(keys.index(key))
    return span, unbeaten, keys, reached


def arrays(rows):
    """Return lives, high ends, regimes and flags of a random table."""
    results = solved(3, 2, 3)
    shape = (3, 2, 3)
    low = np.array([row[0] for row in rows], float).reshape(shape)
    more = np.array([row[1] for row in rows], float).reshape(shape)
    kinds = np.array([row[2] for row in rows]).reshape(shape)
    regime = np.where(kinds == "s", code("full_slip"), 0)
    flags = np.where(kinds == "u", flag(results, "half_space"), 0)
    return (
        low,
        low + more,
        regime,
        flags,
        [[[rows[6 * i + 3 * j + k] for k in range(3)] for j in range(2)] for i in range(3)],
    )


@pytest.mark.slow
@settings(max_examples=25, deadline=None)
@given(CASES)
def test_intervals_and_unbeaten_candidates_against_loops(rows):
    low, high, regime, flags, table = arrays(rows)
    found = verdict_of(made(low, high, regime=regime, flags=flags))
    span, unbeaten, keys, reached = brute(table)
    for one in found.candidates:
        assert (one.low, one.high) == span[keys[one.number]]
    assert (found.out_of_reach.count if found.out_of_reach else 0) == 3 - len(reached)
    if unbeaten:
        assert sorted(names(found)) == unbeaten
        alike = len({span[keys[i]] for i in unbeaten}) == 1
        assert found.kind == ("build" if len(unbeaten) == 1 else "a_or_b" if alike else "measure")
    else:
        assert found.kind == ("cannot_tell" if any(high > 0 for _, high in span.values()) else "none")


@pytest.mark.slow
@settings(max_examples=25, deadline=None)
@given(CASES, st.integers(2, 9))
def test_targets_against_loops(rows, least):
    low, high, regime, flags, table = arrays(rows)
    found = verdict_of(made(low, high, regime=regime, flags=flags, target={LIFE: {"min": least}}))
    status = {}
    for number, (pair, groove) in enumerate(itertools.product(range(3), range(2))):
        words = []
        for life, more, kind in table[pair][groove]:
            if kind == "s":
                words.append("missed")
            elif kind == "u":
                words.append("open")
            else:
                words.append("met" if life >= least else "open" if life + more >= least else "missed")
        status[number] = "missed" if "missed" in words else "open" if "open" in words else "met"
        one = next(one for one in found.candidates if one.number == number)
        assert one.status == status[number] and (one.met, one.conditions) == (words.count("met"), 3)
    met = [number for number, word in status.items() if word == "met"]
    opened = [number for number, word in status.items() if word == "open"]
    by_range = [n for n in opened if all(kind != "u" for _, _, kind in table[n // 2][n % 2])]
    if met:
        worst = {n: min(life for life, _, _ in table[n // 2][n % 2]) for n in met}
        assert sorted(names(found)) == [n for n in met if worst[n] == max(worst.values())]
        assert found.kind == ("build" if len(found.best) == 1 else "a_or_b")
    else:
        assert found.kind == ("measure" if by_range else "cannot_tell" if opened else "none")
    if found.kind == "none":
        first = found.candidates[0]
        assert first.met == max(one.met for one in found.candidates)


def aimed(results, hours=None, **more):
    """Return results whose study asks for a life of the pair, or has other keys."""
    config = results.config.model_copy(update=more)
    if hours is not None:
        target = {results.life[0]: {"min": hours}}
        config = config.model_copy(update={"requirement": checked_requirement(target)})
    return dataclasses.replace(results, study=dataclasses.replace(results.study, config=config))


def test_a_target_within_the_interval_of_a_sample_cannot_be_told():
    results = sample()
    best = results.verdict.best[0]
    low, high = best.interval
    assert low < best.low < high
    for hours, kind, why in (
        (0.9 * low, "build", ""),
        ((low + best.low) / 2, "cannot_tell", "sample"),
        ((best.low + high) / 2, "cannot_tell", "sample"),
        (1.1 * high, "none", ""),
    ):
        found = aimed(results, hours).verdict
        assert (found.kind, found.why) == (kind, why)
        assert found.candidates[0].choices == best.choices
