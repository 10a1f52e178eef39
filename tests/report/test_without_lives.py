"""What a report says of studies without lives: stresses of several materials, targets on forces, values not given."""

import functools

import numpy as np
import pytest

import trackroller as tr

STEEL, ALUMINIUM = ["1.7225-quenched-tempered", "42CrMo4+QT-100"], ["EN AW-7075", "42CrMo4+QT-100"]
LOADS = {"radial_force": {"values": [-60, -120, -180]}, "friction_coefficient": {"values": [0.1, 0.2]}}
BASE = {"guide_curve_radius": 300, "motor_force": 0, "axial_force": 15}


@functools.cache
def _solved(pairs, outputs, target, base, angles):
    study = {"name": "made", "base": dict(base), "outputs": list(outputs), "contact_model": "sliding"}
    study |= {"accuracy": "preview", "analysis": {"target": {n: dict([end]) for n, end in target}}}
    choices = {"roller_profile_radius": {"values": [-6.3, -7.3]}}
    if angles:
        choices = {"contact_angle": {"values": list(angles)}}
    if pairs:
        choices["material_pair"] = {"values": [list(pair) for pair in pairs]}
    return tr.run(study | {"factors": choices | LOADS}, progress=False)


def solved(pairs=(STEEL, ALUMINIUM), outputs=("peak_stress",), target=None, base=BASE, angles=()):
    """Return a solved grid; `target` has one end for each output."""
    ends = tuple((name, next(iter(own.items()))) for name, own in (target or {}).items())
    return _solved(tuple(map(tuple, pairs)), outputs, ends, tuple(base.items()), angles)


def largest(results, name, by):
    """Return the largest value of an output by a factor, over all rows."""
    table = results.table.assign(value=np.abs(results.quantity(name)[0].astype(float)))
    return table.groupby(by, sort=False)["value"].max()


def row(table, head):
    """Return the cells of a row of a table."""
    return next(cells[1:] for cells in table.rows if str(cells[0]).startswith(head))


# stresses


def test_stresses_rank_grooves_of_one_material():
    results = solved(pairs=())
    stress = largest(results, "peak_stress_roller", "roller_profile_radius")
    found = results.answer
    assert (found.kind, found.table["roller_profile_radius"].iloc[0]) == ("build", stress.idxmin())
    assert found.table["low"].iloc[0] == pytest.approx(stress.min())
    assert len(results.best()) == 2


# targets on forces


FORCE = "normal_force_1"


def on_force(least, outputs=("forces",)):
    """Return a study with a target on a force at three angles, and the number of conditions that each meets."""
    angles = (25, 35, 45)
    base = {"guide_curve_radius": 300, "motor_force": 0, "axial_force": 30}
    results = solved((), outputs, {FORCE: {"min": least}}, base, angles)
    force = results.quantity(FORCE)[0].astype(float)
    rolls = results.data["regime"].values.ravel() == 0
    met = results.table.assign(met=rolls & (force >= least)).groupby("contact_angle")["met"].sum()
    return results, met, force, rolls


# values that were not given


# one convention in tables
