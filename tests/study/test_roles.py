"""Who sets a factor: the designer or the use of the roller."""

import pytest

import trackroller as tr
from trackroller.parameters import PARAMETERS, ROLE_OF
from trackroller.study.design.roles import roles_of
from trackroller.study.file.load import parse_study

LISTS = {
    "friction_coefficient": {"values": [0.1, 0.3]},
    "roller_profile_radius": {"values": [-6.5, -8]},
    "contact_model": {"values": ["sliding", "kalker"]},
}


def roles(data):
    study = parse_study({"name": "r", **data})
    return roles_of(study.parsed, study.parsed, study.config.roles, study.config.method_name)


def test_the_program_knows_who_sets_each_parameter():
    """Loads, friction, speed and the curve come from the use; geometry and materials from the designer."""
    use = {name for name, role in ROLE_OF.items() if role == "condition"}
    forces = {name for name in PARAMETERS if name.endswith("_force")} - {"permissible_radial_force"}
    others = {"friction_coefficient", "friction_law", "velocity", "guide_curve_radius", "guide_overrollings_per_hour"}
    others |= {"layer_flexibility", "travel", "wear_coefficient_factor", "placeholder_position", "ambient_temperature"}
    assert use == forces | others
    assert roles({"factors": LISTS}) == {"friction_coefficient": "condition", "roller_profile_radius": "choice"}
    swapped = {"friction_coefficient": "choice", "roller_profile_radius": "condition"}
    assert roles({"factors": LISTS, "roles": swapped}) == swapped


def test_own_factors_have_the_role_of_the_parameter_that_they_give():
    """A ratio of radii is chosen, a share of the drive is not; a factor that gives both is chosen."""
    factors = {
        "profile_ratio": {"values": [1.1, 1.4]},
        "roller_profile_radius": {"expression": "-6 * profile_ratio * size"},
        "drive_share": {"values": [0, 0.5]},
        "motor_force": {"expression": "-drive_share * thrust"},
        "thrust": {"expression": "40 * size * grade"},
        "size": {"values": [1, 1.01]},
        "grade": {"values": [1, 2]},
    }
    names = ("profile_ratio", "drive_share", "size", "grade")
    found = roles({"factors": factors})
    assert [found[n] for n in names] == ["choice", "condition", "choice", "condition"]
    found = roles({"factors": factors, "roles": {"motor_force": "choice"}})
    assert [found[n] for n in names] == ["choice"] * 4


def test_the_inner_array_holds_the_conditions():
    factors = {"friction_coefficient": {"values": [0.1, 0.2]}, "contact_angle": {"uniform": [28, 32]}}
    found = roles({"factors": factors, "method": "inner_outer", "samples": 8})
    assert found == {"friction_coefficient": "choice", "contact_angle": "condition"}


@pytest.mark.parametrize(
    "given, more, words",
    [
        ({"friction_coeficient": "choice"}, {}, ("roles.friction_coeficient", "friction_coefficient")),
        ({"friction_coefficient": "use"}, {}, ("roles.friction_coefficient", "use", "choice", "condition")),
        ({"contact_angle": "choice"}, {}, ("roles.contact_angle", "roller_profile_radius")),
        ({"contact_model": "choice"}, {}, ("roles.contact_model", "option of the calculation", "Remove")),
        (["friction_coefficient"], {}, ("roles", "For example")),
        ({"roller_profile_radius": "condition"}, {"method": "inner_outer"}, ("design points", "scatter: true")),
    ],
)
def test_wrong_roles_are_refused(given, more, words):
    factors = dict(LISTS)
    if more:
        factors.pop("contact_model")
        factors["axial_force"] = {"uniform": [0, 30]}
    with pytest.raises(tr.InputError) as error:
        parse_study({"name": "r", "factors": factors, "roles": given, **more})
    assert all(word in str(error.value) for word in words)
