"""The sizes of a drawing have units where a study names them, and errors of words name what to write."""

import pytest

import trackroller as tr


def test_an_outer_radius_as_factor_has_its_unit():
    study = {
        "name": "size",
        "base": {"motor_force": 0, "groove_depth": 2.5, "friction_coefficient": 0.1},
        "factors": {"outer_radius": {"values": [24, 30]}},
        "contact_model": "sliding",
        "accuracy": "preview",
        "outputs": ["forces", "peak_stress", "life"],
    }
    results = tr.run(study, progress=False)
    assert results.quantity("outer_radius")[1:] == ("mm", "outer radius")


def test_a_straight_track_is_written_inf():
    with pytest.raises(tr.InputError, match="Write inf for a straight one"):
        tr.Case(guide_curve_radius="straight")
