"""Fits of rollers on a bench: ends, censoring, what is held, and every bad table in one sentence."""

from __future__ import annotations

import math

import numpy as np
import pytest

import trackroller as tr
from trackroller.fit.bench import travels_to_depths
from trackroller.fit.solved_rollers import check_same, solved_rollers
from trackroller.roller.case import Case

RIG = {"motor_force": 0, "friction_coefficient": 0.1, "axial_force": 20, "contact_model": "sliding"}
HEAD = "test,radial_force [N],travel_from [km],travel_to [km],end\n"
ROWS = (
    "R1,-160,38.2,38.2,fatigue roller\nR2,-160,30,40,fatigue roller\nR3,-120,200,,none\n"
    "R4,-200,12,12,fatigue roller\nR5,-200,15,15,fatigue roller\nR6,-130,90,90,fatigue roller\n"
)


def table(tmp_path, text=ROWS, head=HEAD):
    path = tmp_path / "bench.csv"
    path.write_text(head + text)
    return path


def fit(tmp_path, text=ROWS, values="fatigue_strength,slope,scatter", **more):
    return tr.fit_bench(table(tmp_path, text), values, base=RIG, **more)


def lives(loads, slope=9.0, strength=360.0, scatter=0.0, seed=0):
    """Return travels [km] of rollers by a known line, at N_k of the default material."""
    cases = [
        Case.from_dict({k: v for k, v in RIG.items() if k != "contact_model"} | {"radial_force": f}) for f in loads
    ]
    solved = solved_rollers(cases, {"contact_model": "sliding"})
    cycles = 5e6 * (solved.stress[:, :, 0].max(axis=1) / strength) ** -slope
    cycles *= np.exp(scatter * np.random.default_rng(seed).normal(size=len(loads)))
    return cycles / solved.per_km[:, 0, 0]


def test_exact_lives_return_the_line_that_made_them(tmp_path):
    loads = [-120, -150, -180, -210]
    rows = "".join(
        f"T{i},{f},{km!r},{km!r},fatigue roller\n"
        for i, (f, km) in enumerate(zip(loads, lives(loads).tolist(), strict=True))
    )
    made = fit(tmp_path, rows).groups[0].line.best
    assert made.slope == pytest.approx(9.0, rel=1e-3)


@pytest.mark.slow
def test_intervals_of_ninety_per_cent_hold_a_known_line_that_often(tmp_path):
    """Of 20 benches 18 are expected to hold a value; fewer than 14 have a probability of 0.2 %."""
    loads = [-120, -150, -180, -210] * 6
    truths = {"fatigue_strength": 360.0, "slope": 9.0, "scatter": math.exp(2.563 * 0.5)}
    held = dict.fromkeys(truths, 0)
    for seed in range(20):
        km = lives(loads, scatter=0.5, seed=seed).tolist()
        rows = "".join(f"T{i},{f},{t!r},{t!r},fatigue roller\n" for i, (f, t) in enumerate(zip(loads, km, strict=True)))
        found = fit(tmp_path, rows)
        for name, truth in truths.items():
            low, high = found.interval(name)
            held[name] += low < truth < high
    assert min(held.values()) >= 14, held


def test_twice_the_travel_is_twice_the_life(tmp_path):
    one = fit(tmp_path)
    two = fit(tmp_path, ROWS.replace("38.2", "76.4").replace("30,40", "60,80").replace("200,,", "400,,")
              .replace("12,12", "24,24").replace("15,15", "30,30").replace("90,90", "180,180"))  # fmt: skip
    ratio = two.estimate("cycles", amplitude=400.0) / one.estimate("cycles", amplitude=400.0)
    assert ratio == pytest.approx(2.0, rel=1e-6)
    assert two.material["woehler_exponent"] == pytest.approx(one.material["woehler_exponent"], rel=1e-6)


def test_an_end_by_wear_never_shortens_fatigue(tmp_path):
    """A roller that ended by wear counts as one that was stopped whole."""
    worn = fit(tmp_path, ROWS.replace("200,,none", "200,200,wear roller 0.05 mm")).material
    assert worn == fit(tmp_path).material
    assert (
        worn["fatigue_limit"]
        > fit(tmp_path, ROWS.replace("200,,none", "200,200,fatigue roller")).material["fatigue_limit"]
    )


def test_the_other_body_is_a_suspension(tmp_path):
    assert (
        fit(tmp_path, ROWS.replace("200,,none", "200,200,fatigue guide"), body="roller").material
        == fit(tmp_path).material
    )


def test_a_stated_contact_leaves_the_other_one_whole(tmp_path):
    path = table(tmp_path, ROWS.replace("none", "none,").replace("roller\n", "roller,1\n"), HEAD.strip() + ",contact\n")
    group = tr.fit_bench(path, base=RIG).groups[0]
    assert len(group.line.tests.stress) == 11  # five failures with their whole contacts, one suspension
    assert group.line.size == 6
    assert int(group.line.tests.failed.sum()) == 5


def test_what_is_not_fitted_is_that_of_the_material(tmp_path):
    found = fit(tmp_path, values="fatigue_strength,scatter")
    assert found.material["woehler_exponent"] == pytest.approx(
        tr.load_database().material("1.7225-normalised").woehler_exponent
    )


def test_no_failure_gives_a_one_sided_bound(tmp_path):
    rows = "A,-160,40,,none\nB,-160,60,,none\nC,-200,30,,none\n"
    found = tr.fit_bench(table(tmp_path, rows), "fatigue_strength", base=RIG | {
        "roller_material": {"like": "1.7225-normalised", "name": "steel", "scatter_in_cycles": 5}})  # fmt: skip
    low, high = found.interval("fatigue_strength")
    assert low > 0
    assert high == math.inf
    assert found.unidentified == ("fatigue_limit",)


def test_a_wear_coefficient_is_recovered(tmp_path):
    case = Case.from_dict({k: v for k, v in RIG.items() if k != "contact_model"} | {"radial_force": -160})
    unit = travels_to_depths([case] * 2, {"contact_model": "sliding"}, "roller", [0.02, 0.05])
    km = unit * 1e-6 / 3e-5
    rows = "".join(
        f"W{i},-160,{t},{t},wear roller {d} mm\n" for i, (t, d) in enumerate(zip(km, (0.02, 0.05), strict=True))
    )
    found = fit(tmp_path, rows, "wear_coefficient")
    assert found.groups[0].line.best.level == pytest.approx(math.log(1e-6 / 3e-5), abs=1e-3)


def test_a_friction_coefficient_is_recovered(tmp_path):
    case = {k: v for k, v in RIG.items() if k != "friction_coefficient"} | {"friction_coefficient": 0.17}
    options = {"contact_model": case.pop("contact_model")}
    loads = (-160, -200, -240)
    ds = tr.solve([case | {"radial_force": f} for f in loads], outputs="forces", **options)
    rows = "".join(
        f"F{i},{f},10,,none,{abs(force)}\n"
        for i, (f, force) in enumerate(zip(loads, ds.transmitted_force.values, strict=True))
    )
    path = table(tmp_path, rows, HEAD.strip() + ",drive_force [N]\n")
    found = tr.fit_bench(path, "friction_coefficient", base=RIG)
    assert found.groups[0].line.best.level == pytest.approx(math.log(0.17), abs=0.02)


def test_values_are_refused_with_another_contact_model(tmp_path):
    found = fit(tmp_path)
    with pytest.raises(tr.InputError, match="contact_model = 'kalker' differs from the sliding"):
        check_same(found.given, {}, found.name)
    with pytest.raises(tr.InputError, match="life_criterion"):
        found.life_hours(RIG | {"life_criterion": "von_mises_amplitude"})


def test_the_life_of_a_design_has_an_interval(tmp_path):
    found = fit(tmp_path)
    low, high = found.life_hours(RIG | {"radial_force": -140}, failure_probability=0.1)
    assert 0 < low < high


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("38.2,38.2,fatigue roller", "38.2,38.2,fatig roller", r"line 2: end = 'fatig roller'.*none, or how it ended"),
        ("38.2,38.2,fatigue roller", "38.2,38.2,fatigue", r"line 2: end.*Write fatigue roller"),
        ("38.2,38.2,fatigue roller", "38.2,38.2,wear roller", r"line 2: end.*depth that was reached with its unit"),
        ("30,40,", "40,30,", r"line 3: travel_to = '30 km'.*at least travel_from = 40"),
        ("200,,none", "200,300,none", r"line 4: travel_to.*did not end"),
        ("38.2,38.2,", "38.2,,", r"line 2: travel_to .*the roller ended"),
        ("R2,", "R1,", r"line 3: test = 'R1' stands in row 2 as well"),
        ("R4,-200", "R4,200", r"line 5: radial_force"),
        ("R4,-200", "R4,-900000", r"line 5: radial_force.*stress of \d+ MPa, above its tensile strength"),
        ("38.2,38.2,", "420000,420000,", r"line 2: travel_from = '420000 km'.*overrollings"),
        ("R6,-130", "R6,-20", r"line 7: radial_force = '-20 N' belongs to a roller that lifts off"),
        ("200,,none", "200,200,fatigue guide", r"line 4: end = 'fatigue guide'.*--body"),
        ("fatigue roller", "bearing", r"line 7: end = 'bearing' ends no test by fatigue"),
    ],
)
def test_a_bad_row_is_told_with_its_place(tmp_path, old, new, message):
    text = ROWS.replace(old, new) if new == "bearing" else ROWS.replace(old, new, 1)
    with pytest.raises(tr.InputError, match=message):
        fit(tmp_path, text)


def test_lives_that_grow_with_the_load_are_refused(tmp_path):
    text = "".join(f"T{i},{-140 - 15 * i},{12 * 2**i},{12 * 2**i},fatigue roller\n" for i in range(5))
    with pytest.raises(tr.InputError, match=r"line 6: travel_from = '192 km'.*negative slope"):
        fit(tmp_path, text)


def test_held_values_give_a_bound_without_failures_and_a_strength_at_one_load(tmp_path):
    whole = ROWS.replace("fatigue roller", "none").replace("30,40", "30,").replace("38.2,38.2", "38.2,")
    whole = whole.replace("12,12", "12,").replace("15,15", "15,").replace("90,90", "90,").replace("none", "run out", 1)
    found = fit(tmp_path, whole, slope=8, scatter_in_cycles=4)
    low, high = found.interval("fatigue_strength")
    assert 0 < low and high == math.inf
    text = "".join(f"T{i},-160,{30 + i},{30 + i},fatigue roller\n" for i in range(5))
    one = fit(tmp_path, text, slope=8)
    assert one.material["woehler_exponent"] == 8
    assert set(one.data.value.values) == {"fatigue_limit", "scatter_in_cycles"}


def test_an_empty_cell_is_never_the_load_of_the_example(tmp_path):
    """A cell that nothing fills is refused; a value of the base fills it."""
    text = ROWS.replace("R1,-160", "R1,")
    with pytest.raises(tr.InputError, match=r"bench\.csv, line 2: radial_force = ''.*the cell is empty. Fill the cell"):
        fit(tmp_path, text)
    path = table(tmp_path, text)
    assert tr.fit_bench(path, base=RIG | {"radial_force": -160}).tests.lines[0] == 2


def test_what_is_taken_from_the_example_is_told(tmp_path):
    given = {name: value for name, value in RIG.items() if name != "axial_force"}
    (told,) = tr.fit_bench(table(tmp_path), base=given).not_given
    assert told.startswith("Not given, taken from the paper's example: ")
    assert "axial_force 30 N" in told and "radial_force" not in told


def test_one_load_does_not_tell_the_slope(tmp_path):
    text = "".join(f"T{i},-160,{30 + i},{30 + i},fatigue roller\n" for i in range(5))
    with pytest.raises(tr.InputError, match=r"line 6: radial_force.*failures at two loads"):
        fit(tmp_path, text)


def test_a_misspelt_column_is_named(tmp_path):
    with pytest.raises(tr.InputError, match=r"radial_forc.*'radial_force'"):
        tr.fit_bench(table(tmp_path, head=HEAD.replace("radial_force", "radial_forc")), base=RIG)


def test_the_plan_prefers_what_tells_more_than_chance(tmp_path):
    found = fit(tmp_path)
    candidates = [RIG | {"radial_force": f} for f in (-110, -140, -180, -240)]
    plan = tr.next_tests(found, [{k: v for k, v in c.items() if k != "contact_model"} for c in candidates],
                         RIG | {"radial_force": -110}, tests=2)  # fmt: skip
    after, random = float(plan.deviation_after[-1]), float(plan.deviation_random)
    assert after < random < float(plan.deviation_now)
    assert (plan.deviation.values <= float(plan.deviation_now) * 1.02).all()
    assert (plan.hours.values[:-1] > plan.hours.values[1:]).all()
