"""A row of the limits of patches has the same bits alone, at any place of a block, and with any number of threads."""

import dataclasses

import numpy as np
import pytest

import trackroller as tr
from trackroller.numerics.threads import limited_to

COOLED = {"heat_transfer_coefficient": 20, "cooled_area": 5000}
NAMES = ("flash_temperature_rise", "heat_partition", "pressure_velocity", "heat_utilisation", "shakedown_utilisation")


def rollers():
    """Rollers of several materials, mirrored, without friction, in full slip and with one contact lifted off."""
    plain = tr.Case(**COOLED, motor_force=0)
    changes = (
        {},
        {"axial_force": 0.0},
        {"friction_coefficient": 0.0},
        {"motor_force": -400.0},
        {"axial_force": 300.0},
        {"roller_material": "PA6"},
        {"roller_material": "POM", "velocity": 200.0, "roller_profile_radius": -7.0},
        {"guide_material": "PA6", "contact_angle": 40.0},
    )
    return [dataclasses.replace(plain, **change) for change in changes]


@pytest.mark.parametrize("model", ["sliding", "kalker"])
def test_a_row_is_the_same_alone_and_in_any_block(model):
    cases = rollers()
    outputs = ("forces", "shakedown", "heat", "limits")
    with limited_to(1):
        together = tr.solve(cases, outputs, contact_model=model)
    with limited_to(2):
        turned = tr.solve(2 * cases[::-1], outputs, contact_model=model)
    for i, case in enumerate(cases):
        alone = tr.solve([case], outputs, contact_model=model)
        for name in NAMES:
            own = together[name].values[i]
            np.testing.assert_array_equal(alone[name].values[0], own, err_msg=name)
            np.testing.assert_array_equal(turned[name].values[len(cases) - 1 - i], own, err_msg=name)
            np.testing.assert_array_equal(turned[name].values[2 * len(cases) - 1 - i], own, err_msg=name)


def test_bodies_of_equal_diffusivity_share_one_kernel():
    """The rise is over the conductivity; unlike bodies have kernels of their own."""
    steel = {"like": "1.7225-normalised", "thermal_conductivity": 42.0, "heat_capacity": 460.0, "density": 7850.0}
    double = steel | {"thermal_conductivity": 84.0, "heat_capacity": 920.0}
    case = tr.Case(**COOLED, motor_force=0, roller_material=steel, guide_material=double)
    ds = tr.solve(case, "heat", contact_model="sliding")
    assert ds.heat_partition.values == pytest.approx([1 / 3, 1 / 3], rel=1e-12)
