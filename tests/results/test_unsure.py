"""Values that are known within a range only: their names in figures, and the ranges that the notes state."""

import pytest

import trackroller as tr
from trackroller.materials import builtin_database
from trackroller.report.numbers import factor_label
from trackroller.roller.limit_notes import placeholders_of


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
