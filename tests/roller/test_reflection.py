"""Mirrored rollers have mirrored numbers, bit for bit; without shortcuts the equations show the same symmetry."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import trackroller as tr
from trackroller.roller.case import to_table
from trackroller.roller.dataset import VARIABLES
from trackroller.roller.reflection import handed, reflect
from validation.benchmarks.samples import geometry_study, random_designs

PLAIN = ("forces", "contact", "friction_work", "peak_stress", "life")
EVERY = (*PLAIN, "tractions", "subsurface")
EDGES = [tr.Case(motor_force=-90.0), tr.Case(axial_force=150.0), tr.Case(friction_coefficient=0.0), tr.Case()]


def both(cases, **options):
    """Return the reflected results of cases, those of their mirror images, and both data sets."""
    images = [dataclasses.replace(case, axial_force=-case.axial_force) for case in cases]
    found = [tr.solve(several, **options) for several in (cases, images)]
    names = [name for name in found[0].data_vars if name in VARIABLES]
    one, two = ({n: ds[n].transpose("case", *VARIABLES[n].dims).values for n in names} for ds in found)
    reflect(one, np.ones(len(cases), bool))
    return one, two, found


@pytest.mark.long
@pytest.mark.parametrize(
    ("model", "count", "outputs", "options"),
    [
        ("sliding", 30, PLAIN, {}),
        ("kalker_table", 20, PLAIN, {}),
        ("kalker", 20, PLAIN, {}),
        ("kalker", 2, EVERY, {}),
        ("kalker", 1, EVERY, {"normal": "halfspace", "accuracy": "preview"}),
    ],
)
def test_mirrored_rollers_have_mirrored_bits(model, count, outputs, options):
    cases = random_designs(count, 501) + geometry_study(count // 2, 8) + EDGES[: 4 if "normal" not in options else 1]
    one, two, (first, second) = both(cases, outputs=outputs, contact_model=model, **options)
    for name, values in one.items():
        np.testing.assert_array_equal(values, two[name], err_msg=name)
    for name in ("regime", "converged", "validity"):
        np.testing.assert_array_equal(first[name], second[name], err_msg=name)


@pytest.mark.long
def test_the_equations_have_the_symmetry_that_the_reflection_assumes():
    """Solved on both sides, each result changes its side, sign and order as its declaration says."""
    cases = [tr.Case(axial_force=30.0), tr.Case(axial_force=12.0, motor_force=0.0, friction_coefficient=0.15)]
    one, two, _ = both(cases, outputs=EVERY, contact_model="sliding", accuracy="reference", shortcuts=False)
    for name, values in one.items():
        if name in ("residual", "error_estimate", "life_error_estimate", "energy_residual"):
            continue
        size = np.nanmax(np.abs(values), initial=0.0)
        np.testing.assert_allclose(values, two[name], atol=2e-3 * size, rtol=2e-3, err_msg=name)


def test_profiles_that_differ_on_both_sides_have_no_mirror_image():
    heights = [[x, -(x**2) / 12.0 - 0.01 * max(x, 0.0)] for x in np.linspace(-5.5, 5.5, 41)]
    drawn = tr.Case(axial_force=-20.0, guide_profile={"points": heights, "frame": "section"})
    table, mirrored = handed(to_table([drawn, tr.Case(axial_force=-20.0), tr.Case(axial_force=0.0)]))
    assert mirrored.tolist() == [False, True, False]
    assert table.axial_force.tolist() == [-20.0, 20.0, 0.0]


def test_the_ends_of_shorter_grids_stay_at_the_end():
    values = {"patch_x": np.array([[[1.0, 2.0, np.nan], [3.0, 4.0, np.nan]], [[1.0, 2.0, 5.0], [3.0, 4.0, 6.0]]])}
    reflect(values, np.array([True, True]))
    expected = [[[-4.0, -3.0, np.nan], [-2.0, -1.0, np.nan]], [[-6.0, -4.0, -3.0], [-5.0, -2.0, -1.0]]]
    np.testing.assert_array_equal(values["patch_x"], expected)
