"""Peaks with a large estimated error are searched again on twice the elements, others are not."""

import dataclasses

import numpy as np
import pytest

import trackroller as tr
from trackroller.roller.accuracy import PRESETS
from trackroller.roller.stages import ellipse_stresses
from validation.benchmarks.samples import random_designs

RIDGE = random_designs(74, 17)[73]  # 2 % of the patch sticks: 28 elements show a ridge at the surface that is too high
SMOOTH = tr.Case(friction_coefficient=0.1)  # the peak lies below the surface
OUTPUTS = ("forces", "peak_stress", "subsurface")
ELEMENTS = PRESETS["standard"].elements


def solved(monkeypatch, case, accuracy="standard", **options):
    """Return the results and the elements of each search, 3 points of the traction to an element."""
    searched = []
    plain = ellipse_stresses.find_peaks

    def recorded(patches, ratios, settings, fields=None, coarse=None):
        searched.append(fields.shape[-1] // 3)
        return plain(patches, ratios, settings, fields, coarse)

    monkeypatch.setattr(ellipse_stresses, "find_peaks", recorded)
    found = tr.solve(case, OUTPUTS, accuracy=accuracy, **({"contact_model": "kalker"} | options))
    monkeypatch.setattr(ellipse_stresses, "find_peaks", plain)
    return found, searched


@pytest.fixture
def ridge(monkeypatch):
    return solved(monkeypatch, RIDGE)


def test_a_ridge_is_refined_and_a_smooth_peak_is_not(monkeypatch, ridge):
    assert ridge[1] == [ELEMENTS, 2 * ELEMENTS]
    assert solved(monkeypatch, SMOOTH)[1] == [ELEMENTS]
    assert solved(monkeypatch, RIDGE, contact_model="kalker_table")[1] == [ELEMENTS]


def test_refinement_brings_the_peak_to_the_finer_elements(monkeypatch, ridge):
    fine, _ = solved(monkeypatch, RIDGE, dataclasses.replace(PRESETS["reference"], elements=2 * ELEMENTS))
    monkeypatch.setattr(ellipse_stresses, "REFINED_ERROR", np.inf)
    rough, searched = solved(monkeypatch, RIDGE)
    assert searched == [ELEMENTS]
    before, after = (np.abs(found.peak_stress / fine.peak_stress - 1.0).max().item() for found in (rough, ridge[0]))
    assert after < 0.004 < before < 0.03
    assert ridge[0].error_estimate.max() < 0.5 * rough.error_estimate.max()
    for name in ("normal_force", "lateral_force", "driving_force"):
        assert (ridge[0][name] == rough[name]).all()


def test_sections_show_the_refined_peak(ridge):
    """The points of the sections lie beside the peak, so that their largest stress is a little below it."""
    found, _ = ridge
    np.testing.assert_allclose(found.von_mises_xz.max(("section_z", "section_x")), found.peak_stress, rtol=0.05)


def test_four_sections_solve_a_refined_patch_once(monkeypatch):
    solved_again, plain = [], ellipse_stresses.EllipseStresses._shares

    def recorded(self, flat, ask):
        solved_again.extend(flat.tolist() if ask.__name__ == "finer_shares" else [])
        return plain(self, flat, ask)

    monkeypatch.setattr(ellipse_stresses.EllipseStresses, "_shares", recorded)
    tr.solve(RIDGE, OUTPUTS, contact_model="kalker")
    refined = solved_again[: len(set(solved_again))]  # by the search
    assert refined
    assert solved_again == 2 * refined


def test_a_patch_that_does_not_converge_on_finer_elements_keeps_its_peak(monkeypatch, ridge):
    plain = ellipse_stresses.EllipseStresses._shares

    def failing(self, flat, ask):
        found = plain(self, flat, ask)
        return (*found[:2], np.zeros(len(flat), bool)) if len(found) > 2 else found

    monkeypatch.setattr(ellipse_stresses.EllipseStresses, "_shares", failing)
    kept, searched = solved(monkeypatch, RIDGE)
    assert searched == [ELEMENTS, 2 * ELEMENTS]
    assert (kept.error_estimate > ellipse_stresses.REFINED_ERROR).any()
    assert (kept.peak_stress != ridge[0].peak_stress).any()
