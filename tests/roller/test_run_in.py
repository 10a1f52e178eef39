"""The flag `worn` holds for the life of a roller over all its load cases, not for each load case alone."""

from __future__ import annotations

import numpy as np
import pytest
from carriage.carts import cart

import trackroller as tr
from trackroller.carriage.file import load_carriage
from trackroller.carriage.solve import cases_of, forces_of, with_lives
from trackroller.results.spectrum_answer import answer_of_spectrum
from trackroller.roller.dataset import validity_bit
from trackroller.study.spectrum.file import Spectrum
from trackroller.study.spectrum.solve import solve_spectrum

FAST = {"contact_model": "sliding", "accuracy": "preview"}
BASE = {
    "velocity": 60, "motor_force": 0, "roller_material": "POM", "friction_coefficient": 0.15,
    "permissible_wear_depth": 0.2, "guide_overrollings_per_hour": 100,
}  # fmt: skip
LOADS = {"heavy": {"radial_force": -60, "axial_force": 10}, "light": {"radial_force": -10, "axial_force": 0}}
GROUPS = ("forces", "peak_stress", "life", "limits", "wear")
WORN = validity_bit("worn")


@pytest.fixture(scope="module")
def alone():
    """Return the result of each load alone."""
    return {name: tr.solve(BASE | loads, GROUPS, **FAST) for name, loads in LOADS.items()}


# metres a shift; under the heavy load alone the roller outlives no groove, under the light one it does
@pytest.mark.parametrize(
    ("heavy", "light"), [(1000, 1000), (1000, 0.1), (0.1, 1000), (1, 10_000), (0, 1000), (1000, 0)]
)
def test_a_spectrum(alone, heavy, light):
    assert [(int(one.validity_body.sel(body="roller")) & WORN) != 0 for one in alone.values()] == [False, True]
    metres = {"heavy": heavy, "light": light}
    blocks = [{"name": name, "distance": metres[name]} | loads for name, loads in LOADS.items()]
    ds = solve_spectrum(Spectrum.from_dict({"base": BASE, "blocks": blocks, **FAST}))
    used = sum(metres[name] / 1000 / float(one.run_in_distance) for name, one in alone.items())
    worn = ds.life_to_first_limit_shifts.values > 1 / used
    assert ((ds.validity_body.values & WORN) != 0).tolist() == [worn.tolist()] * 2
    assert ((ds.validity.values & WORN) != 0).tolist() == [worn.any()] * 2
    told = [
        one.where for one in answer_of_spectrum(ds).warnings if "The groove wears away within the life" in one.where
    ]
    assert [("of the roller" in text, "the guide" in text) for text in told] == [tuple(worn)]


def test_other_flags_stay(alone):
    """Without a limit of wear nothing is judged anew."""
    blocks = [{"name": name, "distance": 1000} | loads for name, loads in LOADS.items()]
    base = {name: value for name, value in BASE.items() if name != "permissible_wear_depth"}
    ds = solve_spectrum(Spectrum.from_dict({"base": base, "blocks": blocks, **FAST}))
    assert ((ds.validity.values & WORN) == 0).all()
    flags = np.array([int(one.validity) for one in alone.values()])
    assert ((ds.validity.values & ~WORN) == (flags & ~WORN)).all()


@pytest.mark.parametrize("share", [0.5, 0.001])
def test_a_carriage(share):
    """Half of the travel, or a thousandth of it, with a load under which the roller fails before its groove wears."""
    roller = FAST | {name: value for name, value in BASE.items() if name != "velocity"}
    cases = [
        {"name": "loaded", "share": share, "speed": "1 m/s", "payload": 1},
        {"name": "empty", "share": 1 - share, "speed": "1 m/s", "payload": 0},
    ]
    down = {"pushes": [0, 0, -1], "x_R": [0, 1, 0], "roller": roller}
    rollers = {f"{x}{y}": {"at": [x, y, 0], **down} for x in (-150, 150) for y in (-40, 40)}
    payloads = [{"value": 24, "at": [0, 0, 60]}]
    whole = load_carriage(cart(mass={"value": 4, "at": [0, 0, 60]}, payloads=payloads, cases=cases, rollers=rollers))
    forces = forces_of(whole)
    ds = with_lives(forces, whole)
    flagged = (ds.roller_validity.values & WORN) != 0
    for j in range(4):
        alone = [tr.solve(case, GROUPS, **FAST) for (_, own), case in cases_of(whole, forces).items() if own == j]
        assert [(int(one.validity_body.sel(body="roller")) & WORN) != 0 for one in alone] == [False, True]
        run_in = 1 / sum(share / float(one.run_in_distance) for share, one in zip(ds.share.values, alone, strict=True))
        assert ds.first_body.values[j] == "roller", "the life is that of the roller itself"
        worn = float(ds.life_km[j]) > run_in
        assert worn == (share < 0.5)
        assert flagged[:, j].tolist() == [worn] * 2
