"""Conclusions that hold for all values within their ranges, against all combinations of values."""

import itertools

import numpy as np
import pytest
from told import told

import trackroller as tr
from trackroller.materials import builtin_database
from trackroller.report.numbers import factor_label
from trackroller.results.first_limits import reached_hours, settled
from trackroller.roller.limit_notes import placeholders_of
from trackroller.study.file.load import parse_study

STUDY = {
    "name": "unsure",
    "base": {"radial_force": -60, "axial_force": 5, "guide_overrollings_per_hour": 600, "motor_force": 0}
    | {"permissible_wear_depth": 0.3},
    "factors": {
        "material_pair": {"values": [["1.7225-normalised"] * 2, ["EN AW-7075", "1.7225-normalised"]]},
        "velocity": {"values": [20, 120]},
        "friction_coefficient": {"values": [0.05, 0.2, 0.4]},
        "placeholder_position": {"values": [-1, 0, 1]},
    },
    "contact_model": "sliding",
    "accuracy": "preview",
    "outputs": ["forces", "contact", "peak_stress", "life", "rating", "limits"],
}


@pytest.mark.slow
def test_conclusions_that_hold_for_all_combinations_of_the_ranges_are_counted():
    """Count by trying every combination of the places of each limit, which differ independently."""
    solved = tr.run(parse_study(STUDY), progress=False)
    reached = reached_hours(solved).reshape(2, 2, 3, 3, -1)  # pair, speed, friction, place, limit
    certain = ends = 0
    for own in reached.reshape(-1, 3, reached.shape[-1]):
        firsts = set()
        for places in itertools.product(range(3), repeat=own.shape[1]):
            hours = own[places, range(own.shape[1])]
            firsts |= {int(np.argmin(hours))} if np.isfinite(hours).any() else set()
        ends += bool(firsts)
        certain += len(firsts) == 1
    found = solved.candidates()
    assert settled(found) == (certain, ends) and 0 < certain < ends
    said = next(told(solved, one) for one in solved.findings["why"] if one.kind == "whichever_first")
    assert f"in {certain} of {ends} combinations" in said.text and "placeholders of materials" in said.text
    fixed = STUDY | {"factors": {n: f for n, f in STUDY["factors"].items() if n != "placeholder_position"}}
    found = tr.run(parse_study(fixed), progress=False).findings["why"]
    assert not [one for one in found if one.kind == "whichever_first"]


def test_factors_with_and_without_a_symbol_have_a_label_that_figures_can_draw():
    assert factor_label("required_travel").startswith("Travel that") and "$" not in factor_label("required_travel")
    assert "$f_\\mathrm{P}$" in factor_label("placeholder_position")


def test_the_placeholders_of_a_result_are_those_of_the_database():
    """Each range that the notes state is that of the record."""
    records = {name: material.records for name, material in builtin_database().materials.items()}
    case = {"roller_material": "PA6", "permissible_wear_depth": 0.1, "guide_overrollings_per_hour": 100}
    found = placeholders_of(tr.solve(case, outputs=("limits",), contact_model="sliding", accuracy="preview"))
    assert {(one.limit, one.name) for one in found} >= {("wear", "wear_coefficient"), ("shakedown", "yield_strength")}
    for one in found:
        if one.on:  # of a pair of materials
            assert {one.material, one.on} == {"PA6", "1.7225-normalised"}
            assert 0 <= one.low < one.high and one.units == "mm3/(N m)"
        else:
            record = records[one.material][one.name]
            assert (one.low, one.high) == pytest.approx(record.range) and one.units == record.unit
