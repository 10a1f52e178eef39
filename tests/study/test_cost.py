"""The expected cost of a study counts friction laws; `validation.tradeoff` measures it."""

from __future__ import annotations

import pytest

from trackroller.study.cost import rate, study_rate
from trackroller.study.file.load import parse_study

FALLING = {"kind": "exponential", "speed": 200.0, "lowest": 0.4}


@pytest.mark.parametrize("contact_model", ["sliding", "kalker"])
def test_a_falling_law_costs_more_than_a_constant_one(contact_model):
    options = {"contact_model": contact_model, "outputs": ("forces",)}
    assert rate(options, FALLING) < 0.5 * rate(options)
    assert rate(options, {"kind": "constant"}) == rate(options, "") == rate(options)


def test_a_study_takes_the_time_of_each_friction_law():
    """A law for all cases, and a law as a factor beside constant friction."""
    study = {"name": "laws", "factors": {"axial_force": {"values": [0, 30]}}}
    options = parse_study(study).options
    slow, quick = rate(options, FALLING), rate(options)
    assert study_rate(parse_study(study)) == pytest.approx(quick)
    assert study_rate(parse_study(study | {"base": {"friction_law": FALLING}})) == pytest.approx(slow)
    both = study | {"factors": {"friction_law": {"values": [{"kind": "constant"}, FALLING]}}}
    assert study_rate(parse_study(both)) == pytest.approx(2 / (1 / slow + 1 / quick))
