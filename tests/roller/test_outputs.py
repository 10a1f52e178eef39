"""Outputs: every declared result is computed and the other way round, and the drive torque closes the power balance."""

from __future__ import annotations

import math

import numpy as np
import pytest
from limit_rows import part_of
from reference_cases import solve_sliding

import trackroller as tr
from trackroller.parameters import OPTIONS
from trackroller.results.roller_answer import answer_of_roller
from trackroller.roller import solver
from trackroller.roller.dataset import FLAGS, VARIABLES, shown

EVERY = tuple(OPTIONS["outputs"].values)
RADIUS = 21.75 - 6.0 * math.cos(math.radians(30.0))  # r_A of the example [mm]


def test_every_declared_output_has_a_value_and_every_value_a_declaration(monkeypatch):
    """A forgotten declaration would drop a result without a word, a forgotten formula would leave a gap."""
    seen = {}
    assemble = solver.assemble
    monkeypatch.setattr(solver, "assemble", lambda block, *rest: seen.update(block.values) or assemble(block, *rest))
    found: set[str] = set()
    for criterion in ("von_mises_peak", "findley"):
        found |= set(tr.solve(tr.Case(), EVERY, accuracy="preview", life_criterion=criterion).variables)
    found |= set(tr.solve(tr.Case(), ("forces", "contact"), accuracy=0.01).variables)
    assert set(VARIABLES) <= found
    assert set(seen) <= set(VARIABLES) | set(FLAGS)


@pytest.mark.slow
def test_what_is_shown_stands_on_the_sheet_with_its_value():
    ds = solve_sliding(tr.Case())
    answer = answer_of_roller(ds)
    whole = part_of(answer, "whole").set_index("quantity")
    assert len(whole) == len([name for name in shown() if name in ds])
    peaks = 4  # stress and depth of roller and guide
    assert len(part_of(answer, "contacts")) == len([name for name in shown("contact") if name in ds]) + peaks
    torque = whole.loc["drive torque about the roller's axis M_xR"]
    assert torque["value"] == float(ds.drive_torque) and torque["units"] == "N mm"


@pytest.mark.parametrize("motor", [-30.0, 0.0, 25.0])
@pytest.mark.parametrize("model", ["kalker", "kalker_table"])
def test_the_drive_gives_the_power_of_the_transmitted_force_and_of_friction(motor, model):
    """M_xR / r_A = (1 + xi) F_A + W_f per distance, with W_f integrated over the patches."""
    case = tr.Case(motor_force=motor)
    ds = tr.solve(case, ("forces", "friction_work"), contact_model=model, accuracy="preview")
    assert float(ds.drive_torque) == pytest.approx(-motor * RADIUS, abs=1e-6 * 200 * RADIUS)
    transmitted, friction = (
        (1 + float(ds.slip)) * float(ds.transmitted_force),
        float(ds.friction_energy_per_distance.sum()),
    )
    assert float(ds.drive_torque) / RADIUS - transmitted == pytest.approx(friction, rel=2e-2)


def test_a_roller_without_motor_is_pulled_by_its_rolling_resistance():
    """The force along the track is all that moves it, so that it does the work of friction."""
    cases = [tr.Case(motor_force=0, friction_coefficient=mu, axial_force=force) for mu, force in ((0.1, 0), (0.3, 30))]
    ds = tr.solve(cases, ("forces", "friction_work"))
    pulled = -(1 + ds.slip) * ds.transmitted_force
    assert ds.rolling_resistance.values == pytest.approx(pulled.values, rel=2e-3)
    assert ds.rolling_resistance.values == pytest.approx(
        ds.friction_energy_per_distance.sum("contact").values, rel=1e-15
    )


def test_rolling_resistance_takes_in_hysteresis_where_heat_is_asked_for():
    case = tr.Case(motor_force=0)
    plain, warm = (
        tr.solve(case, ("forces", "friction_work", *more), contact_model="sliding") for more in ((), ("heat",))
    )
    lost = float(warm.hysteresis_moment.sum()) / RADIUS
    assert lost > 0 and float(warm.rolling_resistance - plain.rolling_resistance) == pytest.approx(lost, rel=1e-9)


def test_the_drive_torque_is_the_moment_of_the_tractions_about_the_axis():
    """Integrate r x tau over both patches in the frame of the roller."""
    ds = solve_sliding(tr.Case(axial_force=-20), ("forces", "tractions"))
    alpha, whole = math.radians(30.0), 0.0
    for contact, side in ((1, 1.0), (2, -1.0)):
        own = ds.sel(contact=contact)
        x, y = own.patch_x.values, own.patch_y.values
        along = np.array([0.0, side * -math.sin(alpha)])  # y_R and z_R of the lateral direction of the contact
        shear = own.shear_lateral.values, own.shear_rolling.values
        depth = -RADIUS + x[None, :] * along[1]  # z_R of a point
        moment = y[:, None] * shear[0] * along[1] - depth * shear[1]
        whole += float(np.nansum(moment) * (x[1] - x[0]) * (y[1] - y[0]))
    assert whole == pytest.approx(float(ds.drive_torque), rel=5e-3)


def test_full_slip_takes_no_more_than_friction():
    ds = solve_sliding(tr.Case(motor_force=-300), ("forces",))
    assert float(ds.drive_torque) == pytest.approx(0.3 * float(ds.normal_force.sum()) * RADIUS, rel=1e-9)
    assert float(ds.drive_torque) < 300 * RADIUS
