"""What the tables of designs tell of margins, of lives without an end, and of intervals, against the raw rows."""

import numpy as np

import trackroller as tr
from trackroller.report.numbers import plus_minus
from trackroller.report.pages.study import contents
from trackroller.report.words.designs import best_table
from trackroller.report.words.verdict import verdict_sentences

STEEL = dict.fromkeys(("roller_material", "guide_material"), "1.7225-quenched-tempered")
BASE = {"axial_force": 20, "guide_curve_radius": np.inf, "guide_overrollings_per_hour": 100, **STEEL}


def run(factors, **keys):
    study = {"name": "made", "base": BASE, "factors": factors, "contact_model": "sliding", "accuracy": "preview"}
    return tr.run(study | keys, progress=False)


def test_a_design_that_lifts_off_or_slips_has_no_margin():
    factors = {
        "contact_angle": {"values": [20, 45]},
        "radial_force": {"values": [-30, -100]},
        "motor_force": {"values": [0, -9]},
        "friction_coefficient": {"values": [0.1, 0.3]},
    }
    results = run(factors)
    table = best_table(results)
    head = [row[0] for row in table.rows]
    regime = results.data["regime"].stack(row=list(factors)[1:])
    regime = regime[:, (regime == 0).any("contact_angle").values]  # conditions in which a design holds
    assert regime.sizes["row"] < 8
    shown = dict(zip(table.rows[0][1:], zip(*(row[1:] for row in table.rows), strict=True), strict=True))
    assert len(shown) > 1
    for angle, cells in shown.items():
        own = regime.sel(contact_angle=float(angle)).values
        for row, lost in (("Least margin to slip", 1), ("Least margin to lift-off", 2)):
            assert (cells[head.index(row)] == "none") == bool((own == lost).any())


def test_nothing_ends_a_life_without_an_end():
    """Below its fatigue limit a roller never fails by the rule `unlimited`: no condition is its worst one."""
    factors = {"contact_angle": {"values": [40, 50]}, "radial_force": {"values": [-40, -60]}}
    base = BASE | {"motor_force": 0, "axial_force": 2, "roller_profile_radius": -6.4}
    for angles in ([40, 50], [45]):
        results = run(factors | {"contact_angle": {"values": angles}}, base=base, life_rule="unlimited")
        assert np.isinf(results.column("pair_life_to_first_limit_hours")).all()
        said = " ".join(one.text for one in verdict_sentences(results))
        assert "No limit ends the pair in any condition" in said and "fatigue ends" not in said
        assert "worst condition" not in said and results.verdict.best[0].ends == ""
        cells = {row[0]: row[1] for row in best_table(results).rows}
        assert cells["Ends it"] == cells["Worst condition"] == "–"


def test_an_interval_of_rounding_alone_is_not_told():
    assert plus_minus(0.778, 0.778 - 1e-16, 0.778 + 1e-16) == "0.778"
    assert plus_minus(0.778, 0.768, 0.788) == "0.778 ± 0.010"


def test_lists_of_conditions_may_stay_lists():
    """A category, such as a straight or curved track, has no distribution."""
    factors = {
        "roller_profile_radius": {"uniform": [-8, -6.4]},
        "guide_curve_radius": {"values": [np.inf, 220]},
        "radial_force": {"uniform": [-100, -40]},
    }
    base = {name: value for name, value in BASE.items() if name != "guide_curve_radius"} | {"motor_force": 0}
    results = run(factors, base=base, design="sobol", samples=8)
    said = " ".join(one.text for one in dict(contents(results)["summary"])["Verdict"])
    assert "as distributions or as lists with `scatter: true`" in said
