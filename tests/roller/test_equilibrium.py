"""Equilibrium of the roller: reference numbers, balances, regimes, symmetry, tendencies."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from reference_cases import case_of, published_cases, solve_sliding

import trackroller as tr
from validation.benchmarks.samples import random_designs
from validation.extremes import scenes

FORCES = ("forces", "contact", "friction_work")
EXACT = [c for c in published_cases() if c.get("exact")]


@pytest.fixture(scope="module")
def solved():
    return solve_sliding([case_of(c) for c in EXACT], outputs=FORCES, accuracy="reference")


def test_forces_match_the_independent_quadrature(solved):
    """Forces within 2e-5 of the load, ellipse, pressures and spin moments within 1e-4, slip within 5e-6 mm or 1e-4."""
    for i, record in enumerate(EXACT):
        exact, ds = record["exact"], solved.isel(case=i)
        load = max(exact["normal_force"])
        for name in ("normal_force", "lateral_force", "driving_force"):
            np.testing.assert_allclose(ds[name], exact[name], atol=2e-5 * load, err_msg=name)
        for name in ("semi_axis_lateral", "semi_axis_rolling", "max_pressure", "spin_moment"):
            size = np.max(np.abs(exact[name]))
            np.testing.assert_allclose(ds[name], exact[name], atol=1e-4 * size, err_msg=name)
        shift = exact["rolling_radius_shift"]
        assert float(ds.rolling_radius_shift) == pytest.approx(shift, abs=5e-6, rel=1e-4)


def test_friction_power_matches_the_reference(solved):
    """int |tau| |v| per angular speed, the published local product."""
    for i, record in enumerate(EXACT):
        power = np.array(record["exact"]["friction_power_at_one_rev_per_s"]) / (2 * np.pi)
        c = record["case"]
        r_a = c["axis_distance"] - c["guide_profile_radius"] * np.cos(np.deg2rad(c["contact_angle"]))
        found = solved.friction_energy_per_distance.isel(case=i).values * r_a
        np.testing.assert_allclose(found, power, rtol=2e-4)


def test_published_hertz_reproduces_the_published_forces():
    """With the table of the published program its normal forces come within 0.3 %."""
    records = [c for c in EXACT if c.get("published") and not c["axes_swapped_in_published_program"]]
    ds = solve_sliding([case_of(c) for c in records], outputs=("forces",), hertz="published")
    for i, record in enumerate(records):
        load = max(record["published"]["normal_force"])
        np.testing.assert_allclose(ds.normal_force[i], record["published"]["normal_force"], atol=3e-3 * load)


def test_regimes_are_results():
    """Full slip and lift-off of the reference are flags, with the transmitted force in full slip."""
    records = [c for c in published_cases() if c.get("regime")]
    ds = solve_sliding([case_of(c) for c in records])
    names = ds.regime.attrs["flag_meanings"].split()
    assert [names[r] for r in ds.regime.values] == [c["regime"] for c in records]
    slipping = ds.isel(case=[names[r] for r in ds.regime.values].index("full_slip"))
    assert float(slipping.transmitted_force) == pytest.approx(0.3 * float(slipping.normal_force.sum()), rel=1e-12)
    assert np.all(slipping.lateral_force == 0) and np.isnan(slipping.rolling_radius_shift)
    lifted = ds.isel(case=[names[r] for r in ds.regime.values].index("lift_off"))
    assert np.isnan(lifted.peak_stress).all() and np.isnan(lifted.roller_life_hours)


def imbalance(case: tr.Case, ds) -> float:
    """Return the largest violation of eqs (7), (9) and the drive torque over the load, from the data set alone."""
    alpha = np.deg2rad(case.contact_angle)
    s, c = np.sin(alpha), np.cos(alpha)
    r_a = case.axis_distance - case.guide_profile_radius * c
    n, t, a, m = (ds[k].values for k in ("normal_force", "lateral_force", "driving_force", "spin_moment"))
    eqs = (
        c * t.sum() + s * (n[0] - n[1]) + case.axial_force,
        s * (t[1] - t[0]) + c * n.sum() + case.radial_force,
        (m[0] - m[1]) * s / r_a + a.sum() + case.motor_force,
    )
    return max(map(abs, eqs)) / (abs(case.radial_force) + abs(case.axial_force))


cases = st.builds(
    dict,
    radial_force=st.floats(-1e4, -1e-2),
    ax=st.floats(-0.3, 0.3),
    motor=st.floats(-0.2, 0.2),
    friction_coefficient=st.floats(0, 1),
    contact_angle=st.floats(5, 85),
    axis_distance=st.floats(8, 60),
    roller_profile_radius=st.floats(-20, -6.05),
    guide_curve_radius=st.sampled_from([np.inf, 60.0, 220.0, -300.0]),
)


def build(draw: dict) -> tr.Case:
    load = -draw["radial_force"]
    rest = {k: v for k, v in draw.items() if k not in ("ax", "motor")}
    return tr.Case(axial_force=load * draw["ax"], motor_force=load * draw["motor"], **rest)


@pytest.mark.slow
@settings(max_examples=60, deadline=None)
@given(cases)
def test_every_case_balances_or_says_why(draw):
    """Rolling cases balance to 1e-9 as seen from outside, and mirrored loads mirror them; the others have no shift."""
    case = build(draw)
    mirrored = tr.Case.from_dict({**case.as_dict(), "axial_force": -case.axial_force})
    both = solve_sliding([case, mirrored], outputs=("forces",))
    ds, other = both.isel(case=0), both.isel(case=1)
    if ds.regime == 0:
        assert ds.converged == 1
        assert imbalance(case, ds) < 1e-9
        assert np.all(ds.normal_force > 0)
        np.testing.assert_allclose(ds.normal_force, other.normal_force[::-1], rtol=1e-6)
        np.testing.assert_allclose(
            ds.lateral_force, -other.lateral_force[::-1], rtol=1e-5, atol=1e-7 * abs(case.radial_force)
        )
    else:
        assert np.isnan(ds.rolling_radius_shift)


def test_frictionless_limit_is_continuous():
    """mu = 0 exactly agrees with mu -> 0: forces, slip and stress; a motor force then means full slip."""
    free = dict(motor_force=0.0)
    zero, tiny = (solve_sliding(tr.Case(friction_coefficient=mu, **free)) for mu in (0.0, 1e-9))
    assert zero.regime == tiny.regime == 0
    np.testing.assert_allclose(zero.normal_force, tiny.normal_force, rtol=1e-8)
    assert float(zero.rolling_radius_shift) == pytest.approx(float(tiny.rolling_radius_shift), rel=1e-6)
    np.testing.assert_allclose(zero.peak_stress, tiny.peak_stress, rtol=1e-5)
    assert np.all(zero.lateral_force == 0) and np.all(zero.spin_moment == 0)
    assert solve_sliding(tr.Case(friction_coefficient=0.0, motor_force=-1.0)).regime == 1


def test_driving_braking_and_the_slip_limit():
    """More motor force, more slip of its own sign; beyond mu sum(F_N) full slip; continuous in the force there."""
    force = np.array([-69.2, -60, -30, -10, 0, 10, 30, 60, 68.0])
    ds = solve_sliding([tr.Case(motor_force=f) for f in force], outputs=("forces",))
    assert np.all(ds.regime == 0)
    assert np.all(np.diff(ds.rolling_radius_shift) > 0)
    beyond = solve_sliding(tr.Case(motor_force=-69.5), outputs=("forces",))
    assert beyond.regime == 1
    np.testing.assert_allclose(beyond.normal_force, ds.normal_force[0], rtol=0.02)


@pytest.mark.slow
@pytest.mark.parametrize("size", [0.37, 7.3])
@pytest.mark.parametrize(
    "options",
    [
        {"contact_model": "sliding"},
        {"contact_model": "kalker_table", "slip_terms": "curve"},
        {"outputs": (*FORCES, "life", "tractions", "subsurface"), "slip_terms": "profile"},
        {"outputs": (*FORCES, "life"), "accuracy": 0.01},
    ],
    ids=lambda options: options.get("contact_model", "kalker") + str(options.get("accuracy", "")),
)
def test_rollers_of_another_size_have_the_same_stresses(options, size):
    """Lengths times s and forces times s^2 leave stresses, slip and life as they are, and scale all other results.

    Rounding errors of the inputs must not pass through the searches and iterations.
    """
    power = {"mm": 1, "mm2": 2, "N": 2, "J m-1": 2, "W": 2, "N mm": 3}
    designs = [case.as_dict() for case in (tr.Case(), *random_designs(3, 312))]
    powers = dict.fromkeys(scenes.LENGTHS, 1) | dict.fromkeys(scenes.FORCES, 2)
    scaled = [d | {name: d[name] * size**exponent for name, exponent in powers.items()} for d in designs]
    small, large = (tr.solve(cases, **options) for cases in (designs, scaled))
    assert set(small.regime.values) == {0}
    for name in small.data_vars.keys() - {"residual", "energy_residual"}:
        unit = small[name].attrs.get("units")
        if unit == "h":  # a larger roller turns more slowly
            continue
        factor = size ** power.get(unit, 0)
        np.testing.assert_allclose(large[name], small[name] * factor, rtol=1e-9, err_msg=name)


def test_conditions_are_compared_in_newtons_and_millimetres():
    """`stop_if` sees the forces and lengths that a result shows."""
    plain = solve_sliding(tr.Case())
    for name in ("normal_force", "semi_axis_lateral", "spin_moment"):
        size = float(np.max(plain[name]))
        for share, stops in ((0.999, True), (1.001, False)):
            ds = solve_sliding(tr.Case(), stop_if=f"{name} > {share * size!r}")
            assert bool(np.isnan(ds.peak_stress).all()) == stops, (name, share)
