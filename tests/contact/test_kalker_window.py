"""Finer elements around an adhesion area of few elements give its peak on any number of elements of the patch."""

from __future__ import annotations

import dataclasses
from itertools import islice

import numpy as np
import pytest

import trackroller as tr
from trackroller.contact.common import Elastic, Ellipse
from trackroller.contact.kalker import subgrid, window
from trackroller.contact.kalker.patch import solve_patch
from trackroller.contact.kalker.problem import KalkerSettings
from trackroller.contact.slip import Creepage
from trackroller.roller.accuracy import Tolerance
from validation.benchmarks.samples import random_designs

MU, G, NU = 0.5, 8e4, 0.3
PATCH = Ellipse(np.array([1.0]), np.array([0.6]), np.array([800.0]))
CREEP = Creepage(np.array([0.0]), np.zeros(1), np.array([0.15]))  # the adhesion area is far smaller than the patch
SETTINGS = KalkerSettings(elements=28, tolerance=1e-6)
BOUND = MU * 800.0 / G


def solution(elements):
    settings = dataclasses.replace(SETTINGS, elements=elements)
    elastic = Elastic(np.array([G]), np.array([NU]), np.zeros(1))
    return solve_patch(PATCH, CREEP, MU, elastic, settings)


def areas(elements, levels):
    """Return the share of the adhesion area in the box around the patch, one for each window."""
    found = window.fields(PATCH, solution(elements), NU, BOUND, SETTINGS)
    return [count / (elements * 2**level) ** 2 for level, (_, count) in enumerate(islice(found, levels), start=1)]


def test_windows_find_the_area_of_a_far_finer_patch():
    """28 and 112 elements with windows agree; 28 and 112 elements alone see no element that sticks."""
    few, many = areas(28, 5)[-1], areas(112, 3)[-1]
    assert few == pytest.approx(many, rel=0.02)
    assert not any(solution(elements).stick.any() for elements in (28, 112))


def test_the_area_converges_with_the_windows():
    first, second, third = areas(28, 5)[2:]
    assert abs(third - second) < 0.1 * abs(third - first)


def test_a_window_of_a_resolved_area_keeps_the_tractions():
    """Where the elements of the patch suffice, a window changes the tractions little, and its edge adds no step."""
    slow = Creepage(np.array([0.0]), np.zeros(1), np.array([0.02]))
    elastic = Elastic(np.array([G]), np.array([NU]), np.zeros(1))
    coarse = solve_patch(PATCH, slow, MU, elastic, dataclasses.replace(SETTINGS, elements=56))
    (made, _), *_ = islice(window.fields(PATCH, coarse, NU, BOUND, SETTINGS), 1)
    field, _ = made()
    fine = solve_patch(PATCH, slow, MU, elastic, dataclasses.replace(SETTINGS, elements=112))
    same = subgrid.shares(subgrid.fields_of(PATCH, fine), field.shape[-1] // 112)
    height = np.sqrt(np.maximum(1.0 - np.add.outer(*2 * [np.linspace(-1, 1, field.shape[-1]) ** 2]), 0.0))
    apart = np.hypot(*(field - same[..., : field.shape[-2], :])[0]) * height
    assert np.percentile(apart, 99) < 0.01 and apart.max() < 0.1


@pytest.mark.parametrize("number", [18, 49])
def test_peaks_do_not_depend_on_the_elements_of_the_patch(number):
    """Peaks at the spin pole from 28 and 80 elements; without windows they differ by up to 2 %."""
    case = random_designs(number + 1, 4711)[number]
    own = dataclasses.replace(Tolerance(1e-2, 3e-3).settings(), doublings=0)
    peaks = {}
    for goal in (3e-3, np.inf):
        for elements in (28, 80):
            settings = dataclasses.replace(own, elements=elements, peak_goal=goal)
            peaks[elements, goal] = tr.solve(case, ("peak_stress",), accuracy=settings).peak_stress.values
    apart = {goal: np.abs(peaks[28, goal] / peaks[80, goal] - 1.0).max() for goal in (3e-3, np.inf)}
    assert apart[3e-3] < 3e-3
    assert apart[np.inf] > 2.0 * apart[3e-3]
