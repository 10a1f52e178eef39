"""The groove over travel: limits, conservation, geometry, order, symmetry, ends and resumption."""

from dataclasses import replace

import numpy as np
import pytest

import trackroller as tr
from trackroller.contact.cross_sections import Gap, parabola
from trackroller.contact.normal.family import Family
from trackroller.contact.normal.measure import Box
from trackroller.contact.normal.wearing import WearingPatch, evened_at_rims, on_cells, smoothed
from trackroller.damage.wear import wear_depth
from trackroller.errors import InputError
from trackroller.roller import wearing
from trackroller.roller.case import to_table
from trackroller.roller.options import Options
from trackroller.roller.wearing import Wearing

SLIDING = {"contact_model": "sliding", "accuracy": "preview"}
FORCES = ("forces", "contact", "friction_work")


def steel(k):
    return {"like": "1.7225-quenched-tempered", "wear_coefficient": k}


def roller(k=1e-5, guide=0.0, **more):
    given = {"motor_force": 0, "axial_force": 0, "friction_coefficient": 0.2, "wear_coefficient_factor": 1.0}
    return tr.Case(**given | {"roller_material": steel(k), "guide_material": steel(guide)} | more)


def patch(elements=20, modulus=115e3):
    """Return a Hertzian patch with uniform slip, its gap and fields."""
    gap = Gap(parabola(6.0), parabola(-7.0), 0.5, 16.5, np.inf)
    x = y = 0.35 * ((2 * np.arange(elements) + 1) / elements - 1)
    pressure = 700 * np.sqrt(np.maximum(1 - (x / 0.35) ** 2 - (y[:, None] / 0.35) ** 2, 0))
    slip = 1e-3 * (1 + 0.3 * x) + 0 * y[:, None]
    return gap, x, y, pressure, slip, modulus


def test_a_short_step_is_archards_law():
    gap, x, y, pressure, slip, modulus = patch()
    wears = WearingPatch(gap, x, y, pressure, np.array([0.75 * pressure * slip, 0.25 * pressure * slip]), modulus)
    (roller_depth, guide_depth), closing = wears.worn(1e-9)
    depth = roller_depth + guide_depth
    law = 1e3 * wear_depth(pressure[None, None], slip[None, None], np.array([[y[1] - y[0]]]), np.ones(1))[0, 0]
    assert roller_depth == pytest.approx(3 * guide_depth)
    inside = (wears.edges[:-1] > x[0] - 0.02) & (wears.edges[1:] < x[-1] + 0.02)
    assert depth[inside] == pytest.approx(1e-9 * law, rel=1e-6, abs=1e-15)
    assert wears.rate[inside] == pytest.approx(law) and abs(closing) < 1e-7
    assert depth[~inside].max() < 1e-6 * depth.max()


def test_a_long_step_follows_the_pressure_and_keeps_the_load():
    gap, x, y, pressure, slip, modulus = patch()
    wears = WearingPatch(gap, x, y, pressure, np.array([pressure * slip, 0 * pressure]), modulus)
    (depth, guide), closing = wears.worn(1.0)  # 0.5 mm of explicit wear
    assert not guide.any()
    # wear without end makes the depth uniform up to the gap and the elastic approach
    middle = depth[np.abs(wears.edges[:-1]) < 0.2]
    assert 0 < closing < 0.5 and depth.min() >= 0 and np.ptp(middle) < 0.1 * closing


def test_a_similar_patch_beyond_the_end_of_the_groove_starts_no_search():
    gap = patch()[0]
    beyond = Box(gap.limits[1] + 1.0, gap.limits[1] + 2.0, 0.3)
    one, two = (Family(gap, 12, near=near).node(-16) for near in (beyond, None))
    np.testing.assert_array_equal(one.shares, two.shares)


def test_cells_keep_the_volume():
    edges, cells = np.linspace(-1, 1, 21), np.linspace(-2, 2, 77)
    depth = 1 - (0.5 * (edges[1:] + edges[:-1])) ** 2
    got = on_cells(edges, depth, cells)
    assert got.sum() * (cells[1] - cells[0]) == pytest.approx(depth.sum() * 0.1, rel=1e-12)
    assert got.min() == 0.0 and got[0] == 0.0


def test_smoothing_keeps_the_volume_and_has_its_variance():
    point, places = np.zeros(81), np.arange(-40, 41)
    point[40] = 1.0
    wide = smoothed(point, 4.0)
    assert wide.sum() == pytest.approx(1.0) and (wide * places**2).sum() == pytest.approx(0.25**2 * (16 - 1))
    np.testing.assert_array_equal(smoothed(point, 1.0), point)  # columns of the new patch see every cell


def test_only_the_rims_of_a_patch_are_evened():
    depth, loaded = np.random.default_rng(1).uniform(size=(2, 30)), np.zeros(30, bool)
    loaded[3:27] = True
    even = evened_at_rims(depth, loaded)
    assert even.sum(axis=1) == pytest.approx(depth.sum(axis=1))
    np.testing.assert_array_equal(even[:, 9:21], depth[:, 9:21])
    assert np.abs(np.diff(even[:, :6])).sum() < 0.7 * np.abs(np.diff(depth[:, :6])).sum()


@pytest.mark.long
def test_the_pressure_of_a_deep_groove_is_smooth_over_the_travel():
    """One roller whose pressure rose twofold at the end while its rims saw the cells at random; in truth it falls."""
    case = {"radial_force": -390, "contact_angle": 20, "roller_profile_radius": -7.8, "motor_force": -5}
    more = {"friction_coefficient": 0.4, "guide_overrollings_per_hour": 1000}
    pressure = tr.wear(roller(1e-5, 1e-5, **case, **more), 300, FORCES, **SLIDING).max_pressure.max("contact").values
    assert pressure[-1] < 0.7 * pressure[0] and np.all(np.diff(pressure) < 0.01 * pressure[0])


@pytest.mark.parametrize("k", [0.0, 1e-30])
def test_without_wear_the_bits_are_those_of_the_new_roller(k):
    case = roller(k)
    new = tr.solve(case, FORCES, normal="halfspace", **SLIDING)
    worn = tr.wear(case, 50, FORCES, **SLIDING)
    assert worn.travel.values.tolist() == [0.0, 50.0] and worn.attrs["end"] == "travel"
    for name in ("normal_force", "max_pressure", "friction_power", "slip", "lateral_force"):
        for row in (0, 1):
            np.testing.assert_array_equal(worn[name].isel(travel=row).values, new[name].values, err_msg=name)


def march(case, travel, steps, **options):
    """Return the depth after equal steps without control of their error, and the worn cells."""
    w = Wearing(to_table(case), Options(normal="halfspace", outputs=("forces",), **SLIDING | options))
    at, results = w.start, w.new
    for _ in range(steps):
        patches, at = w._patches(results, w.worn_table(at)), w.turned(at, results)
        at, _, reason = w._two_ways(at, patches, travel / steps)
        assert at is not None, reason
        results = w.solve(at)
    return w, at


@pytest.mark.slow
def test_half_the_step_halves_the_difference():
    one, two, four = (march(roller(), 40.0, steps)[1].depth for steps in (1, 2, 4))
    assert np.sqrt(np.mean((four - two) ** 2)) < 0.5 * np.sqrt(np.mean((two - one) ** 2))


@pytest.mark.long
def test_the_stated_error_covers_the_difference_to_shorter_steps():
    _, one = march(roller(), 8.0, 2)
    _, two = march(roller(), 8.0, 8)
    wore = two.depth[0, 0] > 0
    assert np.sqrt(np.mean((one.depth - two.depth)[0, 0][wore] ** 2)) < one.error


@pytest.mark.long
def test_the_stated_error_of_the_pressure_covers_finer_elements_and_that_of_life_adds_up():
    ds = tr.wear(roller(motor_force=-30), 8, **SLIDING)
    fine = tr.wear(roller(motor_force=-30), 8, FORCES, **SLIDING | {"accuracy": "standard"})
    stated = ds.pressure_error.values
    assert (stated[0] == 0.0).all() and (stated[1:] > 0.0).all() and stated.max() < 0.15
    finer = fine.max_pressure.interp(travel=ds.travel)
    assert (np.abs(finer / ds.max_pressure - 1.0).values[1:] <= stated[1:]).all()
    own = ds.sel(body="roller")
    last, of_states = own.fatigue_damage_error.isel(travel=-1), own.life_error_estimate
    assert (last <= of_states.max("travel")).all() and (last > of_states.min("travel")).all()


@pytest.mark.long
def test_volume_is_the_friction_energy_step_by_step():
    """V = k/mu W where all of the patch slides with one coefficient."""
    ds = tr.wear(roller(), 40, FORCES, **SLIDING)
    volume = ds.groove_volume.sel(body="roller").values
    spent = ds.friction_energy_per_distance.values  # J/m = N
    expected = 1e-5 / 0.2 * 0.5 * (spent[1:] + spent[:-1]) * 1e3 * np.diff(ds.travel.values)[:, None]
    got = np.diff(volume, axis=0)  # once a revolution, so that the volume of the travel is that of the circumference
    assert got == pytest.approx(expected, rel=0.05)
    assert got.sum() == pytest.approx(expected.sum(), rel=0.03)


def test_the_first_rate_is_that_of_the_limit_wear():
    case = roller(1e-5, 1e-6, guide_overrollings_per_hour=100.0)
    ds = tr.wear(case, 0.05, FORCES, **SLIDING)
    new = tr.solve(case, (*FORCES, "wear"), normal="halfspace", **SLIDING)
    grown = ds.groove_depth.isel(travel=-1) / 0.05
    np.testing.assert_allclose(grown.values, new.wear_depth_per_km.transpose("contact", "body").values, rtol=0.05)


@pytest.mark.slow
def test_a_linear_table_of_the_energy_law_is_archards_law():
    """With |tau| = mu p, a loss of c per work rate is k = c mu / density."""
    density, loss = 7800.0, 0.4
    table = {"work_rate": [0, 1e3], "roller": [0, 1e3 * loss], "guide": [0, 0]}
    body = {"like": "1.7225-quenched-tempered", "density": density}
    energy = roller(roller_material=body, guide_material=body, wear_table=table)
    archard = roller(k=loss * 0.2 / density)
    one, two = (
        tr.wear(c, 3, FORCES, **o) for c, o in ((energy, {**SLIDING, "wear_law": "energy"}), (archard, SLIDING))
    )
    # the mean shear of the elements beside the spin pole is smaller than mu p
    for name in ("groove_depth", "groove_volume", "max_pressure"):
        assert one[name].values[-1] == pytest.approx(two[name].values[-1], rel=0.02)


@pytest.mark.slow
def test_the_energy_law_starts_at_the_rate_of_the_limit_wear():
    body = {"like": "1.7225-quenched-tempered", "density": 7800.0}
    table = {"work_rate": [0, 0.1, 0.3, 1e3], "roller": [0, 0, 1, 1e4], "guide": [0, 0, 0, 0]}
    case, energy = (
        roller(roller_material=body, guide_material=body, wear_table=table),
        {**SLIDING, "wear_law": "energy"},
    )
    run, new = tr.wear(case, 0.05, FORCES, **energy), tr.solve(case, (*FORCES, "wear"), normal="halfspace", **energy)
    grown = run.groove_depth.isel(travel=-1).sel(body="roller") / float(run.travel[-1])
    assert grown.values == pytest.approx(new.wear_depth_per_km.sel(body="roller").values, rel=0.05)
    none = roller(roller_material=body, guide_material=body, wear_table=table | {"roller": [0, 0, 0, 0]})
    assert float(tr.wear(none, 3, FORCES, **energy).groove_depth.max()) == 0.0


@pytest.mark.long
def test_the_roller_becomes_the_circle_of_the_guide():
    """With a large depth the gap left is elastic: depth + gap of the unworn circles = closing over the patch."""
    w = Wearing(to_table(roller(motor_force=-30)), Options(normal="halfspace", outputs=("forces",), **SLIDING))
    for state, *_ in w.march():
        at = state
        if at.depth.max() > 12 * w.scale:
            break
    x, moved = w.places, w._moved(at.closing)[0]
    unworn = w._gap(w.table, 1)
    inside = at.depth[0, 0] > 0.5 * at.depth.max()
    u = x[inside] + moved  # cells of the roller lie outward by its motion
    left = at.depth[0, 0][inside] - unworn.roller.height(x[inside]) - unworn.guide.height(u)
    assert np.ptp(left) < 1.5 * w.scale < 0.15 * at.depth.max()
    # volume between the two circles up to the closing
    over = at.closing[0] + unworn.roller.height(x) + unworn.guide.height(x + moved)
    area = np.sum(np.maximum(over, 0.0)) * (x[1] - x[0])
    assert at.depth[0, 0].sum() * (x[1] - x[0]) == pytest.approx(area, rel=0.15)


@pytest.mark.long
def test_the_depth_rate_levels_out_while_the_profile_wears():
    w = Wearing(to_table(roller(motor_force=-30)), Options(normal="halfspace", outputs=("forces",), **SLIDING))
    spread = []
    for at, results, *_ in w.march():
        rate = w._patches(results, w.worn_table(at))[0].rate
        rate = rate[rate > 0]
        spread.append(float(rate.std() / rate.mean()))
        if at.travel > 30:
            break
    assert spread[-1] < 0.8 * spread[0]


@pytest.mark.long
def test_mirrored_rollers_wear_alike():
    one, two = (tr.wear(roller(axial_force=f), 2, FORCES, **SLIDING) for f in (30, -30))
    for name in ("worn_depth", "normal_force", "max_pressure", "contact_angle"):
        np.testing.assert_array_equal(one[name].values, two[name].isel(contact=[1, 0]).values, err_msg=name)
    np.testing.assert_array_equal(one.lateral_force.values, -two.lateral_force.isel(contact=[1, 0]).values)
    assert one.normal_force.values[0, 1] > one.normal_force.values[0, 0]
    deep = one.groove_depth.sel(body="roller").isel(travel=-1)
    assert deep[1] > deep[0]


@pytest.mark.long
def test_a_run_that_goes_on_has_the_same_bits():
    case = roller(axial_force=-20, motor_force=-5)
    kept = []
    whole = tr.wear(case, 3, FORCES, tell=lambda ds, goal: kept.append(ds), **SLIDING)
    assert len(kept) > 3
    for part in (kept[-2], tr.wear(case, 1, FORCES, **SLIDING)):
        again = tr.wear(case, 3, FORCES, resume=part, **SLIDING)
        assert again.identical(whole)
    with pytest.raises(InputError, match="same case"):
        tr.wear(roller(), 3, FORCES, resume=whole, **SLIDING)
    with pytest.raises(InputError, match="accuracy"):
        tr.wear(case, 3, FORCES, resume=whole, contact_model="sliding", accuracy="standard")


@pytest.mark.long
def test_where_the_travel_ends():
    ds = tr.wear(roller(permissible_wear_depth=5e-4), 100, FORCES, **SLIDING)
    assert ds.attrs["end"] == "permissible"
    assert float(ds.groove_depth.isel(travel=-1).max()) == pytest.approx(5e-4, rel=1e-9)
    ds = tr.wear(roller(axial_force=200), 100, FORCES, **SLIDING)
    assert ds.attrs["end"] == "lift_off" and ds.sizes["travel"] == 1
    ds = tr.wear(roller(motor_force=-60), 100, FORCES, **SLIDING)
    assert ds.attrs["end"] == "full_slip"


@pytest.mark.long
def test_a_march_ends_after_a_limited_number_of_states(monkeypatch):
    monkeypatch.setattr(wearing, "STEPS", 4)
    case, kept = roller(k=1.0), []
    ds = tr.wear(case, 1e3, FORCES, tell=lambda ds, goal: kept.append(ds), **SLIDING)
    assert ds.attrs["end"] == "steps" and ds.sizes["travel"] == 4 and float(ds.travel[-1]) < 1e3
    assert "states were not enough" in ds.attrs["end_meaning"]
    assert tr.wear(case, 1e3, FORCES, resume=kept[1], **SLIDING).identical(ds)
    late = tr.solve(roller(k=1.0, travel=1e3), FORCES, normal="halfspace", **SLIDING)
    assert not late.converged and "states were not enough" in str(late.reason.item())


@pytest.mark.long
def test_a_balance_that_misses_its_tolerance_by_little_is_followed():
    case = {"radial_force": -182.12142740156958, "axial_force": 15.957566719363353, "motor_force": 2.9364452334016233}
    case |= {"friction_coefficient": 0.1121447249958499, "contact_angle": 24.208483471661395}
    case = roller(roller_profile_radius=-6.212923882449315, **case)
    finer = SLIDING | {"accuracy": "standard"}
    w = Wearing(to_table(case), Options(normal="halfspace", outputs=("forces",), **finer))
    assert w.end(w.new) == "" and float(w.new.values["residual"][0]) <= wearing.BALANCED
    with pytest.MonkeyPatch.context() as strict:
        strict.setattr(wearing, "BALANCED", 0.0)
        w = Wearing(to_table(roller()), Options(normal="halfspace", outputs=("forces",), **SLIDING))
        w.new.converged[:] = False
        assert w.end(w.new) == "failed"


def test_a_deep_groove_is_followed_in_larger_steps():
    """Beyond the elastic approach the depth of a step grows with the depth so far, at any wear coefficient."""
    w = Wearing(to_table(roller(k=1.0)), Options(normal="halfspace", outputs=("forces",), **SLIDING))
    at = replace(w.start, depth=w.start.depth + 0.1)
    patches = w._patches(w.new, w.table)
    _, shallow, _ = w._two_ways(w.start, patches, 1e-5)
    _, deep, _ = w._two_ways(at, patches, 1e-5)
    more = wearing.SHARE * (0.1 - wearing.DEEP * w.scale)
    assert deep == pytest.approx(shallow * wearing.TOLERANCE * w.scale / (wearing.TOLERANCE * w.scale + more), rel=0.1)


def test_refused_input():
    with pytest.raises(InputError, match="halfspace"):
        tr.wear(roller(), 10, normal="hertz")
    with pytest.raises(InputError, match="travel > 0"):
        tr.wear(roller(), -1)
    with pytest.raises(InputError, match="wear_table"):
        tr.wear(roller(), 1, wear_law="energy", **SLIDING)
    with pytest.raises(InputError, match="worn"):
        tr.Case(roller_profile={"arc": -7, "worn": {"start": 0, "step": 0.1, "depth": [[-1.0]]}})


@pytest.mark.long
def test_damage_counts_the_stress_of_each_state():
    ds = tr.wear(roller(motor_force=-30, friction_coefficient=0.3), 15, **SLIDING)
    per_km = 1e6 / (2 * np.pi * (21.75 - 6 * np.cos(np.pi / 6)))
    rate = per_km / ds.life_cycles.sel(body="roller").values
    trapezoid = np.sum(0.5 * (rate[1:] + rate[:-1]) * np.diff(ds.travel.values)[:, None], axis=0)
    assert ds.fatigue_damage.sel(body="roller").values[-1] == pytest.approx(trapezoid, rel=0.1)
    assert ds.life_travel_new.sel(body="roller").values == pytest.approx(1 / rate[0])
    reached = ds.life_travel.sel(body="roller").values
    assert np.isnan(reached[ds.fatigue_damage.sel(body="roller").values[-1] < 1]).all()
    assert wearing.ENDS[ds.attrs["end"]]


@pytest.mark.slow
def test_a_worn_profile_is_a_profile_of_a_case():
    """The profile that a march writes solves as a case of its own."""
    w, at = march(roller(), 8.0, 2)
    table = w.worn_table(at)
    case = roller(guide_profile=table.guide_profile[0], roller_profile=table.roller_profile[0])
    ds = tr.solve(case, FORCES, normal="halfspace", **SLIDING)
    assert ds.max_pressure.values[0] == pytest.approx(w.solve(at).patch.max_pressure[0], rel=5e-3)  # boxes differ


@pytest.mark.long
def test_travel_is_a_field_of_a_case():
    cases = [roller(axial_force=f, travel=s) for f in (30, -30) for s in (0, 1, "3 km")]
    both = {**SLIDING, "normal": "halfspace"}
    ds = tr.solve(cases, FORCES, **both)
    run = tr.wear(cases[0], 3, FORCES, **SLIDING)
    np.testing.assert_array_equal(ds.max_pressure.values[0], tr.solve(cases[0], FORCES, **both).max_pressure.values)
    assert ds.max_pressure.values[2] == pytest.approx(run.max_pressure.values[-1], rel=1e-9)
    assert ds.max_pressure.values[3:] == pytest.approx(ds.max_pressure.values[:3, ::-1], rel=1e-4)
    alone = tr.solve(cases[1], FORCES, **both)  # its bits do not depend on the other travels
    np.testing.assert_array_equal(ds.normal_force.values[1], alone.normal_force.values)
    with pytest.raises(InputError, match="normal to halfspace"):
        tr.solve(cases[1], FORCES, **SLIDING)


@pytest.mark.slow
def test_a_travel_beyond_the_end_is_a_row_with_a_reason():
    cases = [roller(travel=1), roller(motor_force=-60, travel=1)]
    ds = tr.solve(cases, FORCES, normal="halfspace", **SLIDING)
    assert ds.converged.values.tolist() == [1, 0] and np.isnan(ds.max_pressure.values[1]).all()
    assert "friction can no longer transmit" in str(ds.reason.values[1]) and ds.reason.values[0] == ""
