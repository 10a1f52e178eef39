"""Figures of patches whose pressure was solved on a grid show where these lie, not an ellipse about x = 0."""

from __future__ import annotations

import re

import numpy as np
import pytest
from matplotlib.patches import PathPatch
from reference_cases import solve_sliding

import trackroller as tr
from trackroller.report.figures import style
from trackroller.report.figures.contact import friction_energy, shear_arrows
from trackroller.report.figures.contact_outline import DrawnPatch, outline, widths
from trackroller.report.figures.contact_sections import sections, surface_stress
from trackroller.results.case_columns import at_surface

OUTPUTS = ("forces", "contact", "friction_work", "peak_stress", "tractions", "subsurface")
EDGED = {"motor_force": -15, "roller_profile": {"arc": -7, "edge": {"outer": 0.1}}}


@pytest.fixture(scope="module")
def edged():
    return solve_sliding(tr.Case(**EDGED), OUTPUTS, normal="halfspace", accuracy="preview")


def loaded_x(ds, contact: int) -> tuple[float, float]:
    part = ds.sel(contact=contact)
    x, bears = part["patch_x"].values, (part["pressure"].values > 0.01 * float(part["max_pressure"])).any(axis=0)
    return x[bears].min(), x[bears].max()


def test_the_outline_encloses_all_that_bears_and_little_more(edged):
    for contact in (1, 2):
        patch = DrawnPatch(edged, contact)
        low, high = loaded_x(edged, contact)
        assert abs(low + high) > 0.1  # far from symmetric
        step = patch.x[1] - patch.x[0]
        ends = outline(patch).get_extents()
        assert ends.x0 == pytest.approx(low - step / 2) and ends.x1 == pytest.approx(high + step / 2)
        x, y = np.meshgrid(patch.x, patch.y)
        within = outline(patch).contains_points(np.column_stack([x.ravel(), y.ravel()])).reshape(x.shape)
        assert np.array_equal(within, patch.inside)


def test_maps_and_the_running_track_show_the_whole_patch(edged):
    ends = [loaded_x(edged, contact) for contact in (1, 2)]
    for draw in (shear_arrows, friction_energy):
        with style.look():
            figure, info = draw(edged)
        maps = [axes for axes in figure.axes if axes.get_title(loc="left").startswith("Contact")]
        for axes, (low, high) in zip(maps, ends, strict=True):
            assert axes.get_xlim()[0] < low and axes.get_xlim()[1] > high
            outline = [p for p in axes.patches if isinstance(p, PathPatch)]
            assert len(outline) == 1 and outline[0].get_path().get_extents().x1 > high
        assert "ellips" not in info.caption
    across = next(axes for axes in figure.axes if axes.get_title(loc="left") == "Across the running track")
    assert across.get_xlim()[0] < min(low for low, _ in ends) and across.get_xlim()[1] > max(high for _, high in ends)


def test_the_energy_told_is_that_of_the_case(edged):
    """Elements are summed, not joined by trapezoids that leave half of each outermost one away."""
    _, info = friction_energy(edged)
    energy = edged["friction_energy_per_distance"].values
    told = [float(number) for number in re.findall(r"([\d.]+) J/m", info.sentence)]
    assert told == pytest.approx(energy.tolist(), rel=0.03)


def test_the_bar_over_a_section_is_the_patch(edged):
    figure, _ = sections(edged, 2)
    low, high = loaded_x(edged, 2)
    bars = [line.get_xdata() for line in figure.axes[0].lines if len(line.get_xdata()) == 2]
    assert len(bars) == 1
    step = np.diff(edged["patch_x"].sel(contact=2).values)[0]
    assert bars[0] == pytest.approx([low - step / 2, high + step / 2])
    bare = edged.drop_vars(["pressure", "patch_x", "patch_y"])  # then about the middle of the section
    (found,) = widths(bare.sel(contact=2, body="roller"), "x")
    assert found == pytest.approx(bars[0], abs=step)


def test_the_surface_map_shows_the_peaks_of_solved_patches(edged):
    for contact, body in ((1, "roller"), (1, "guide"), (2, "roller"), (2, "guide")):
        part = edged.sel(contact=contact, body=body)
        assert at_surface(part) == 1
        assert surface_stress(edged, contact, body)[2].max() == pytest.approx(float(part["peak_stress"]), rel=0.01)


def test_two_strips_are_drawn_apart(edged):
    ds = edged.copy(deep=True)
    ds["pressure"].values[:, :, 9:12] = 0.0
    patch = DrawnPatch(ds, 1)
    assert len(outline(patch).to_polygons()) == 2
    assert len(widths(ds.sel(contact=1), "x")) == 2 and len(widths(ds.sel(contact=1), "y")) == 1


def test_the_spin_pole_is_shown_for_the_model_that_has_one(edged):
    assert DrawnPatch(edged, 1).spin_pole is not None
    assert "spin pole" in shear_arrows(edged)[1].caption
    used = edged.contact_model_used
    other = used.copy(data=np.int8(used.attrs["flag_meanings"].split().index("kalker_table")))
    rolling = edged.assign_attrs(contact_model="kalker").assign(contact_model_used=other)
    assert DrawnPatch(rolling, 1).spin_pole is None
    assert "spin pole" not in shear_arrows(rolling)[1].caption
    assert DrawnPatch(edged.assign(contact_model_used=other), 1).spin_pole is None
