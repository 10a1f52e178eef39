"""Make the table of `trackroller.contact.table` with the exact solver and measure its errors on a random sample.

python -m trackroller.contact.table.build              some minutes on one core
python -m trackroller.contact.table.build --check N    measures the table on N random patches and stores the errors
"""

from __future__ import annotations

import argparse
import dataclasses
import sys
from pathlib import Path

import numpy as np
from scipy.interpolate import make_interp_spline

from trackroller.contact import kalker
from trackroller.contact.common import Elastic, Ellipse
from trackroller.contact.linear import creepage_coefficients
from trackroller.contact.table import spline as table
from trackroller.numerics.quadrature import clustered_rule

RHO = 15  # intervals of rho
THETA = 13  # nodes of theta between 0 and 90 deg, at the middles of as many equal parts
RATIO, POISSON = 13, 3
RHO_UNLIKE, THETA_UNLIKE, RATIO_UNLIKE = 11, 12, 6
COUPLINGS = (0.0, 0.3, 0.7, 1.1, 1.5)
POISSON_UNLIKE = 0.3  # ASSUME: what K adds beyond the shift hardly depends on nu
FRICTION, SHEAR_MODULUS = 0.3, 1e3  # of the problem solved for the table; the dimensionless results do not see them
GHOSTS = 3  # nodes mirrored over each end of theta
SEED = 7


def problem(g, nu, rho, angle, kappa=0.0):
    """Return ellipse (c = 1 mm, N = 1 N), creepages, friction and constants of dimensionless patches, (n,) each."""
    g, nu, rho, angle, kappa = (np.array(v, float) for v in np.broadcast_arrays(g, nu, rho, angle, kappa))
    ellipse = Ellipse(1 / np.sqrt(g), np.sqrt(g), np.full(g.shape, 1.5 / np.pi))
    bend = FRICTION / (SHEAR_MODULUS * creepage_coefficients(g, nu).c11)
    length = table.HALF_WAY * bend * rho / (1.0 - rho)
    spin = length * np.cos(angle) / (np.sqrt(g + 1 / g) / 2.0)
    elastic = Elastic(np.full(g.shape, SHEAR_MODULUS), nu, kappa * FRICTION)
    return ellipse, length * np.sin(angle), spin, np.full(g.shape, FRICTION), elastic


def solve_exact(g, nu, rho, angle, kappa=0.0, elements=40, start=None):
    """Return F_T, F_A, M_R over mu N and the share of the adhesion area, (n, 4), and the tractions."""
    ellipse, xi, phi, mu, elastic = problem(g, nu, rho, angle, kappa)
    settings = kalker.KalkerSettings(elements=elements, tolerance=1e-6)
    s = kalker.solve_patch(ellipse, kalker.Creepage(xi, np.zeros_like(xi), phi), mu, elastic, settings, start)
    r = s.resultants
    return np.stack(
        [r.lateral_force / FRICTION, r.driving_force / FRICTION, r.spin_moment / FRICTION, s.stick_fraction], axis=1
    ), s.traction


def complete_sliding(g: np.ndarray, angle: np.ndarray, nodes: int = 48) -> np.ndarray:
    """Integrate F_T, F_A, M_R over mu N for tractions opposite to the rigid slip (0 < angle < pi/2), (n, 3)."""
    slope = np.tan(angle) * np.sqrt(g + 1 / g) / 2.0  # xi/phi over c; the pole lies at x = -slope
    a, b = 1 / np.sqrt(g), np.sqrt(g)
    v, w = clustered_rule(nodes)
    pole = np.clip(-slope / a, -1.0, 1.0)
    f_a, m_r = np.zeros(g.size), np.zeros(g.size)
    for low, high in ((-1.0, pole), (pole, 1.0)):
        for vi, wi in zip(v, w, strict=True):
            x = low + (high - low) * vi
            half = np.sqrt(np.maximum(1.0 - x * x, 0.0))
            arm = a * x + slope
            # With y = b half t, the direction changes fast near t = 0. The form t = eps sinh(...) gives close nodes.
            eps = np.abs(arm) / np.maximum(b * half, 1e-300)
            top = np.arcsinh(1.0 / np.maximum(eps, 1e-13))
            for vj, wj in zip(v, w, strict=True):
                t = np.maximum(eps, 1e-13) * np.sinh(top * vj)
                root = np.hypot(arm, b * half * t)
                weight = wi * (high - low) * wj * top * np.maximum(eps, 1e-13) * np.cosh(top * vj)
                p = weight * 2.0 * half * half * np.sqrt(np.maximum(1.0 - t * t, 0.0)) * 1.5 / np.pi
                safe = np.where(root > 0, root, 1.0)
                f_a -= p * arm / safe
                m_r -= p * (a * x * arm + (b * half * t) ** 2) / safe
    return np.stack([np.zeros(g.size), f_a, m_r], axis=1)


def linear(g, nu, angle) -> np.ndarray:
    """Return the limit of F_T, F_A, M_R over mu N rho for rho -> 0 by the linear theory, (n, 3)."""
    c = creepage_coefficients(g, nu)
    spin = np.cos(angle) / (np.sqrt(g + 1 / g) / 2.0)
    return table.HALF_WAY * np.stack([c.c23 / c.c11 * spin, -np.sin(angle), -c.c33 / c.c11 * spin], axis=1)


def _spline(nodes, values) -> table.Spline:
    """Interpolate by cubic splines along each axis in turn, without extra conditions at the ends."""
    knots = []
    for axis, x in enumerate(nodes):
        s = make_interp_spline(x, values, k=3, axis=axis)
        knots.append(s.t)
        values = np.moveaxis(s.c, 0, axis)  # scipy keeps the axis of the knots in front
    return table.Spline(tuple(knots), np.ascontiguousarray(values))


def _mirrored(angles, values, axis=1):
    """Return nodes of theta and values that are continued as even functions over both ends."""
    step = angles[1] - angles[0]
    first = np.take(values, range(GHOSTS - 1, -1, -1), axis)
    last = np.take(values, range(-1, -GHOSTS - 1, -1), axis)
    more = step * np.arange(1, GHOSTS + 1)
    return (
        np.concatenate([angles[0] - more[::-1], angles, angles[-1] + more]),
        np.concatenate([first, values, last], axis=axis),
    )


def _log_ratios(count: int) -> np.ndarray:
    return np.linspace(np.log(table.RATIOS[0]), np.log(table.RATIOS[1]), count)


def like_table(tell=print):
    """Return nodes and values for K = 0 over (rho, theta, ln g, nu)."""
    rho = np.arange(RHO + 1) / RHO
    theta = (np.arange(THETA) + 0.5) * np.pi / (2 * THETA)
    log_g = _log_ratios(RATIO)
    nu = np.linspace(0.0, 0.5, POISSON)
    th, g, v = (m.ravel() for m in np.meshgrid(theta, np.exp(log_g), nu, indexing="ij"))
    values = np.empty((RHO + 1, th.size, 4))
    parity = np.stack([np.cos(th), np.sin(th), np.cos(th)], axis=1)
    values[0, :, :3], values[0, :, 3] = linear(g, v, th) / parity, 1.0
    values[-1, :, :3], values[-1, :, 3] = complete_sliding(g, th) / parity, 0.0
    start, before = None, 0
    for i in range(RHO - 1, 0, -1):
        # Fine grids are cheap at large creepage, where the adhesion area is small.
        elements = 30 if rho[i] > 0.45 else 20
        start = start if elements == before else None
        out, start = solve_exact(g, v, np.full(g.shape, rho[i]), th, elements=elements, start=start)
        before = elements
        values[i, :, :3], values[i, :, 3] = out[:, :3] / parity / rho[i], out[:, 3]
        tell(f"rho {rho[i]:.3f}: {th.size} patches")
    values = values.reshape(RHO + 1, THETA, RATIO, POISSON, 4)
    # A cubic spline needs four nodes. Their values are those of the parabola through three Poisson's ratios.
    four = np.linspace(0.0, 0.5, 4)
    weights = np.stack(
        [
            (four - nu[1]) * (four - nu[2]) / ((nu[0] - nu[1]) * (nu[0] - nu[2])),
            (four - nu[0]) * (four - nu[2]) / ((nu[1] - nu[0]) * (nu[1] - nu[2])),
            (four - nu[0]) * (four - nu[1]) / ((nu[2] - nu[0]) * (nu[2] - nu[1])),
        ],
        axis=1,
    )
    theta, values = _mirrored(theta, np.einsum("mn,rtgnf->rtgmf", weights, values))
    return (rho, theta, log_g, four), values


def unlike_shift(like: table.Spline, log_g, force) -> np.ndarray:
    """Return the coefficients of s(ln g), for which the creepage s kappa C11 gives the same force as K alone.

    `force` is F_A/(mu N) without creepage at the smallest coupling of the table, (nodes of ln g,).
    """
    rho = np.linspace(0.0, 0.9, 400)
    found = []
    for x, f in zip(log_g, force, strict=True):
        g = np.full(rho.size, np.exp(x))
        d = table.Dimensionless(g, np.full(rho.size, POISSON_UNLIKE), rho, np.zeros(rho.size), 0 * rho, 0 * rho)
        r = table.HALF_WAY * rho / (1.0 - rho)
        k = np.argmax(table.like_forces(like, d, r)[1] < f)
        c11 = creepage_coefficients(g[:1], np.full(1, POISSON_UNLIKE)).c11[0]
        found.append(r[k] / c11 / COUPLINGS[1])
    return np.polyfit(log_g, found, len(log_g) - 1)


def unlike_table(like: table.Spline, tell=print):
    """Return the coefficients of the shift, and nodes and values of the remaining effect of K.

    The axes of the values are (rho, theta, ln g, kappa).
    """
    rho = np.arange(RHO_UNLIKE + 1) / RHO_UNLIKE
    theta = (np.arange(THETA_UNLIKE) + 0.5) * np.pi / THETA_UNLIKE - np.pi / 2
    log_g = _log_ratios(RATIO_UNLIKE)
    th, g, kappa = (m.ravel() for m in np.meshgrid(theta, np.exp(log_g), COUPLINGS, indexing="ij"))
    exact = np.zeros((RHO_UNLIKE + 1, th.size, 4))
    start = None
    for i in range(RHO_UNLIKE - 1, -1, -1):
        exact[i], start = solve_exact(g, POISSON_UNLIKE, np.full(g.shape, rho[i]), th, kappa, 20, start)
        tell(f"unlike, rho {rho[i]:.3f}: {th.size} patches")
    shape = (RHO_UNLIKE + 1, THETA_UNLIKE, RATIO_UNLIKE, len(COUPLINGS), 4)
    shift = unlike_shift(like, log_g, exact.reshape(shape)[0, 0, :, 1, 1])
    values = _beyond_shift(like, shift, exact, rho, th, g, kappa)
    theta, values = _mirrored(theta, values.reshape(shape))
    return shift, (rho, theta, log_g, np.array(COUPLINGS)), values


def _beyond_shift(like, shift, exact, rho, th, g, kappa) -> np.ndarray:
    values = np.zeros_like(exact)
    nu = np.full(g.shape, POISSON_UNLIKE)
    c11 = creepage_coefficients(g, nu).c11
    for i in range(rho.size - 1):
        r = table.HALF_WAY * rho[i] / (1.0 - rho[i])
        d = table.Dimensionless(g, nu, r * np.sin(th), r * np.cos(th), kappa, c11)
        shifted = table.like_forces(like, d, d.along + kappa * c11 * np.polyval(shift, np.log(g))).T
        # The small interpolation error at kappa = 0 is not an effect of K, so it is subtracted.
        plain = table.like_forces(like, d, d.along).T
        own = np.repeat((exact[i] - plain)[kappa == 0.0], len(COUPLINGS), axis=0)
        values[i] = exact[i] - own - shifted
    return values / np.stack([np.cos(th), np.ones(th.size), np.cos(th), np.ones(th.size)], axis=1)


def sample(n: int, seed: int) -> dict[str, np.ndarray]:
    """Return n random dimensionless patches over the whole range; half of them have unlike bodies."""
    rng = np.random.default_rng(seed)
    g = np.exp(rng.uniform(np.log(table.RATIOS[0]), np.log(table.RATIOS[1]), n))
    size = 10 ** rng.uniform(-1, np.log10(table.LARGEST_COUPLING), n)
    kappa = np.where(np.arange(n) % 2, rng.choice([-1, 1], n) * size, 0.0)
    return {
        "g": g,
        "nu": rng.uniform(0, 0.5, n),
        "rho": rng.uniform(0.02, 0.98, n),
        "angle": rng.uniform(-np.pi / 2, np.pi / 2, n),
        "kappa": kappa,
    }


def measure(n: int, seed: int, elements: int = 40) -> dict[str, np.ndarray]:
    """Return the difference between table and exact solver on a random sample, `error` (n, 4), and the sample."""
    s = sample(n, seed)
    exact, _ = solve_exact(s["g"], s["nu"], s["rho"], s["angle"], s["kappa"], elements)
    ellipse, xi, phi, mu, elastic = problem(s["g"], s["nu"], s["rho"], s["angle"], s["kappa"])
    t = table.solve_patch(ellipse, xi, phi, mu, elastic)
    found = np.stack(
        [
            t.resultants.lateral_force / mu,
            t.resultants.driving_force / mu,
            t.resultants.spin_moment / mu,
            t.stick_fraction,
        ],
        axis=1,
    )
    return {**s, "error": found - exact, "exact": exact}


def summary(m: dict[str, np.ndarray]) -> dict[str, float]:
    """Return median, 99 % quantile and maximum of the errors of forces and adhesion share, for K = 0 and others."""
    out: dict[str, float] = {"patches": float(len(m["g"]))}
    for name, rows in (("like", m["kappa"] == 0), ("unlike", m["kappa"] != 0)):
        force, stick = np.abs(m["error"][rows, :3]).max(axis=1), np.abs(m["error"][rows, 3])
        for what, e in (("force", force), ("stick", stick)):
            for label, q in (("median", 50), ("p99", 99), ("worst", 100)):
                out[f"{name}_{what}_{label}"] = float(np.percentile(e, q))
    return out


def write(path: Path, tables: table.Tables) -> None:
    """Write knots, coefficients (single precision) and measured errors to an npz file."""
    arrays: dict[str, np.ndarray] = {
        "error_names": np.array(list(tables.errors), dtype="U40"),
        "error_values": np.array(list(tables.errors.values())),
        "shift": tables.shift,
    }
    for name in ("like", "unlike"):
        spline = getattr(tables, name)
        arrays.update({f"{name}_knots_{i}": k for i, k in enumerate(spline.knots)})
        arrays[f"{name}_values"] = spline.values.astype(np.float32)
    np.savez_compressed(path, **arrays)  # type: ignore[arg-type]


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=Path, default=Path(table.__file__).with_name(table.TABLE))
    parser.add_argument("--check", type=int, metavar="N", help="make nothing: measure the stored table on N patches")
    options = parser.parse_args(arguments)
    if options.check:
        made = dataclasses.replace(table.stored(), errors=summary(measure(options.check, SEED)))
    else:
        like = _spline(*like_table())
        shift, *unlike = unlike_table(like)
        made = table.Tables(like, _spline(*unlike), shift, {})
        write(options.output, made)
    for name, value in made.errors.items():
        print(f"{name:24s} {value:.2e}")
    if options.check:
        write(options.output, made)
    return 0


if __name__ == "__main__":
    sys.exit(main())
