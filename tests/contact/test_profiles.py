"""Test which drawn and measured cross-sections are accepted, their shapes, and where their material ends."""

import json
import math

import numpy as np
import pytest
import xarray as xr
from reference_cases import solve_sliding

import trackroller as tr
from trackroller.contact.cross_sections import (
    CONTACT_SLOPE,
    arcs,
    drawn,
    parabola,
    smoothed,
    with_edges,
    worn,
)
from trackroller.contact.drawn_profiles import cross_section, gap, treats_sides_alike
from trackroller.contact.measured_points import noise_of
from trackroller.contact.normal.wearing import on_cells
from trackroller.contact.profiles import canonical

ALPHA = math.radians(30)


def text(mapping, field="guide_profile"):
    return json.dumps(canonical(mapping, field))


def circle_points(radius, centre=(0.0, 0.0), low=-4.0, high=4.0, n=161):
    x = np.linspace(low, high, n)
    return [[float(v), float(centre[1] + math.sqrt(radius**2 - (v - centre[0]) ** 2))] for v in x]


def gothic_groove(radius=7.0, guide=6.0, alpha=ALPHA, half=4.5, n=181):
    """Return a groove of two circular flanks that touch a guide of radius `guide` at +-alpha, in the guide's frame."""
    apart = (radius - guide) * math.sin(alpha)
    x = np.linspace(-half, half, n)
    z = [math.sqrt(radius**2 - (abs(v) + apart) ** 2) for v in x]
    return [[float(a), float(b)] for a, b in zip(x, z, strict=True)]


def test_one_arc_is_its_circle_and_begins_as_the_parabola():
    section, u = arcs([6.0], []), np.array([-2.0, -1e-3, 0.0, 1e-3, 3.0])
    np.testing.assert_allclose(section.height(u), np.sqrt(36 - u * u) - 6, atol=1e-14)
    np.testing.assert_allclose(section.slope(u), -u / np.sqrt(36 - u * u), atol=1e-14)
    np.testing.assert_allclose(section.height(u)[1:4], parabola(6.0).height(u)[1:4], atol=1e-13)
    assert -6 < section.inner < -5.99 and 5.99 < section.outer < 6
    assert not np.any(arcs([math.inf], []).height(u))


def test_arcs_follow_one_another_tangentially():
    section = arcs([-7.0, 3.0, math.inf], [-0.5, 0.8])
    for knot in (-0.5, 0.8):
        at = np.array([knot - 1e-9, knot + 1e-9])
        assert abs(np.diff(section.height(at))[0]) < 1e-8 and abs(np.diff(section.slope(at))[0]) < 1e-8
    h = 1e-4
    for u, curvature in ((-1.0, -1 / 7), (0.2, 1 / 3), (1.5, 0.0)):
        second = (section.slope(np.array(u + h)) - section.slope(np.array(u - h))) / (2 * h)
        steep = (1 + section.slope(np.array(u)) ** 2) ** 1.5
        assert second == pytest.approx(-curvature * steep, abs=1e-6)
    assert section.height(np.array(0.0)) == 0.0 and section.slope(np.array(0.0)) == 0.0


def test_points_of_a_circle_give_back_the_circle():
    """Points of the whole cross-section give the same circle as points in the frame of the contact."""
    u = np.linspace(-1.5, 1.0, 11)
    exact = np.sqrt(36 - u * u) - 6
    whole = cross_section(text({"points": circle_points(6.0)}), "guide_profile", 6.0, ALPHA, 6.0, 1)
    np.testing.assert_allclose(whole.height(u), exact, atol=2e-7)
    turned = [[float(v), float(math.sqrt(36 - v * v) - 6 + 2.5)] for v in np.linspace(-2, 2, 81)]
    local = cross_section(text({"points": turned, "frame": "contact"}), "guide_profile", 6.0, ALPHA, 6.0, 1)
    np.testing.assert_allclose(local.height(u), exact, atol=2e-7)


def test_wear_too_shallow_for_a_slope_is_no_overflow():
    depth = np.array([0.0, 1e-320, 3e-310, 1e-3, 2e-318])
    with np.errstate(over="raise", divide="raise", invalid="raise"):
        shape = worn(parabola(-7.0), -0.5, 0.25, depth)
        cells = on_cells(np.linspace(-1.0, 1.0, 6), depth, np.linspace(-1.0, 1.0, 10))
    u = -0.5 + 0.25 * np.arange(5)
    np.testing.assert_allclose(parabola(-7.0).height(u) - shape.height(u), depth, atol=1e-15)
    assert np.sum(cells) * 2.0 / 9.0 == pytest.approx(np.sum(depth) * 0.4)


def test_a_drawn_groove_leaves_the_gap_of_its_arcs_on_both_sides():
    by_arcs = gap("", "", 6.0, -7.0, ALPHA, 16.55, 220.0, 1)
    told = text({"points": circle_points(6.0)}), text({"points": gothic_groove()}, "roller_profile")
    x = np.linspace(-0.8, 0.8, 9)
    for side in (1, 2):
        by_points = gap(*told, 6.0, -7.0, ALPHA, 16.55, 220.0, side)
        np.testing.assert_allclose(by_points.lateral(x), by_arcs.lateral(x), atol=1e-6)
        np.testing.assert_allclose(by_points.curvature(x), by_arcs.curvature(x), rtol=1e-5)
    assert not treats_sides_alike(told[0]) and treats_sides_alike("") and treats_sides_alike(text({"arc": 6}))


def test_the_curvature_in_the_rolling_direction_is_that_of_bodies_of_revolution():
    """Finite differences of the distance between both surfaces of revolution give k_y(x)."""
    g = gap("", "", 6.0, -7.0, ALPHA, 16.55, math.inf, 1)
    for x in (-0.5, 0.0, 0.7):
        height = -float(g.roller.height(np.array(x)))  # of the roller's flank over the tangent plane, along the normal
        radius = 16.55 + x * math.sin(ALPHA) - height * math.cos(ALPHA)
        slope = float(g.roller.slope(np.array(x)))
        expected = (math.cos(ALPHA) - math.sin(ALPHA) * slope) / radius
        assert float(g.curvature(np.array(x))) == pytest.approx(expected, rel=3e-3)
    assert g.curvature(np.array(0.0)) == pytest.approx(math.cos(ALPHA) / 16.55)


@pytest.mark.slow
@pytest.mark.parametrize("n", [61, 91, 361])
def test_automatic_smoothing_leaves_the_curvature_of_a_circle(n):
    """Noise of 1 um on points of a circle changes the curvature near the contact by less than 35 %, in 32 draws."""
    u, near = np.linspace(-4.5, 4.5, n), np.linspace(-1.0, 1.0, 81)
    for seed in range(32):
        measured = -u * u / 12 + np.random.default_rng(seed).normal(0.0, 1e-3, n)
        assert 0.6e-3 < noise_of(u, measured) < 1.5e-3
        assert np.abs(-6.0 * smoothed(u, measured, "auto").derivative(2)(near) - 1.0).max() < 0.35


def test_kinks_and_uneven_points_are_not_taken_for_noise():
    rng = np.random.default_rng(3)
    u = np.sort(rng.uniform(-2.0, 2.0, 200))
    roof = -np.where(np.abs(u) < 1.2, u * u / 14, 1.44 / 14 + (np.abs(u) - 1.2))
    assert noise_of(u, roof + rng.normal(0.0, 1e-3, u.size)) == pytest.approx(1e-3, rel=0.3)
    assert noise_of(u, -u * u / 12) < 1e-12 and noise_of(u[:5], -(u[:5] ** 2)) < 1e-9
    assert np.abs(drawn(u, -u * u / 12, "auto").height(u) + u * u / 12).max() < 1e-9


def test_measured_noise_is_smoothed_as_far_as_it_is_noise():
    rng = np.random.default_rng(0)
    u = np.linspace(-2, 2, 400)
    exact, noise = -u * u / 12, 1e-3
    measured = exact + rng.normal(0, noise, u.size)
    h, curvature = 1e-3, -1 / 6
    inner = np.linspace(-1, 1, 21)

    def bend(section):
        return (section.slope(inner + h) - section.slope(inner - h)) / (2 * h)

    for told in (noise, "auto"):
        section = drawn(u, measured, told)
        assert np.std(section.height(inner) + inner**2 / 12) < 0.4 * noise
        assert np.abs(bend(section) - curvature).max() < 0.1
    assert np.std(drawn(u, measured, noise).height(u) - measured) == pytest.approx(noise, rel=0.01)
    assert np.abs(bend(drawn(u, measured)) - curvature).max() > 10  # through every point: the noise is taken for shape


def test_edges_cut_and_round_the_material():
    section = with_edges(arcs([-7.0], []), -0.4, 0.6, chamfer=0.1)
    assert section.limits == pytest.approx((-0.4 - 0.0999, 0.6 + 0.0999))
    inside, beyond = np.array([0.5]), np.array([0.65])
    assert section.full_height(inside) == section.height(inside)
    tangent = section.height(np.array([0.6])) + 0.05 * section.slope(np.array([0.6]))
    assert section.full_height(beyond) == pytest.approx(tangent - (0.1 - math.sqrt(0.01 - 0.05**2)))
    width = cross_section(text({"arc": -7, "width": 7.0}), "roller_profile", -7.0, ALPHA, 6.0, 1)
    assert width.outer == pytest.approx(0.5 / math.cos(ALPHA))
    plain = cross_section("", "guide_profile", 6.0, ALPHA, 6.0, 1)
    assert (plain.inner, plain.outer) == pytest.approx((-3.0, 6 * math.cos(ALPHA)))  # middle and equator


@pytest.mark.parametrize(
    ("mapping", "words"),
    [
        ({"arcc": 6}, "arc"),
        ({"arc": 6, "points": []}, "exactly one"),
        ({"width": 6}, "exactly one"),
        ({"arc": 0}, "other than 0"),
        ({"arc": True}, "number"),
        ({"arc": -7, "frame": "section"}, "only with points"),
        ({"arc": -7, "edge": {"iner": 1}}, "inner"),
        ({"arc": -7, "edge": {"inner": -1}}, "> 0"),
        ({"arc": -7, "edge": {"inner": 1}, "width": 9}, "one of the two"),
        ({"arcs": [{"radius": -7, "to": 1}]}, "to"),
        ({"arcs": [{"radius": -7, "to": 1}, {"radius": 3, "to": 0.5}, {"radius": 2}]}, "beyond"),
        ({"points": [[0, 0], [1, 1]]}, "rows"),
        ({"points": [[0, 0], [1, 1], [1, 2], [3, 3], [4, 4]]}, "one height for each x"),
        ({"points": [[0, 0], [1, "b"], [2, 2], [3, 3], [4, 4]]}, "numbers"),
        ({"points": [[i, 0.0] for i in range(6)], "frame": "contact"}, "both sides"),
        ({"points": [[i, 0.0] for i in range(6)], "smooth": -1}, "noise"),
        ({"points": [[i, 0.0] for i in range(6)], "frame": "sektion"}, "section"),
        ({"file": "/etc/passwd"}, "a relative path without '..'. Put the file below"),
        ({"file": "../points.csv"}, "a relative path without '..'. Put the file below"),
        ({"file": "missing.csv"}, "a file below"),
    ],
)
def test_a_wrong_profile_is_refused_by_name(mapping, words):
    with pytest.raises(tr.InputError) as caught:
        tr.Case(guide_profile=mapping)
    assert "guide_profile" in str(caught.value) and words in str(caught.value)


def test_a_curve_without_the_contacts_inclination_is_refused():
    flat = [[float(x), 5.0 - 0.001 * x * x] for x in np.linspace(-4, 4, 41)]
    with pytest.raises(tr.InputError, match=r"guide_profile.*30 deg"):
        solve_sliding(tr.Case(guide_profile={"points": flat}), normal="halfspace", outputs="forces")
    rows = solve_sliding(
        [tr.Case(contact_angle=a, guide_profile={"points": circle_points(6.0, high=3.5)}) for a in (50.0, 30.0)],
        normal="halfspace",
        outputs="forces",
        accuracy="preview",
    )
    assert rows.regime.values.tolist() == [3, 0] and np.isnan(rows.normal_force[0]).all()  # one of many: a failed row
    with pytest.raises(tr.InputError, match="distance of the contacts"):
        solve_sliding(tr.Case(roller_profile={"arc": -7, "width": 5}), normal="halfspace", outputs="forces")


def test_files_are_read_into_points(tmp_path, monkeypatch):
    """Commas, semicolons, tabs or blanks may part the columns; the case keeps the numbers, not the name of the file."""
    monkeypatch.chdir(tmp_path)
    rows = circle_points(6.0, n=9)
    for separator in (",", ";", "\t", "  "):
        lines = ["x [mm]" + separator + "z [mm]", "# measured", *(separator.join(map(repr, row)) for row in rows)]
        (tmp_path / "guide.csv").write_text("\n".join(lines), encoding="utf-8")
        case = tr.Case(guide_profile={"file": "guide.csv"})
        np.testing.assert_array_equal(case.guide_profile["points"], rows)
        assert "file" not in case.guide_profile
    (tmp_path / "bad.csv").write_text("1 2\n2 x\n", encoding="utf-8")
    with pytest.raises(tr.InputError, match="line 2"):
        tr.Case(guide_profile={"file": "bad.csv"})


def test_steep_flanks_take_no_part_and_interlocking_shapes_are_refused():
    """A groove may close on the guide far from the contact; one that closes on it beside the contact is refused."""
    mixed = gap(
        text({"parabola": 6}),
        text({"arcs": [{"radius": -7, "to": 0.2}, {"radius": -6.3}]}, "roller_profile"),
        6.0,
        -7.0,
        ALPHA,
        16.55,
        220.0,
        1,
    )
    assert mixed.limits[1] < 3.0
    both = gap("", text({"parabola": -7}, "roller_profile"), 6.0, -7.0, ALPHA, 16.55, 220.0, 1)
    assert both.guide.parabolic and both.roller.parabolic
    with pytest.raises(tr.InputError, match=r"roller_profile.*overlap"):
        gap("", text({"arcs": [{"radius": -7, "to": 0.2}, {"radius": -4}]}), 6.0, -7.0, ALPHA, 16.55, 220.0, 1)


@pytest.mark.parametrize("factor", [1e3, 1e-3, 1 / 25.4])
def test_points_in_other_units_are_refused_in_both_frames(factor):
    """Points in micrometres, metres or inches would move the contact away from its nominal place."""
    scaled = (np.array(circle_points(6.0)) * factor).tolist()
    with pytest.raises(tr.InputError, match=r"guide_profile.*mm"):
        solve_sliding(tr.Case(guide_profile={"points": scaled}), normal="halfspace", outputs="forces")
    near = (np.array([[u, -u * u / 14] for u in np.linspace(-1, 1, 41)]) * factor).tolist()
    if factor != 1 / 25.4:  # a narrow piece might be meant
        with pytest.raises(tr.InputError, match=r"roller_profile.*mm"):
            solve_sliding(
                tr.Case(roller_profile={"points": near, "frame": "contact"}), normal="halfspace", outputs="forces"
            )


@pytest.mark.parametrize("body", ["guide_profile", "roller_profile"])
def test_heights_in_micrometres_are_refused_where_x_is_in_mm(body):
    """Only a tiny part of such a curve is flat enough to carry pressure."""
    curve = [[u, -u * u / 14 * 1000] for u in np.linspace(-1, 1, 41).tolist()]
    with pytest.raises(tr.InputError, match=rf"{body}.*25 deg.*x and z in mm"):
        solve_sliding(tr.Case(**{body: {"points": curve, "frame": "contact"}}), normal="halfspace", outputs="forces")


@pytest.mark.parametrize("groove", [{"arc": -5.9}, {"arcs": [{"radius": -7, "to": 0.4}, {"radius": -5.5}]}])
def test_a_groove_that_touches_far_from_the_nominal_contact_is_refused(groove):
    """A groove tighter than the guide would touch the guide at its rim; a hollow worn beside the contact is allowed."""
    with pytest.raises(tr.InputError, match=r"roller_profile.*outward of the nominal contact.*lever arms"):
        solve_sliding(tr.Case(roller_profile=groove), normal="halfspace", outputs="forces")


def test_smoothing_that_moves_the_contact_away_is_blamed_itself():
    points = {"points": circle_points(6.0), "smooth": 2.0}
    with pytest.raises(tr.InputError, match=r"guide_profile\.smooth = 2\.0.*inclined by.*30 deg.*standard deviation"):
        solve_sliding(tr.Case(guide_profile=points), normal="halfspace", outputs="forces")
    with pytest.raises(tr.InputError, match=r"overlap.*smooth less"):
        wide = [[x, math.sqrt(36 - x * x)] for x in np.linspace(-4.5, 4.5, 181).tolist()]
        solve_sliding(tr.Case(guide_profile={"points": wide, "smooth": 0.1}), normal="halfspace", outputs="forces")


def test_a_curve_upside_down_or_on_one_side_only_says_so():
    down = [[x, -z] for x, z in circle_points(6.0)]
    with pytest.raises(tr.InputError, match="other way round"):
        solve_sliding(tr.Case(guide_profile={"points": down}), normal="halfspace", outputs="forces")
    left = [row for row in circle_points(6.0) if row[0] < 0]
    with pytest.raises(tr.InputError, match="x >= 0"):
        solve_sliding([tr.Case(guide_profile={"points": left})], normal="halfspace", outputs="forces")


def test_order_duplicates_and_gaps_are_named_by_row(tmp_path, monkeypatch):
    points = circle_points(6.0, n=21)
    broken = {
        "one height": ([*points[:5], [points[4][0], 0.0], *points[5:]],),
        "finite": ([*points[:4], [points[4][0], math.nan], *points[5:]],),
        "rows": ([], None, points[:3], "1 2"),
    }
    for words, lists in broken.items():
        for rows in lists:
            with pytest.raises(tr.InputError, match=rf"roller_profile\.points.*{words}"):
                tr.Case(roller_profile={"points": rows})
    monkeypatch.chdir(tmp_path)
    (tmp_path / "picture.csv").write_bytes(b"\x89PNG\r\n\xff\xfe")
    with pytest.raises(tr.InputError, match=r"guide_profile\.file.*neither a point nor the names"):
        tr.Case(guide_profile={"file": "picture.csv"})


def test_coarse_and_uneven_points_give_the_circle():
    """Twenty points, or unevenly spaced ones, on an exact circle give its pressure within 1 %."""
    x = np.sort(np.random.default_rng(1).uniform(-4.2, 4.2, 120))
    uneven = np.stack([x, np.sqrt(36 - x * x)], axis=1).tolist()
    told = [None, {"points": circle_points(6.0, n=20)}, {"points": uneven}]
    ds = solve_sliding([tr.Case(guide_profile=p) for p in told], "contact", normal="halfspace", accuracy="preview")
    assert np.all(ds.regime == 0)
    np.testing.assert_allclose(ds.max_pressure[1:], ds.max_pressure[:1].values.repeat(2, 0), rtol=1e-2)


@pytest.mark.slow
def test_a_groove_worn_hollow_carries_in_two_patches():
    """A hollow at the nominal contact has no pressure in its middle and the load on both sides; all stages run."""
    hollow = [[float(u), float(-u * u / 14 + 0.02 * math.exp(-((u / 0.3) ** 2)))] for u in np.linspace(-2, 2, 201)]
    case = tr.Case(roller_profile={"points": hollow, "frame": "contact"}, motor_force=0.0)
    for model in ("sliding", "kalker"):
        ds = tr.solve(
            case,
            ("forces", "contact", "peak_stress", "life", "tractions"),
            contact_model=model,
            normal="halfspace",
            accuracy="preview",
        )
        assert int(ds.regime) == 0 and np.all(np.isfinite(ds.peak_stress))
        for contact in ds.pressure.values:
            loaded = (contact.sum(axis=0) > 0).astype(int)
            assert np.count_nonzero(np.diff(loaded, prepend=0) == 1) == 2


@pytest.mark.slow
def test_in_a_study_a_profile_that_cannot_touch_is_a_row_with_its_reason():
    """A case fails for the same reason alone and beside other cases."""
    from trackroller.study.solve_chunk import solve_cases

    guide = text({"points": circle_points(6.0, high=3.5)})
    columns = {"contact_angle": np.array([50.0, 30.0, 55.0]), "guide_profile": np.array([guide] * 3, object)}
    options = {"outputs": ["forces"], "normal": "halfspace", "accuracy": "preview"}
    cases = xr.Dataset(
        {name: ("case", column) for name, column in columns.items()}, {"case": np.array(["a", "b", "c"], "S32")}
    )
    cases.attrs["options"] = json.dumps(options)
    for rows in (np.arange(3), np.array([0]), np.array([0, 2])):
        found = solve_cases(cases.isel(case=rows), None)
        reasons = {
            case.decode(): why for case, why in zip(found["case"].values, found["reason"].values, strict=True) if why
        }
        assert set(reasons) == {"abc"[i] for i in rows if i != 1}
        assert all("guide_profile" in why and "inclined" in why for why in reasons.values())


@pytest.mark.slow
def test_a_body_ends_before_its_axis():
    """The patch of a small roller with a steep contact ends before the roller's axis; two parabolas have no axis."""
    radius, angle = 1.6373, np.radians(75.4)
    gap_of = gap("", "", 24.29, -36.22, angle, radius, math.inf, 1)
    assert gap_of.limits[0] == pytest.approx(-0.95 * radius / np.sin(angle))
    shapes = text({"parabola": 24.29}), text({"parabola": -36.22}, "roller_profile")
    of_hertz = gap(*shapes, 24.29, -36.22, angle, radius, math.inf, 1)
    assert of_hertz.limits[0] == pytest.approx(-CONTACT_SLOPE * 24.29, rel=0.01)
    case = tr.Case(
        axis_distance=7.76,
        guide_profile_radius=24.29,
        roller_profile_radius=-36.22,
        guide_curve_radius=math.inf,
        contact_angle=75.4,
        radial_force=-5005.0,
        axial_force=24868.0,
        motor_force=12739.0,
        friction_coefficient=1.0,
    )
    ds = tr.solve(case, "contact", normal="halfspace", contact_model="sliding", accuracy="preview")
    assert ds.sizes["contact"] == 2 and ds.regime.attrs["flag_meanings"].split()[int(ds.regime)] != "failed"
