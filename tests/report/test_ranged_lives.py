"""What a report says of lives that are ranges, against the raw rows of small studies."""

import numpy as np
import pytest

import trackroller as tr
from trackroller.report.numbers import chance
from trackroller.report.words.designs import best_table
from trackroller.report.words.in_short import in_short
from trackroller.report.words.targets import target_tables

BASE = {
    "motor_force": 0,
    "axial_force": 3,
    "guide_curve_radius": np.inf,
    "guide_overrollings_per_hour": 60,
    "permissible_wear_depth": 0.1,
    "contact_angle": 40,
    "velocity": 40,
    "guide_material": "C45",
}
STUDY = {
    "name": "ranges",
    "base": BASE,
    "factors": {
        "roller_material": {"values": ["42CrMo4+QT-40", "PA6-dry"]},
        "roller_profile_radius": {"values": [-6.3, -6.8]},
        "friction_coefficient": {"values": [0.1, 0.25]},
        "radial_force": {"values": [-20, -45]},
    },
    "contact_model": "sliding",
}


@pytest.fixture(scope="module")
def solved():
    """A study with a target, where steel may or may not meet it, by its wear coefficient."""
    return tr.run(STUDY | {"analysis": {"target": {"min": 400}}}, progress=False)


def test_tables_judge_a_target_by_the_life_that_the_verdict_compares(solved):
    """The life by fatigue of steel is many times the target; its life to the first limit may miss it."""
    ds = solved.data
    low = ds["pair_life_to_first_limit_hours_low"].min(("friction_coefficient", "radial_force"))
    high = ds["pair_life_to_first_limit_hours_high"].min(("friction_coefficient", "radial_force"))
    steel = {"roller_material": "42CrMo4+QT-40"}
    assert (
        (ds["pair_life_hours"].sel(steel) > 1e4).all()
        and (low.sel(steel) < 400).all()
        and (high.sel(steel) > 4000).all()
    )
    sure = (ds["pair_life_to_first_limit_hours_low"] >= 400).sum(("friction_coefficient", "radial_force"))
    table = best_table(solved)
    row = next(r for r in table.rows if r[0].startswith("Meets the targets"))
    assert "for certain" in row[0] and "Open: neither" in table.note
    heads = [r for r in table.rows if r[0] in ("Roller material", "Roller profile radius [mm]")]
    for material, radius, cell in zip(heads[0][1:], heads[1][1:], row[1:], strict=True):
        place = {"roller_material": str(material), "roller_profile_radius": float(str(radius).replace("−", "-"))}
        count = int(sure.sel(place))
        opened = low.sel(place) < 400 <= high.sel(place)
        assert str(cell) == f"{count} of 4" + " (open)" * bool(opened)
    levels = target_tables(solved.indices(), solved)[0]
    assert levels.rows[0][1] == f"{int((low >= 400).sum())} of 4"
    assert levels.rows[0][2] == f"{100 * float((ds['pair_life_to_first_limit_hours_low'] >= 400).mean()):.0f} %"
    assert "400 h" in levels.heads[2]


def test_findings_say_where_in_the_ranges_they_stand(solved):
    """Effects are those at the values of the placeholders; a study without ranges says nothing of it."""
    said = {head: [one.kind for one in sentences] for head, sentences in in_short(solved, [])}
    assert said["Why"].count("within") == 1
    base = {name: value for name, value in BASE.items() if name != "permissible_wear_depth"}
    plain = tr.run(STUDY | {"base": base}, progress=False)
    assert not plain.ranged
    assert "within" not in {one.kind for _, said in in_short(plain, []) for one in said}


def test_a_verdict_names_a_line_that_rests_on_guesses(solved):
    """PA6-dry is ended by fatigue, and the exponent of its S-N line is a guess; the line of the paper is none."""
    said = {one.kind: one.values for _, sentences in in_short(solved, []) for one in sentences}
    assert said["guessed"]["material"] == "PA6-dry"
    assert said["guesses"]["placed"]["rolling-contact fatigue"] == ["42CrMo4+QT-40", "C45", "PA6-dry"]
    paper = "1.7225-quenched-tempered"
    base = {**BASE, "guide_material": paper, "roller_material": paper}
    del base["permissible_wear_depth"]
    factors = {name: STUDY["factors"][name] for name in ("roller_profile_radius", "radial_force")}
    known = tr.run({**STUDY, "base": base, "factors": factors}, progress=False)
    assert "guessed" not in {one.kind for _, part in in_short(known, []) for one in part}


def test_each_end_of_a_range_has_its_own_worst_condition():
    """Wear ends the low end where the drive slips most, fatigue the high end under the most friction."""
    base = {**BASE, "radial_force": -40, "axial_force": 4, "permissible_wear_depth": 0.15, "velocity": 180}
    del base["motor_force"]
    factors = {
        "roller_material": {"values": ["PA66-dry", "PA66-moist"]},
        "friction_coefficient": {"values": [0.15, 0.3]},
        "motor_force": {"values": [0, -3]},
    }
    results = tr.run({"name": "ends", "base": base, "factors": factors, "contact_model": "sliding"}, progress=False)
    for one in results.verdict.candidates:
        own = results.data.sel(roller_material=one.choices["roller_material"])
        for end, case in (("low", one.case), ("high", one.case_high)):
            row = results.table.iloc[case]
            place = {name: row[name] for name in ("friction_coefficient", "motor_force")}
            values = own[f"pair_life_to_first_limit_hours_{end}"]
            assert float(values.sel(place)) == pytest.approx(float(values.min()), rel=1e-12)
    row = next(r for r in best_table(results).rows if r[0] == "Worst condition")
    ends = (
        "friction coefficient 0.15, driven −3 N at the low end",
        "friction coefficient 0.3, driven −3 N at the high end",
    )
    assert row[1] == ", ".join(ends)


def test_a_chance_has_no_figures_that_no_sample_shows():
    """Nearer to always or never than one in ten thousand, a bound stands; always and never stay exact."""
    assert chance(0.9999996, 0.86, 1.0) == "over 99.99 % (86 % to 100 %)"
    assert (
        chance(1e-7) == "below 0.01 %"
        and chance(1.0) == "100 %"
        and chance(0.0) == "0 %"
        and chance(0.9994) == "99.94 %"
    )


def test_the_known_error_of_wear_by_sliding_is_told_where_wear_is_a_limit(solved):
    """The limits hold the life by wear, whether the group wear is an output or not."""
    assert "run_in_distance" not in solved.data
    said = {head: [one.kind for one in sentences] for head, sentences in in_short(solved, [])}
    assert "full_sliding" in said["How sure"]
