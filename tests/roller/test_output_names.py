"""One grammar for the names of results: variable, body, contact, limit."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

import trackroller as tr
from trackroller.roller.dataset import VARIABLES
from trackroller.roller.output_names import PARTS, body_of, is_life, pair_first, parts_of

CASES = [{"friction_coefficient": mu, "axial_force": force} for mu in (0.1, 0.3) for force in (0.0, 30.0)]


@pytest.fixture(scope="module")
def solved():
    groups = ("forces", "contact", "friction_work", "peak_stress", "life", "limits")
    return tr.solve(CASES, outputs=groups, contact_model="sliding")


@pytest.mark.parametrize(
    "name",
    [
        "peak_stress_roller",
        "peak_stress_roller_2",
        "normal_force_1",
        "wear_life_hours_guide",
        "utilisation_guide_heat",
        "friction_power",
        "roller_life_hours",
    ],
)
def test_names_of_the_interface(name):
    assert PARTS[name].name == name


def test_each_name_means_one_part():
    names = [part.name for variable in VARIABLES.values() for part in parts_of(variable)]
    assert len(names) == len(set(names)) == len(PARTS)


def test_a_limit_that_concerns_one_body_has_no_part_of_the_other():
    assert "utilisation_roller_bearing" in PARTS and "utilisation_guide_bearing" not in PARTS


def test_values_are_those_of_the_worse_contact_or_the_sum(solved):
    def of(name):
        return PARTS[name].values(solved).values

    stress, force = solved["peak_stress"].values, solved["normal_force"].values
    assert np.array_equal(of("peak_stress_guide"), stress[:, :, 1].max(axis=1), equal_nan=True)
    assert np.array_equal(of("peak_stress_guide_2"), stress[:, 1, 1], equal_nan=True)
    assert np.array_equal(of("life_cycles_roller"), solved["life_cycles"].values[:, :, 0].min(axis=1), equal_nan=True)
    assert np.array_equal(of("friction_power"), solved["friction_power"].values.sum(axis=1), equal_nan=True)
    assert np.array_equal(of("normal_force_1"), force[:, 0])
    used = solved["utilisation"].sel(limit="fatigue", body="roller").values
    assert np.array_equal(of("utilisation_roller_fatigue"), used, equal_nan=True)


def test_a_contact_without_a_value_does_not_hide_the_other():
    both = xr.Dataset({"max_pressure": (("case", "contact"), [[500.0, np.nan], [np.nan, np.nan]])}, {"contact": [1, 2]})
    assert np.array_equal(PARTS["max_pressure"].values(both), [500.0, np.nan], equal_nan=True)


def test_words_name_body_and_contact():
    assert PARTS["peak_stress_roller_2"].words == "peak stress of the roller in contact 2"
    assert PARTS["friction_power"].words == "friction power of both contacts"
    assert PARTS["bulk_temperature_rise_guide"].words.startswith("mean temperature rise of the guide by")


def test_the_declaration_says_what_is_a_life_and_whose():
    lives = {variable.name for variable in VARIABLES.values() if variable.life}
    assert {"life_cycles", "wear_life_hours", "bearing_life_hours", "pair_life_to_first_limit_hours_low"} <= lives
    assert not {"run_in_distance", "life_error_estimate", "utilisation"} & lives  # compared by logarithms, errors
    assert is_life("life_cycles_guide_2") and not is_life("peak_stress_guide")
    assert is_life("life_of_another_solver") and not is_life("noise")
    assert [body_of(name) for name in ("guide_life_hours", "wear_life_hours_roller_1", "pair_life_hours", "slip")] == [
        "guide",
        "roller",
        "",
        "",
    ]
    assert pair_first(["life_cycles_guide", "roller_life_hours", "pair_life_hours"])[0] == "pair_life_hours"
    assert pair_first(["life_cycles_guide", "roller_life_hours"])[0] == "roller_life_hours"
