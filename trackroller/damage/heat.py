"""Heat of friction and hysteresis: flash and bulk temperatures of roller and guide.

Each body sees a heat source that moves over it with the travel speed (Carslaw and Jaeger), at any
Péclet number.

ASSUME: one factor parts the heat of a contact between the bodies, such that their largest
temperatures agree. ASSUME: the guide stays at ambient temperature but for the flash; the roller
loses its heat from `cooled_area` alone. ASSUME: friction and the values of heat do not depend on
temperature, and hysteresis does not change the balance. E and R_m follow the bulk temperature where
a material has a table, see `roller.temperature`.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from trackroller.damage.histories import RollerTractions
from trackroller.damage.limit import (
    TRACTIONS,
    Limit,
    SolvedRollers,
    Values,
    Verdict,
    optional,
    variables,
    worst,
)
from trackroller.numerics.parameter import Parameter
from trackroller.numerics.variable import LARGEST, SUM

# step of the logarithm of the diffusion length, and its end over the sides of the grid
STEP, REACH = 0.3, 1e4
SPREAD = 5.0  # diffusion lengths beyond which no heat arrives


def cell_temperature(
    steps: tuple[float, float], nodes: tuple[int, int], decay: float
) -> np.ndarray:
    """Return the surface temperature beside a cell that is heated uniformly while the surface moves
    towards -y.

    Parameters
    ----------
    steps : tuple of float
        Sides of the cell along x and y [mm].
    nodes : tuple of int
        Numbers of nodes along x and y.
    decay : float
        V/(4 kappa), travel speed over four times the diffusivity [1/mm].

    Returns
    -------
    numpy.ndarray
        Temperature times conductivity over heat density, at node offsets from -(n - 1) to n - 1,
        (2 ny - 1, 2 nx - 1) [mm].

    Notes
    -----
    The mean over the cell of exp(-V (r + y)/(2 kappa))/(2 pi r), written as an integral over the
    diffusion length w = sqrt(4 kappa t) of the time t since the heat was released; it holds for V =
    0 and under the cell itself.
    """
    from scipy.special import erf  # heavy, and planning reads only the declaration below

    (hx, hy), (nx, ny) = steps, nodes
    small, long = min(hx, hy), ny * hy
    # Below the first w all heat is still in its cell, and above the last it has spread or moved
    # beyond the grid.
    low = small / 8.0
    high = REACH * max(nx * hx, long)
    if decay > 0:
        low = min(low, math.sqrt(0.1 * small / decay))
        high = min(
            high, (SPREAD + math.sqrt(SPREAD**2 + 4.0 * decay * (long + hy))) / (2.0 * decay)
        )
    # heat that moves fast passes a cell in a short part of the logarithm of w
    step = STEP / max(1.0, math.sqrt(decay * long))
    w = np.exp(np.arange(math.log(low), math.log(max(high, 2.0 * low)) + step, step))[:, None]
    across = np.diff(erf(hx * (np.arange(nx + 1) - 0.5) / w))
    along = np.diff(erf((hy * (np.arange(1 - ny, ny + 1) - 0.5) + decay * w**2) / w))
    half = (along * w).T @ across
    half[ny - 1, 0] += 4.0 * w[0, 0] / math.expm1(step)  # the sum over all smaller w
    half *= 0.25 * step / math.sqrt(math.pi)
    return np.concatenate([half[:, :0:-1], half], axis=1)


def heat_density(t: RollerTractions, speed: np.ndarray) -> np.ndarray:
    """Return the heat of friction |tau . s| v of each element, (n, contact, y, x) [W/mm2], for v,
    (n,) [mm/s].
    """
    work = np.abs(t.shear_lateral * t.slip_lateral + t.shear_rolling * t.slip_rolling)
    return np.asarray(1e-3 * work * speed[:, None, None, None])


def flash(
    t: RollerTractions,
    heat: np.ndarray,
    speed: np.ndarray,
    conductivity: np.ndarray,
    diffusivity: np.ndarray,
) -> np.ndarray:
    """Return the largest temperature rise of each body if it took all heat of the contact.

    Parameters
    ----------
    t, heat : RollerTractions and numpy.ndarray
        The patches, and their heat density, (n, contact, y, x) [W/mm2].
    speed : numpy.ndarray
        v, (n,) [mm/s].
    conductivity, diffusivity : numpy.ndarray
        K [W/(mm K)] and kappa [mm2/s] of roller and guide, (n, 2).

    Returns
    -------
    numpy.ndarray
        Rise, (n, contact, body) [K].
    """
    from scipy import fft  # heavy, and planning reads only the declaration below

    def of_patch(case: int, contact: int) -> Any:
        at = case, contact
        if not np.isfinite(heat[at]).all() or not np.isfinite(diffusivity[case]).all():
            return np.nan
        steps = [(axis[-1] - axis[0]) / (axis.size - 1) for axis in (t.x[at], t.y[at])]
        nodes = heat[at].shape[::-1]
        decays = (speed[case] / (4.0 * diffusivity[case])).tolist()
        kernels = {
            decay: cell_temperature((steps[0], steps[1]), nodes, decay)
            for decay in dict.fromkeys(decays)
        }
        lengths = [fft.next_fast_len(2 * n - 1, real=True) for n in heat[at].shape]
        spectra = fft.rfft2(heat[at], lengths) * fft.rfft2(
            np.stack(list(kernels.values())), lengths
        )
        rises = fft.irfft2(spectra, lengths)[_middle(heat)].max(axis=(1, 2), initial=0.0)
        return [rises[list(kernels).index(decay)] for decay in decays] / conductivity[case]

    return t.by_patch(of_patch, 2)


def _middle(heat: np.ndarray) -> tuple[Any, slice, slice]:
    """Return the part of a convolution with a kernel of all offsets that lies on the patch; nothing
    wraps onto it.
    """
    ny, nx = heat.shape[2:]
    return ..., slice(ny - 1, 2 * ny - 1), slice(nx - 1, 2 * nx - 1)


def hysteresis_moments(
    force: np.ndarray, length: np.ndarray, loss: np.ndarray, compliance: np.ndarray
) -> np.ndarray:
    """Return the moment that the loss of strain energy takes in each body, 3 alpha P b/16 (Johnson
    1985, ch. 9).

    Parameters
    ----------
    force, length : numpy.ndarray
        Normal force [N] and semi-axis b along the rolling direction [mm], (n, contact).
    loss, compliance : numpy.ndarray
        Share alpha of the strain energy that a body loses in a cycle [1], and (1 - nu^2)/E, (n,
        body).

    Returns
    -------
    numpy.ndarray
        Moments, (n, contact, body) [N mm]. The bodies store energy in proportion to their
        compliance.
    """
    share = compliance / compliance.sum(axis=1, keepdims=True)
    return np.asarray(3.0 / 16.0 * (force * length)[:, :, None] * (loss * share)[:, None, :])


def evaluate(solved: SolvedRollers) -> Values:
    """Return temperature rises [K], (n, contact, body), partition, hysteresis and
    pressure-velocity, (n, contact).

    `drive_torque` [N mm] and `rolling_resistance` [N], (n,), take in the hysteresis of both
    contacts.
    """
    m = solved.materials
    v = solved.values
    c = solved.cases
    t = solved.tractions()
    speed = c["velocity"] * 1e3 / 60.0
    conductivity = 1e-3 * m["thermal_conductivity"]
    diffusivity = 1e6 * m["thermal_conductivity"] / (m["density"] * m["heat_capacity"])
    heat = heat_density(t, speed)
    whole = flash(t, heat, speed, conductivity, diffusivity)
    total = whole.sum(axis=2)
    with np.errstate(divide="ignore", invalid="ignore"):
        partition = np.where(total > 0, whole[:, :, 1] / total, 0.5 + 0.0 * total)
    cell = (t.x[:, :, 1] - t.x[:, :, 0]) * (t.y[:, :, 1] - t.y[:, :, 0])
    slides = np.hypot(t.slip_lateral, t.slip_rolling) * t.pressure
    soft = (1.0 - m["poisson_ratio"] ** 2) / m["youngs_modulus"]
    moments = hysteresis_moments(
        v["normal_force"], v["semi_axis_rolling"], m["loss_fraction"], soft
    )
    lost = 1e-3 * moments[:, :, 0] * (speed / solved.rolling_radius)[:, None]
    power = (partition * heat.sum(axis=(2, 3)) * cell + lost).sum(axis=1)
    bulk = power / (1e-6 * c["heat_transfer_coefficient"] * c["cooled_area"])
    flashes = whole * np.stack([partition, 1.0 - partition], axis=2)
    bulks = np.stack([bulk[:, None] + 0.0 * partition, 0.0 * partition], axis=2)
    room = (m["temperature_limit"] - c["ambient_temperature"][:, None])[:, None, :]
    rise = flashes + bulks
    # a body whose surroundings are too hot is over its limit without any heat of its own
    used = np.where(
        (room <= 0.0) & ~np.isnan(rise), np.inf, rise / np.where(room > 0.0, room, np.nan)
    )
    lossy = np.nan_to_num(moments.sum(axis=2).sum(axis=1))
    with_hysteresis = {}
    if "rolling_resistance" in v:
        resistance = v["rolling_resistance"] + lossy / solved.rolling_radius
        with_hysteresis["rolling_resistance"] = resistance
    return {
        # the drive turns the roller against the loss; without a known loss the torque is that of
        # the tractions alone one axis after the other: the order of a sum over two depends on the
        # number of cases
        "drive_torque": v["drive_torque"] + lossy,
        **with_hysteresis,
        "flash_temperature_rise": flashes,
        "bulk_temperature_rise": bulks,
        "heat_utilisation": used,
        "heat_partition": partition,
        "hysteresis_moment": moments.sum(axis=2),
        "pressure_velocity": 1e-3
        * speed[:, None]
        * slides.sum(axis=(2, 3))
        * cell
        / v["patch_area"],
    }


_CB = ("contact", "body")
_C = ("contact",)
LIMIT = Limit(
    name="heat",
    title="heat (temperature limit of the material)",
    short="heat",
    group="heat",
    meaning="flash and bulk temperature of roller and guide, hysteresis, pressure times velocity",
    evaluate=evaluate,
    verdict=lambda solved, results: Verdict(worst(results["heat_utilisation"]), None),
    needs=(TRACTIONS,),
    results=variables(
        "heat",
        (
            "flash_temperature_rise",
            _CB,
            "K",
            "theta_f",
            "largest rise of the surface temperature in the patch",
            LARGEST,
        ),
        (
            "bulk_temperature_rise",
            _CB,
            "K",
            "theta_b",
            "mean temperature rise of the body by friction and hysteresis",
            LARGEST,
        ),
        (
            "heat_utilisation",
            _CB,
            "1",
            "",
            "temperature rise over what the material's limit leaves",
            LARGEST,
        ),
        ("heat_partition", _C, "1", "beta", "share of the heat that flows into the roller"),
        (
            "hysteresis_moment",
            _C,
            "N mm",
            "M_h",
            "rolling resistance by the loss of strain energy in both bodies",
            SUM,
        ),
        (
            "pressure_velocity",
            _C,
            "MPa m s-1",
            "p v",
            "mean of pressure times slip speed over the patch",
            LARGEST,
        ),
    ),
    parameters=(
        optional(
            "heat_transfer_coefficient",
            "h",
            "W/(m2 K)",
            "heat transfer coefficient of the roller",
            0.0,
        ),
        optional("cooled_area", "A_c", "mm2", "surface from which the roller loses heat", 0.0),
        Parameter(
            "ambient_temperature",
            "theta_0",
            "degC",
            20.0,
            "temperature of the surroundings",
            -100.0,
            1000.0,
            role="condition",
        ),
    ),
    materials=(
        optional(
            "loss_fraction",
            "alpha",
            "-",
            "share of the strain energy lost in a cycle",
            0.0,
            1.0,
            closed=True,
        ),
        optional("thermal_conductivity", "K", "W/(m K)", "thermal conductivity", 0.0, 5e3),
        optional("heat_capacity", "c", "J/(kg K)", "heat capacity", 0.0, 2e4),
        optional("density", "rho", "kg/m3", "density", 0.0, 3e4),
        optional(
            "temperature_limit", "theta_max", "degC", "highest temperature in use", -100.0, 4e3
        ),
    ),
    requires=(
        "thermal_conductivity",
        "heat_capacity",
        "density",
        "loss_fraction",
        "temperature_limit",
        "heat_transfer_coefficient",
        "cooled_area",
    ),
    compares=("heat_utilisation", "temperature rise that the material allows"),
    assumes=(
        "Heat: friction and values of materials do not depend on temperature, but E and R_m "
        "where a table is given.",
    ),
)
