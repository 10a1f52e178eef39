"""Points off the curve, scatter and rounding are found; kinks, chamfers and roundings are not taken for them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from written_profiles import curve_of

import trackroller as tr
from trackroller.contact.drawn_profiles import cross_section
from trackroller.contact.measured_points import TOLD, examined, gap, in_order, noise_of, waves
from trackroller.contact.profiles import canonical
from trackroller.materials import load_database
from trackroller.roller.doubts import doubts_of_case

X = np.round(np.arange(-90, 91) * 0.05, 2)
Z = np.round(np.sqrt(36.0 - X * X), 6)


def refusal(x: np.ndarray, z: np.ndarray, **entries) -> str:
    """Return why points are refused, '' if they are not."""
    try:
        canonical({"points": np.column_stack([x, z]).tolist(), "frame": "contact"} | entries, "guide_profile")
    except tr.InputError as error:
        return str(error)
    return ""


def changed(places: slice | int, by: float) -> np.ndarray:
    z = Z.copy()
    z[places] += by
    return z


@pytest.mark.parametrize("length", [1, 2, 3, 4, 5])
@pytest.mark.parametrize("off", [5e-4, -5e-3, 0.1, -5.0])
def test_specks_and_lost_points_are_named(length, off):
    for place in (20, 40, 90, 130, 155):
        found = examined(X, changed(slice(place, place + length), off))
        assert [(run.first, run.last) for run in found.runs] == [(place, place + length - 1)]
        assert found.runs[0].off == pytest.approx(abs(off), rel=0.2)
    told = refusal(X, changed(40, -5.0))
    assert "point 41 (-2.5, 0.454356)" in told and "lies 5 mm off its neighbours" in told and "Leave out lost" in told


@pytest.mark.parametrize("length", [2, 3, 4, 5])
@pytest.mark.parametrize(("off", "noise"), [(1e-3, 0.0), (-5e-3, 0.0), (-5e-3, 1e-6)])
def test_specks_at_the_ends_are_asked_about(length, off, noise):
    """A speck on the outermost points, whole or cut off; a chamfer or a rounding of the same size is shape."""
    scatter = noise * np.random.default_rng(5).standard_normal(X.size)
    along = np.arange(1, length + 1)
    for speck in (np.ones(length), np.sin(np.pi * along / (length + 1))):
        for places, bump in ((slice(-length, None), speck), (slice(0, length), speck[::-1])):
            z = changed(places, off * bump) + scatter
            [run] = examined(X, z).at_ends
            first = range(X.size)[places][0]
            assert (run.first, run.last) == (first, first + length - 1)
            assert run.off == pytest.approx(abs(off) * bump.max(), rel=0.4)
            if length == 5 and bump.min() == 1.0:  # long enough for a step
                assert "have a step between them" in refusal(X, z)
            else:
                assert "µm off the curve of the points beside them; if they are a speck, leave" in asked(X, z)
    for shape in (along, along**2 / length):
        assert not examined(X, changed(slice(-length, None), -abs(off) * shape) + scatter).at_ends


@pytest.mark.parametrize("places", [slice(0, 1), slice(0, 5), slice(178, 181), slice(179, 180), slice(60, 90)])
@pytest.mark.parametrize("mark", [0.0, -9999.0, 9999.0])
def test_lost_points_at_the_ends_and_long_runs_are_jumps(places, mark):
    z = Z.copy()
    z[places] = mark
    assert "of one curve" in refusal(X, z)
    lost = X.copy()
    lost[150] = mark
    assert refusal(lost, Z)


@pytest.mark.parametrize("height", [1e-3, -5e-3, 0.05])
@pytest.mark.parametrize("place", [15, 60, 91, 150])
def test_steps_of_the_height_are_named(height, place):
    found = examined(X, changed(slice(place, None), height))
    assert found.jumps == (place - 1,) and not found.runs
    assert f"points {place} to {place + 1}" in refusal(X, changed(slice(place, None), height))


def test_marks_that_no_length_reaches_are_refused():
    assert "finite numbers below" in refusal(X, changed(50, 1e30))


def test_smooth_0_says_that_every_point_is_meant():
    rough = Z + np.random.default_rng(1).normal(0.0, 1e-3, X.size)
    for z in (changed(40, -5.0), rough):
        assert refusal(X, z) and not refusal(X, z, smooth=0)
        profile = {"points": np.column_stack([X, z]).tolist(), "frame": "contact", "smooth": 0}
        kept = canonical(profile, "guide_profile")
        assert kept["smooth"] == 0 and canonical(kept, "guide_profile") == kept
        assert doubts_of_case(tr.Case(guide_profile=profile), load_database())
    clean = canonical({"points": np.column_stack([X, Z]).tolist(), "smooth": 0}, "guide_profile")
    assert "smooth" not in clean


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(40))
def test_clean_curves_with_edges_pass(seed):
    r = np.random.default_rng(seed)
    curve, half, *_ = curve_of(r)
    for count in (45, 181, 901):
        x = np.linspace(-half, half, count)
        found = examined(x, curve(x))
        assert not found.at_ends and not found.runs and not found.jumps and found.roughness < TOLD


def test_circles_with_few_points_and_up_to_the_equator_pass():
    for count in (5, 7, 11, 19, 41):
        x = np.linspace(-6.0, 6.0, count)
        assert not refusal(x, np.sqrt(36.0 - x * x))


@pytest.mark.parametrize("spacing", [0.01, 0.05, 0.2])
@pytest.mark.parametrize("rough", [2e-3, 1e-2])
def test_noise_is_refused_with_its_size(spacing, rough):
    x = np.arange(-4.5, 4.5 + spacing / 2, spacing)
    noise = rough * spacing
    z = np.sqrt(36.0 - x * x) + np.random.default_rng(3).normal(0.0, noise, x.size)
    told = refusal(x, z)
    assert "guide_profile.smooth is missing" in told and "smooth: auto" in told and "smooth: 0 if" in told
    assert float(told.split("scatter by ")[1].split(" um")[0]) == pytest.approx(1e3 * noise, rel=0.35)
    assert not refusal(x, z, smooth="auto") and not refusal(x, z, smooth=noise)


@pytest.mark.parametrize(
    ("digits", "spacing", "said"), [(3, 0.05, "refused"), (4, 0.1, "told"), (5, 0.05, ""), (6, 0.01, "")]
)
def test_rounding_is_noise_where_it_matters(digits, spacing, said):
    x = np.round(np.arange(-4.5, 4.5 + spacing / 2, spacing), 6)
    profile = {"points": np.column_stack([x, np.round(np.sqrt(36.0 - x * x), digits)]).tolist()}
    if said == "refused":
        with pytest.raises(tr.InputError, match=r"scatter by 0\.2\d* um"):
            tr.Case(guide_profile=profile)
    else:
        told = doubts_of_case(tr.Case(guide_profile=profile), load_database())
        assert any("scatter" in text for text in told) == (said == "told")


def test_heights_on_a_grid_are_no_rounded_ones():
    x = np.round(np.arange(-60, 61) * 0.05, 2)
    chamfer = np.round(-np.maximum(np.abs(x) - 2.0, 0.0), 2)
    assert examined(x, chamfer).scatter == 0.0
    stairs = np.round(-x * x / 600.0, 3)  # a nearly straight roller in whole micrometres
    assert examined(x, stairs).scatter == pytest.approx(1e-3 / math.sqrt(12))
    assert noise_of(x, stairs) == pytest.approx(1e-3 / math.sqrt(12), rel=0.1), "smooth: auto sees the steps, too"


def test_points_are_sorted_and_told():
    points = np.column_stack([X, Z])
    straight = tr.Case(guide_profile={"points": points.tolist()})
    mixed = np.random.default_rng(0).permutation(points)
    for given, words in (
        (points[::-1], "run from large to small x"),
        (mixed, "do not run in one direction"),
        (np.insert(points, 7, points[7], axis=0), "1 of its 182 points stand twice"),
    ):
        case = tr.Case(guide_profile={"points": given.tolist()})
        assert any(words in text for text in doubts_of_case(case, load_database()))
        ways = [np.array(c.guide_profile["points"]) for c in (case, straight)]
        np.testing.assert_array_equal(*(way[in_order(way)] for way in ways))
    assert doubts_of_case(straight, load_database()) == []


def test_two_heights_and_outlines_are_refused():
    assert "has the x of point 8" in refusal(np.insert(X, 8, X[7]), np.insert(Z, 8, Z[7] + 0.01))
    there, back = X[:-1], X[1:-1][::-1] + 0.01
    outline = np.concatenate([there, back]), np.concatenate([Z[:-1], 0.5 * Z[1:-1][::-1]])
    for smooth in ({}, {"smooth": "auto"}):
        assert "turns back" in refusal(*outline, **smooth)


@pytest.mark.slow
def test_a_noisy_fine_trace_is_smoothed_before_it_is_turned():
    """Noise in fine steps turns back on a steep flank; the flank is not cut into pieces there."""
    x = np.arange(0.0, 5.4, 0.001)
    z = np.sqrt(36.0 - x * x) + np.random.default_rng(2).normal(0.0, 1e-3, x.size)
    profile = {"points": np.column_stack([x, z]).tolist(), "smooth": "auto", "frame": "section"}
    import json

    shape = cross_section(json.dumps(canonical(profile)), "guide_profile", 6.0, math.radians(55), 6.0, 1)
    assert shape.inner < -2.0 and shape.outer > 0.4
    u = np.linspace(-1.0, 0.4, 15)
    np.testing.assert_allclose(shape.slope(u), -u / np.sqrt(36 - u * u), atol=5e-3)


def asked(x: np.ndarray, z: np.ndarray, **entries) -> str:
    """Return what is asked about points."""
    profile = {"points": np.column_stack([x, z]).tolist(), "frame": "section"} | entries
    return " ".join(doubts_of_case(tr.Case(guide_profile=profile), load_database()))


@pytest.mark.parametrize(("noise", "step", "error"), [(5e-3, 0.05, 0.19), (5e-3, 0.2, 0.25), (1e-3, 0.2, 0.13)])
def test_noise_that_smoothing_cannot_remove_is_asked_about(noise, step, error):
    """The errors were measured, see `LOUD`; 0.1 µm at 0.05 mm changes the pressure by 5 %."""
    rng, x = np.random.default_rng(1), np.arange(-4.5, 4.5, step)
    z = np.sqrt(36.0 - x**2)
    loud = z + noise * rng.standard_normal(x.size)
    assert examined(x, loud).error_if_smoothed == pytest.approx(error, rel=0.15)
    assert "after smoothing, the pressure is wrong by about" in asked(x, loud, smooth="auto")
    assert asked(x, z + 1e-4 * rng.standard_normal(x.size), smooth="auto") == ""


@pytest.mark.parametrize(("height", "length"), [(3e-3, 0.5), (3e-3, 1.0), (1e-3, 0.5)])
@pytest.mark.parametrize("noise", [0.0, 5e-6])
def test_waves_are_told_with_their_size(height, length, noise):
    z = Z + height * np.sin(2.0 * np.pi * X / length) + noise * np.random.default_rng(2).standard_normal(X.size)
    found = waves(X, z, noise)
    assert found is not None
    assert found.length == pytest.approx(length, rel=0.3) and found.height == pytest.approx(height, rel=0.5)
    assert "waves of ±" in asked(X, z, smooth="auto")


def test_designed_curves_have_no_waves_however_their_points_lie():
    rng = np.random.default_rng(3)
    for _ in range(20):
        x = np.sort(rng.uniform(-4.5, 4.5, int(rng.integers(12, 300))))
        for z in (np.sqrt(36.0 - x**2), 0.1 * np.abs(x), np.where(np.abs(x) < 2, 0.0, (np.abs(x) - 2) ** 2 / 6)):
            assert waves(x, z, 0.0) is None
    assert waves(X, Z + 3e-6 * rng.standard_normal(X.size), 3e-6) is None


@pytest.mark.parametrize(("start", "end"), [(1.0, 4.0), (-2.0, -1.4)])
def test_a_length_without_points_is_told(start, end):
    kept = (X <= start) | (X >= end)
    assert X[kept][gap(X[kept])] == start
    assert f"no points lie between x = {start:g} and {end:g} mm" in asked(X[kept], Z[kept])
    assert gap(X) is None and gap(np.sort(np.concatenate([X[:60:3], X[60:]]))) is None
    assert gap(np.linspace(-3.0, 3.0, 31) ** 3) is None  # dense in the middle


def solved_groove(noise: float, count: int, **entries):
    """Return the data set of a groove of two arcs of 6.6 mm that was measured with noise [mm]."""
    x = np.linspace(-5.0, 5.0, count)
    z = np.sqrt(6.6**2 - (abs(x) + 0.6 * np.sin(np.pi / 6.0)) ** 2)
    z += np.random.default_rng(3).normal(0.0, noise, count)
    case = tr.Case(
        roller_profile={"points": np.column_stack((x, z)).tolist(), **entries}, friction_coefficient=0.2, motor_force=0
    )
    options = {"normal": "halfspace", "accuracy": "preview", "contact_model": "sliding", "outputs": ("contact",)}
    return tr.solve(case, **options)


def is_flagged(ds, name: str) -> bool:
    meanings = ds.validity.attrs["flag_meanings"].split()
    return bool(int(ds.validity) & int(ds.validity.attrs["flag_masks"][meanings.index(name)]))


@pytest.mark.parametrize(
    ("noise", "smooth", "flagged"),
    [
        (8e-4, 7.2e-4, True),  # slightly less than the noise: a multiple of the pressure
        (8e-4, "auto", False),
        (8e-4, 3e-3, False),
        (8e-4, 2e-2, True),  # far more than the noise: the shape itself is smoothed
        (2e-5, "auto", False),
        (2e-5, 1e-5, False),  # so little noise hardly matters
    ],
)
def test_a_pressure_that_changes_with_the_smoothing_is_flagged(noise, smooth, flagged):
    right = solved_groove(0.0, 500).max_pressure.values
    ds = solved_groove(noise, 500, smooth=smooth)
    assert is_flagged(ds, "smoothing") == flagged
    wrong = np.abs(ds.max_pressure.values / right - 1.0).max()
    assert (wrong > 0.15) == flagged, "the flag tells the wrong pressures"


@pytest.mark.slow
def test_the_flag_of_the_smoothing_does_not_depend_on_the_cases_beside():
    x = np.linspace(-5.0, 5.0, 500)
    z = np.sqrt(6.6**2 - (abs(x) + 0.3) ** 2) + np.random.default_rng(3).normal(0.0, 8e-4, 500)
    profile = {"points": np.column_stack((x, z)).tolist(), "smooth": 7.6e-4}
    cases = [
        tr.Case(roller_profile=profile, friction_coefficient=0.2, motor_force=0, radial_force=-force)
        for force in (20.0, 200.0, 2000.0)
    ]
    options = {"normal": "halfspace", "accuracy": "preview", "contact_model": "sliding", "outputs": ("contact",)}
    together, alone = tr.solve(cases, **options), [tr.solve(case, **options) for case in cases]
    assert together.validity.values.tolist() == [int(one.validity) for one in alone]
    np.testing.assert_array_equal(together.max_pressure, [one.max_pressure for one in alone])


def test_a_groove_drawn_as_one_arc_in_the_middle_is_told():
    x = np.linspace(-5.0, 5.0, 401)
    for radius in (6.1, 6.6, 7.0):
        assert "touch in the middle" in asked_of_groove(x, np.sqrt(radius**2 - x * x))
        for angle, told in ((0.0, True), (20.0, True), (28.0, False), (30.0, False), (33.0, False), (40.0, True)):
            offset = (radius - 6.0) * math.sin(math.radians(angle))  # two arcs that touch the guide of 6 mm there
            sentence = asked_of_groove(x, np.sqrt(radius**2 - (abs(x) + offset) ** 2))
            assert ("as drawn, groove and guide touch" in sentence) == told, angle
            assert not told or angle == 0.0 or f"at {angle:.3g} deg" in sentence


def asked_of_groove(x: np.ndarray, z: np.ndarray) -> str:
    case = tr.Case(roller_profile={"points": np.column_stack((x, z)).tolist()}, friction_coefficient=0.1)
    return " ".join(doubts_of_case(case, load_database()))
