"""What a report says of studies without lives: stresses of several materials, targets on forces, values not given."""

import functools

import numpy as np
import pytest

import trackroller as tr
from trackroller.report.words.cases import validity_table
from trackroller.report.words.designs import best_table, rows_table
from trackroller.report.words.limits import guesses
from trackroller.report.words.verdict import verdict_sentences

STEEL, ALUMINIUM = ["1.7225-quenched-tempered", "42CrMo4+QT-100"], ["EN AW-7075", "42CrMo4+QT-100"]
LOADS = {"radial_force": {"values": [-60, -120, -180]}, "friction_coefficient": {"values": [0.1, 0.2]}}
BASE = {"guide_curve_radius": 300, "motor_force": 0, "axial_force": 15}


@functools.cache
def _solved(pairs, outputs, target, base, angles):
    study = {"name": "made", "base": dict(base), "outputs": list(outputs), "contact_model": "sliding"}
    study |= {"accuracy": "preview", "analysis": {"target": {n: dict([end]) for n, end in target}}}
    choices = {"roller_profile_radius": {"values": [-6.3, -7.3]}}
    if angles:
        choices = {"contact_angle": {"values": list(angles)}}
    if pairs:
        choices["material_pair"] = {"values": [list(pair) for pair in pairs]}
    return tr.run(study | {"factors": choices | LOADS}, progress=False)


def solved(pairs=(STEEL, ALUMINIUM), outputs=("peak_stress",), target=None, base=BASE, angles=()):
    """Return a solved grid; `target` has one end for each output."""
    ends = tuple((name, next(iter(own.items()))) for name, own in (target or {}).items())
    return _solved(tuple(map(tuple, pairs)), outputs, ends, tuple(base.items()), angles)


def largest(results, name, by):
    """Return the largest value of an output by a factor, over all rows."""
    table = results.table.assign(value=np.abs(results.quantity(name)[0].astype(float)))
    return table.groupby(by, sort=False)["value"].max()


def row(table, head):
    """Return the cells of a row of a table."""
    return next(cells[1:] for cells in table.rows if str(cells[0]).startswith(head))


# stresses


def test_stresses_do_not_rank_materials():
    """A soft material always has the lower stress, and a shorter life."""
    results = solved()
    found, said = results.verdict, verdict_sentences(results)
    assert (found.kind, found.why) == ("cannot_tell", "materials")
    stress = largest(results, "peak_stress_roller", ["material_pair", "roller_profile_radius"])
    firsts = stress.groupby("material_pair").min()
    assert {one.choices["material_pair"]: one.low for one in found.best} == pytest.approx(firsts.to_dict())
    assert "Add life to `outputs`" in said[1].text and said[0].text == "Cannot tell."
    with pytest.raises(tr.InputError, match="Add life to outputs"):
        results.best()
    lives = solved(outputs=("peak_stress", "life"))
    assert lives.verdict.best[0].choices["material_pair"] == " / ".join(STEEL)  # not the one with the least stress
    assert firsts.idxmin() == " / ".join(ALUMINIUM)


def test_stresses_rank_grooves_of_one_material():
    results = solved(pairs=())
    stress = largest(results, "peak_stress_roller", "roller_profile_radius")
    found = results.verdict
    assert (found.kind, found.best[0].choices["roller_profile_radius"]) == ("build", stress.idxmin())
    assert found.best[0].low == pytest.approx(stress.min()) and len(results.best()) == 2


def test_a_target_that_one_material_meets_ranks_within_it():
    stress = largest(solved(), "peak_stress_roller", ["material_pair", "roller_profile_radius"])
    steel, soft = (stress[" / ".join(pair)].min() for pair in (STEEL, ALUMINIUM))
    assert soft < steel
    for least, kind in ((1.1 * soft, "build"), (1.1 * steel, "cannot_tell"), (0.5 * soft, "none")):
        results = solved(target={"peak_stress_roller": {"max": least}})
        assert results.verdict.kind == kind
        text = " ".join(one.text for one in verdict_sentences(results))
        if kind == "cannot_tell":
            assert f"{(stress <= least).sum()} meet the target of" in text
        if kind == "none":
            assert "misses the target" in text or "fails" not in text


def test_a_report_without_lives_says_nothing_of_life_rules_and_sn_lines():
    results, lives = solved(), solved(outputs=("peak_stress", "life"))
    assert results.flagged("deep_life").any()
    cells = [str(cell) for one in (results, lives) for row in getattr(validity_table(one), "rows", ()) for cell in row]
    assert sum("life_rule" in text for text in cells) == 2  # of roller and guide, with lives
    assert guesses(results) is None and "rolling-contact fatigue" in guesses(lives).text


# targets on forces


FORCE = "normal_force_1"


def on_force(least, outputs=("forces",)):
    """Return a study with a target on a force at three angles, and the number of conditions that each meets."""
    angles = (25, 35, 45)
    base = {"guide_curve_radius": 300, "motor_force": 0, "axial_force": 30}
    results = solved((), outputs, {FORCE: {"min": least}}, base, angles)
    force = results.quantity(FORCE)[0].astype(float)
    rolls = results.data["regime"].values.ravel() == 0
    met = results.table.assign(met=rolls & (force >= least)).groupby("contact_angle")["met"].sum()
    return results, met, force, rolls


def test_a_target_on_a_force_is_judged_by_the_conditions_that_meet_it():
    """None, the nearest by the conditions met; the best; or all that tie, without a life."""
    kinds = set()
    for least in (200.0, 15.0, 8.0, 1.0, 0.0):
        results, met, _, _ = on_force(least)
        found, enough = results.verdict, met.index[met == 6].tolist()
        kinds.add(found.kind)
        assert found.kind == ("none" if not enough else "build" if len(enough) == 1 else "a_or_b")
        if enough:
            assert sorted(one.choices["contact_angle"] for one in found.best) == enough
        else:
            assert found.candidates[0].met == met.max()
            more = (met == met.max()).sum() - 1  # no first of ties
            assert (f"(and {more} more)" in verdict_sentences(results)[1].text) == bool(more)
        assert [one.met for one in found.candidates] == sorted(met, reverse=True)
        text = " ".join(one.text for one in verdict_sentences(results))
        assert ("holds no lives and no stresses" in text) == bool(enough) and " lasts" not in text
        assert "MPa" not in text and "static failure" in text.partition("Not checked:")[2]
        shown = dict(zip(best_table(results).rows[0][1:], row(best_table(results), "Meets the targets"), strict=True))
        assert shown == {angle: f"{met[angle]} of 6" for angle in shown}
    assert kinds == {"none", "build", "a_or_b"}


def test_nine_of_ten_sampled_conditions_meet_a_target_on_a_force():
    """The best angle meets it in so many of 64 conditions; 59 and 62 of 64 leave nine of ten open."""
    factors = {"contact_angle": {"values": [25, 45]}, "radial_force": {"uniform": [-160, -60]}}
    study = {"name": "made", "design": "inner_outer", "samples": 64, "outputs": ["forces"], "contact_model": "sliding"}
    study |= {"base": {"guide_curve_radius": 300, "motor_force": 0, "friction_coefficient": 0.15}}
    study |= {"factors": factors | {"axial_force": {"uniform": [0, 40]}}, "accuracy": "preview"}
    kinds = []
    for least in (10.0, 20.0, 40.0):
        results = tr.run(study | {"analysis": {"target": {FORCE: {"min": least}}}}, progress=False)
        held = (results.data["regime"].values.ravel() == 0) & (results.quantity(FORCE)[0].astype(float) >= least)
        met = results.table.assign(met=held).groupby("contact_angle")["met"].sum()
        found = results.verdict
        first = found.candidates[0]
        assert (first.choices["contact_angle"], first.met, first.conditions) == (met.idxmax(), met.max(), 64)
        assert f"{met.max()} of 64 " in verdict_sentences(results)[1].text
        kinds.append((found.kind, found.why))
    assert kinds == [("build", ""), ("cannot_tell", "sample"), ("none", "")]


def test_the_worst_value_of_each_target_stands_in_the_table():
    for outputs in (("forces",), ("forces", "peak_stress", "life")):
        results, _, force, rolls = on_force(1.0, outputs)
        table = best_table(results)
        least = results.table.assign(force=np.where(rolls, force, np.nan)).groupby("contact_angle")["force"].min()
        assert row(table, "Normal force in contact 1, smallest [N]") == pytest.approx(least[table.rows[0][1:]].tolist())
    target = {"peak_stress_guide": {"max": 500.0}, "normal_force_2": {"max": 150.0}}
    table = best_table(results := solved(pairs=(), outputs=("forces", "peak_stress", "life"), target=target))
    for name, head in (("peak_stress_guide", "Peak stress of the guide, largest [MPa]"), ("normal_force_2", "Normal")):
        worst = largest(results, name, "roller_profile_radius")
        assert row(table, head) == pytest.approx(worst[table.rows[0][1:]].tolist())


def test_a_miss_of_a_target_on_a_stress_is_not_told_as_a_short_life():
    results = solved(pairs=(), outputs=("forces", "peak_stress", "life"), target={"peak_stress_guide": {"max": 100.0}})
    found = results.verdict
    assert found.kind == "none" and set(found.fails.reasons) == {"target peak_stress_guide"}
    text = " ".join(one.text for one in verdict_sentences(results))
    assert "misses the target" in text and "too early" not in text


# values that were not given


def test_build_names_the_axial_force_that_was_not_given_where_other_designs_lift_off():
    base = {"motor_force": 0, "guide_overrollings_per_hour": 120, "guide_curve_radius": 300}
    base |= dict(zip(("roller_material", "guide_material"), STEEL, strict=True))
    for given, angles in (({}, (20, 50)), ({"axial_force": 30}, (20, 50)), ({}, (45, 50))):
        results = solved((), ("life",), {"pair_life_hours": {"min": 1.0}}, base | given, angles)
        lifted = results.data["regime"].values.ravel() == 2
        assert lifted.any() == (20 in angles)
        found = results.verdict
        assert found.kind == "build" and found.not_given == (
            {"axial_force": 30.0} if lifted.any() and not given else {}
        )
        text = verdict_sentences(results)[1].text
        assert ("(axial force 30 N was not given)" in text) == bool(found.not_given)


# one convention in tables


def test_a_candidate_that_lifts_off_somewhere_does_not_hold_there():
    base = {"motor_force": 0, "guide_overrollings_per_hour": 120, "guide_curve_radius": 300, "axial_force": 30}
    results = solved((), ("life",), {"pair_life_hours": {"min": 1.0}}, base, (20, 50))
    lives = results.table.assign(life=np.where(results.regime == 0, results.column("pair_life_hours"), 0.0))
    worst = lives.groupby("contact_angle")["life"].min()
    table = best_table(results)
    told = row(table, "Life of the pair, worst condition")
    for cell, life in zip(told, worst[table.rows[0][1:]], strict=True):
        assert cell == ("does not hold" if life == 0.0 else pytest.approx(life))
    assert 0.0 in worst.to_numpy() and "lifts off" in row(table, "Ends it")[-1]


def test_a_row_names_both_limits_where_its_range_decides_which_ends_it(tmp_path):
    pairs = [f"{roller} / 42CrMo4+QT-40" for roller in ("EN AW-7075-T651", "POM-C", "1.7225-quenched-tempered")]
    rows = "".join(f"-7.9,-150,12,{pair}\n" for pair in pairs)
    (tmp_path / "rows.csv").write_text("roller_profile_radius,radial_force,axial_force,material_pair\n" + rows)
    base = {"motor_force": 0, "friction_coefficient": 0.2, "permissible_wear_depth": 0.1}
    study = {"name": "rows", "design": "table", "table": str(tmp_path / "rows.csv"), "base": base}
    results = tr.run(study | {"contact_model": "sliding", "accuracy": "preview"}, progress=False)
    data = results.data
    names = ["fatigue", "wear"]
    first = []
    for end in ("_low", "_high"):
        hours = data[f"life_hours_by_limit{end}"].sel(limit=names).min("body").transpose("case", "limit").values
        first.append([names[i] for i in np.argmin(hours, axis=1)])
    expected = [" or ".join(dict.fromkeys(two)) for two in zip(*first, strict=True)]
    told = [str(cells[-1]).partition(",")[0] for cells in rows_table(results).rows]
    assert told == expected and any(" or " in text for text in told)
