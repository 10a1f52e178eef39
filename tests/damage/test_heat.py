"""Flash and bulk temperatures, hysteresis."""

import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.signal import fftconvolve

import trackroller as tr
from trackroller.damage.heat import hysteresis_moments
from trackroller.damage.moving_source import cell_temperature

STEEL = {"like": "1.7225-normalised", "thermal_conductivity": 42, "heat_capacity": 460, "density": 7850}
STEEL |= {"loss_fraction": 0.01, "temperature_limit": 150}
COOLED = {"heat_transfer_coefficient": 20, "cooled_area": 8000}


def surface(density, kernel):
    ny, nx = density.shape
    return fftconvolve(density, kernel)[ny - 1 : 2 * ny - 1, nx - 1 : 2 * nx - 1]


def semi_ellipsoid(a, b, nx, ny):
    x, y = ((2 * np.arange(n) + 1) / n - 1 for n in (nx, ny))
    return np.sqrt(np.maximum(1 - x[None, :] ** 2 - y[:, None] ** 2, 0)), (2 * a / nx, 2 * b / ny)


@pytest.mark.parametrize(("nodes", "error"), [(20, 0.01), (40, 0.004)])
def test_stationary_semi_ellipsoid_on_a_circle(nodes, error):
    """The hottest place is the centre, pi q_0 a/(4 K)."""
    q, steps = semi_ellipsoid(1.5, 1.5, nodes, nodes)
    rise = surface(q, cell_temperature(steps, (nodes, nodes), 0.0))
    assert rise.max() == pytest.approx(math.pi * 1.5 / 4, rel=error)


@pytest.mark.parametrize("decay", [0.0, 0.3, 5.0])
def test_far_field_is_the_moving_point_source(decay):
    """exp(-V (r + y)/(2 kappa))/(2 pi K r), at low and high Peclet number; this source conserves energy."""
    kernel = cell_temperature((0.01, 0.01), (40, 40), decay)
    for i, j in ((39 + 20, 39), (39 - 20, 39), (39, 39 + 25), (39 - 30, 39 + 6)):
        y, x = 0.01 * (i - 39), 0.01 * (j - 39)
        r = math.hypot(x, y)
        expected = 1e-4 * math.exp(-2 * decay * (r + y)) / (2 * math.pi * r)
        assert kernel[i, j] == pytest.approx(expected, rel=3e-3)  # the cell is no point


def test_high_speed_is_one_dimensional_conduction():
    """Blok and Jaeger: a long strip with elliptic heat density, int q(s)/sqrt(s - y) ds / sqrt(pi V/kappa)."""
    n, b, decay = 200, 1.0, 200.0
    y = (2 * np.arange(n) + 1) / n - 1
    q = np.repeat(np.sqrt(1 - y**2)[:, None], 5, axis=1)
    rise = surface(q, cell_temperature((160.0, 2 * b / n), (5, n), decay))[:, 2]
    for i in (15, 70, 130, 180):
        whole, _ = quad(lambda u, y=y[i]: 2 * math.sqrt(max(1 - (y + u * u) ** 2, 0)), 0, math.sqrt(b - y[i]))
        assert rise[i] == pytest.approx(whole / math.sqrt(4 * math.pi * decay), rel=0.005)


def test_rise_converges_with_the_elements():
    rises = []
    for n in (14, 28, 56):
        q, steps = semi_ellipsoid(1.0, 0.5, n, n)
        rises.append(surface(q, cell_temperature(steps, (n, n), 8.0)).max())
    first, second = np.abs(np.diff(rises))
    assert second < 0.5 * first and rises[1] == pytest.approx(rises[2], rel=5e-3)


def test_hysteresis_of_equal_and_unlike_bodies():
    loss, soft = np.array([[0.02, 0.02], [0.1, 0.0]]), np.array([[1.0, 1.0], [9.0, 1.0]])
    moments = hysteresis_moments(np.full((2, 2), 100.0), np.full((2, 2), 0.4), loss, soft).sum(axis=2)
    assert moments[0] == pytest.approx(3 * 0.02 * 100 * 0.4 / 16) and moments[1] == pytest.approx(
        3 * 0.09 * 100 * 0.4 / 16
    )


def solved(**case):
    materials = {"roller_material": STEEL, "guide_material": STEEL}
    outputs = ("heat", "friction_work", "forces", "contact", "limits")
    return tr.solve(tr.Case(**(materials | COOLED | case)), outputs, contact_model="sliding")


def test_equal_bodies_share_the_heat_of_friction():
    ds = solved(motor_force=0)
    assert ds.heat_partition.values == pytest.approx([0.5, 0.5], rel=1e-9)
    flash = ds.flash_temperature_rise
    assert flash.sel(body="roller").values == pytest.approx(flash.sel(body="guide").values, rel=1e-12)
    lost = (ds.hysteresis_moment / 2 / (21.75 - 6 * math.cos(math.radians(30)))).sum() * 1.0
    power = 0.5 * float(ds.friction_power.sum()) + float(lost)
    bulk = ds.bulk_temperature_rise.sel(body="roller").values
    assert bulk == pytest.approx(np.full(2, power / (20 * 8000e-6)), rel=0.01)
    used = (flash + ds.bulk_temperature_rise).max("contact") / 130
    assert ds.utilisation.sel(limit="heat").values == pytest.approx(used.values, rel=1e-12)
    mean = 0.3 * ds.pressure_velocity * ds.patch_area
    assert mean.values == pytest.approx(ds.friction_power.values, rel=0.01)


def test_speed_and_conductivity():
    slow, fast = solved(motor_force=0, velocity=10), solved(motor_force=0, velocity=160)
    assert (fast.flash_temperature_rise > 3.9 * slow.flash_temperature_rise).all()  # sqrt(16) at least
    assert (fast.flash_temperature_rise < 16 * slow.flash_temperature_rise).all()
    poor = STEEL | {"thermal_conductivity": 0.3, "heat_capacity": 1500, "density": 1400}
    ds = solved(motor_force=0, guide_material=poor)
    assert (ds.heat_partition > 0.85).all()  # the conductor takes the heat


def test_no_friction_no_flash_and_missing_values_are_named():
    ds = solved(motor_force=0, friction_coefficient=0)
    assert (ds.flash_temperature_rise == 0).all() and (ds.hysteresis_moment > 0).all()
    ds = solved(motor_force=0, cooled_area=None)
    assert np.isnan(ds.bulk_temperature_rise.sel(body="roller")).all() and (ds.flash_temperature_rise > 0).all()
    assert "heat: the case gives no cooled_area" in ds.attrs["limits_notes"]


def test_surroundings_above_the_limit_exceed_it_without_heat():
    """A frictionless roller without loss has no rise of temperature at all."""
    steel = STEEL | {"loss_fraction": 0.0}
    case = {"friction_coefficient": 0.0, "motor_force": 0, "roller_material": steel, "guide_material": steel} | COOLED
    cases = [tr.Case(**case, ambient_temperature=t) for t in (149.0, 150.0, 151.0)]
    used = tr.solve(cases, "heat", contact_model="sliding").heat_utilisation.values
    assert (used[0] == 0).all() and np.isposinf(used[1:]).all()


def test_the_drive_turns_the_roller_against_hysteresis():
    """The torque grows by the moments of both contacts, in cases of equal mechanics by those of each; power agrees."""
    lossy = [STEEL | {"loss_fraction": loss} for loss in (0.0, 0.05, 0.2)]
    cases = [tr.Case(motor_force=0, roller_material=own, guide_material=own, **COOLED) for own in lossy]
    plain, ds = (tr.solve(cases, ("forces", *more), contact_model="sliding") for more in ((), ("heat",)))
    assert ds.drive_torque.values == pytest.approx((plain.drive_torque + ds.hysteresis_moment.sum("contact")).values)
    assert ds.drive_torque[0] == plain.drive_torque[0] and (np.diff(ds.drive_torque) > 0).all()
    unknown = tr.Case(motor_force=0, roller_material={"like": "1.7225-normalised", "loss_fraction": None}, **COOLED)
    alone, with_heat = (tr.solve(unknown, ("forces", *more), contact_model="sliding") for more in ((), ("heat",)))
    assert float(alone.drive_torque) <= float(with_heat.drive_torque) < np.inf


def test_the_smaller_of_both_permissible_temperatures_counts():
    """The use is the rise over what the smaller temperature leaves above 20 degC."""
    plain = solved(motor_force=0)
    rise = (plain.flash_temperature_rise + plain.bulk_temperature_rise).max("contact").values
    for permitted, counts in ((60, 60), (400, 150)):
        used = solved(motor_force=0, permissible_temperature=permitted).utilisation.sel(limit="heat").values
        assert used == pytest.approx(rise / (counts - 20), rel=1e-12)


def test_a_permissible_temperature_takes_the_place_of_one_that_the_material_lacks():
    bare = {key: value for key, value in STEEL.items() if key not in ("like", "temperature_limit")}
    bare |= {"youngs_modulus": 210000, "poisson_ratio": 0.3, "tensile_strength": 800, "fatigue_limit": 300}
    bare |= {"cycles_at_tensile_strength": 1e3, "cycles_at_fatigue_limit": 1e6}
    unknown = solved(motor_force=0, roller_material=bare, guide_material=bare)
    assert "has no temperature_limit" in unknown.attrs["limits_notes"]
    ds = solved(motor_force=0, roller_material=bare, guide_material=bare, permissible_temperature=60)
    own = bare | {"temperature_limit": 150}
    full = solved(motor_force=0, roller_material=own, guide_material=own, permissible_temperature=60)
    assert ds.utilisation.sel(limit="heat").values == pytest.approx(full.utilisation.sel(limit="heat").values)
    assert "temperature_limit" not in ds.attrs.get("limits_notes", "")
