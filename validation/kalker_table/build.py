"""Build the table of `trackroller.contact.table` from solutions by elements.

snakemake -s validation/Snakefile --cores all kalker_table      solves the levels side by side, then joins them
python -m validation.adopt kalker_table                         takes the table over into the package
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.interpolate import make_interp_spline

from trackroller.contact.linear import creepage_coefficients
from trackroller.contact.table import spline as table
from trackroller.contact.table.coordinates import HALF_WAY, spin_arm
from validation.kalker_table.nodes import FORCES, LOG_RATIOS, PARTS, POISSON, Nodes, radius, solve_exact

# Fine grids are cheap where much of a patch slides, most of all at rho = 1.
ELEMENTS, SLIDING_ELEMENTS = (28, 32), 40
MOSTLY_SLIDING = 8  # first level of rho that is solved with the larger number of ELEMENTS
ROUGH_ELEMENTS = 24  # for the coefficients in Poisson's ratio
RATIOS_OF_POISSON = (0.0, table.POISSON, 0.5)
# ends of rho, chi, theta and ln g
ENDS = ((0.0, 1.0), (0.0, np.pi / 2), (-np.pi / 2, np.pi / 2), LOG_RATIOS)
GHOSTS = 3  # nodes mirrored over each end of chi and theta
STICKING = 0.02  # r at which patches are solved for the coupling in full adhesion
REFLECTED = np.array([1.0, -1.0, 1.0, 1.0])  # signs of the fields if X and Z change their signs


def _solve(nodes: Nodes, level: int, poisson: float, elements: int) -> np.ndarray:
    """Return the results of all nodes at rho = level/PARTS, (chi, theta, ln g, 4)."""
    chi, theta, g = nodes.mesh()
    flat = np.empty((chi.size, 4))
    mirrored = (chi == 0.0) & (theta < 0.0)
    pick = np.flatnonzero(~mirrored)
    flat[pick] = solve_exact(g[pick], poisson, radius(level / PARTS), chi[pick], theta[pick], elements)
    out = flat.reshape(*nodes.shape, 4)
    half = nodes.shape[1] // 2
    out[0, :half] = (
        out[0, : half - 1 : -1] * REFLECTED
    )  # without coupling the forces are odd functions of the creepages
    return out


def solve_level(level: int, small: bool = False) -> dict[str, np.ndarray]:
    """Return the arrays at rho = level/PARTS: `forces`, and `poisson` where Poisson's ratio has nodes.

    `small` takes 16 nodes and few elements: it shows that a level is solved.
    """
    if small:
        return {"forces": _solve(replace(FORCES, chi=2, half_theta=FORCES.half_theta[::8], ratios=2), level, 0.3, 8)}
    elements = SLIDING_ELEMENTS if level == PARTS else ELEMENTS[level >= MOSTLY_SLIDING]
    arrays = {"forces": _solve(FORCES, level, table.POISSON, elements)}
    if level in POISSON.levels[:-1]:  # Poisson's ratio changes nothing in full sliding
        arrays["poisson"] = np.stack([_solve(POISSON, level, nu, ROUGH_ELEMENTS) for nu in RATIOS_OF_POISSON])
    return arrays


def adhesion(nodes: Nodes, poisson: float) -> np.ndarray:
    """Return the limit of the results over rho at rho = 0, from linear theory, shape (chi, theta, ln g, 4)."""
    chi, theta, g = nodes.mesh()
    c, log_g = creepage_coefficients(g, poisson), nodes.log_g
    # At chi = 90 deg the creepage is -Z. Only the difference between Z and the effect of K leaves a force.
    alone = solve_exact(np.exp(log_g), poisson, STICKING, np.pi / 2, 0.0, SLIDING_ELEMENTS)[:, 1] / STICKING
    left = np.broadcast_to(alone, nodes.shape).ravel()
    y = np.cos(chi) * np.cos(theta) / spin_arm(g)
    driving = left * np.sin(chi) - np.cos(chi) * np.sin(theta)
    forces = HALF_WAY * np.stack([c.c23 / c.c11 * y, driving, -c.c33 / c.c11 * y], axis=1)
    return np.concatenate([forces, np.ones((len(forces), 1))], axis=1).reshape(*nodes.shape, 4)


def _fields(nodes: Nodes, poisson: float, levels: Sequence[np.ndarray]) -> np.ndarray:
    """Return the smooth fields of the table, shape (rho, chi, theta, ln g, 4), from the results at rho > 0."""
    values = np.stack([adhesion(nodes, poisson), *levels])
    values[1:, ..., :3] /= nodes.rho[1:, None, None, None, None]
    spin = np.cos(nodes.chis)[:, None] * np.cos(nodes.theta)
    values[..., [0, 2]] /= spin[None, :, :, None, None]
    return values


def _continued(nodes: Nodes, values: np.ndarray) -> tuple[tuple[np.ndarray, ...], np.ndarray]:
    """Return nodes and fields that are continued over both ends of chi and theta by their symmetries."""
    chi, theta = nodes.chis, nodes.theta
    signs = np.tile(REFLECTED, values.shape[-1] // 4)
    below = values[:, GHOSTS:0:-1, ::-1] * signs
    above = values[:, : -GHOSTS - 1 : -1, ::-1]
    values = np.concatenate([below, values, above], axis=1)
    chi = np.concatenate([-chi[GHOSTS:0:-1], chi, np.pi - chi[: -GHOSTS - 1 : -1]])
    values = np.concatenate([values[:, :, GHOSTS - 1 :: -1], values, values[:, :, : -GHOSTS - 1 : -1]], axis=2)
    theta = np.concatenate([-np.pi - theta[GHOSTS - 1 :: -1], theta, np.pi - theta[: -GHOSTS - 1 : -1]])
    return (nodes.rho, chi, theta, nodes.log_g), values


def spline(nodes: Nodes, values: np.ndarray) -> table.TensorSpline:
    """Interpolate fields (rho, chi, theta, ln g, fields) by cubic splines along each axis in turn."""
    axes, values = _continued(nodes, values)
    knots = []
    for axis, (x, (low, high)) in enumerate(zip(axes, ENDS, strict=True)):
        s = make_interp_spline(x, values, k=3, axis=axis)
        # keep the splines that do not vanish between the ends
        first, last = np.searchsorted(s.t[4:-4], low, "right"), np.searchsorted(s.t[4:-4], high, "left")
        knots.append(s.t[first : last + 8])
        values = np.moveaxis(s.c[first : last + 4], 0, axis)  # scipy keeps the axis of the knots in front
    return table.TensorSpline(tuple(knots), np.ascontiguousarray(values))


def poisson_fields(levels: Sequence[np.ndarray]) -> np.ndarray:
    """Return the first and second coefficient of the fields in nu - 0.3, (rho, chi, theta, ln g, 8).

    `levels` are the results at rho > 0 for three Poisson's ratios, (3, chi, theta, ln g, 4) each.
    """
    sliding = np.zeros_like(levels[0][0])
    by_ratio = [
        _fields(POISSON, nu, [*(level[k] for level in levels), sliding]) for k, nu in enumerate(RATIOS_OF_POISSON)
    ]
    change = np.array([RATIOS_OF_POISSON[0], RATIOS_OF_POISSON[2]]) - table.POISSON
    powers = np.linalg.inv(np.stack([change, change**2], axis=1))
    differences = np.stack([by_ratio[0] - by_ratio[1], by_ratio[2] - by_ratio[1]])
    return np.concatenate(list(np.einsum("pk,k...->p...", powers, differences)), axis=-1)


def join(levels: Sequence[dict[str, np.ndarray]]) -> dict[str, table.TensorSpline]:
    """Return the splines `forces` and `poisson` from the arrays of all levels of `solve_level`, in their order."""
    forces = _fields(FORCES, table.POISSON, [level["forces"] for level in levels])
    changes = poisson_fields([level["poisson"] for level in levels if "poisson" in level])
    return {"forces": spline(FORCES, forces), "poisson": spline(POISSON, changes)}


def write(path: Path, splines: dict[str, table.TensorSpline], errors: dict[str, float]) -> None:
    """Write knots, coefficients (single precision) and measured errors to an npz file."""
    arrays: dict[str, np.ndarray] = {
        "error_names": np.array(list(errors), dtype="U40"),
        "error_values": np.array(list(errors.values())),
    }
    for name, one in splines.items():
        arrays.update({f"{name}_knots_{i}": k for i, k in enumerate(one.knots)})
        arrays[f"{name}_values"] = one.values.astype(np.float32)
    np.savez_compressed(path, **arrays)  # type: ignore[arg-type]
