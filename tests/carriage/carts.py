"""Carriages for tests."""

from __future__ import annotations

import copy

SIDES = {"FL": (150, 40), "FR": (150, -40), "RL": (-150, 40), "RR": (-150, -40)}
STEEL = "1.7225-quenched-tempered"
ROLLER = {
    "roller_material": STEEL,
    "guide_material": STEEL,
    "contact_model": "sliding",
    "motor_force": 0,
    "friction_coefficient": 0.1,
    "guide_curve_radius": "inf",
}


def rollers_between(**more):
    """Return four rollers between two rails, which press sideways and have upright axes."""
    return {
        name: {"at": [x, y, 0], "pushes": [0, -1 if y > 0 else 1, 0], "x_R": [0, 0, 1], "roller": ROLLER, **more}
        for name, (x, y) in SIDES.items()
    }


def rollers_below(**more):
    """Return four rollers that press down on two rails."""
    return {
        name: {"at": [x, y, 0], "pushes": [0, 0, -1], "x_R": [0, 1, 0], "roller": ROLLER, **more}
        for name, (x, y) in SIDES.items()
    }


def shuttle(**changed):
    """Return the shuttle of the documentation, with some keys changed."""
    values = {
        "name": "shuttle",
        "mass": {"value": "40 kg", "at": [0, 0, 60]},
        "payloads": [{"value": "60 kg", "at": [80, 0, 150]}],
        "drive": {"at": [0, 0, -20]},
        "rollers": rollers_between(),
        "preload": [{"pair": [f"{end}L", f"{end}R"], "force": "1 kN"} for end in "FR"],
        "cases": [
            {"name": "start", "share": 0.1, "acceleration": "2 m/s2"},
            {"name": "curve", "share": 0.2, "speed": "1 m/s", "curve_radius": "1.5 m"},
            {"name": "run", "share": 0.7, "speed": "1 m/s"},
        ],
    }
    return copy.deepcopy(values) | changed


def cart(**changed):
    """Return a cart of 40 kg that stands on four rollers, with some keys changed."""
    values = {
        "name": "cart",
        "mass": {"value": "40 kg", "at": [0, 0, 60]},
        "drive": {"at": [0, 0, 0]},
        "rollers": rollers_below(),
        "cases": [{"name": "stand"}],
    }
    return copy.deepcopy(values) | changed
