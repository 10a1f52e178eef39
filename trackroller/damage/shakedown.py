"""Plastic limits: elastic limit, elastic shakedown by Melan's theorem, and surface fatigue.

A residual stress that depends on depth alone and loads no surface has the components xx, yy and xy.
At each depth the one that makes the largest J2 over the plane smallest is the centre of a smallest
ball; yz and zx cannot be relieved. Stresses shake down while the radius of this ball stays below
the shear yield stress k = yield/sqrt(3) at every depth.

ASSUME: residual stress depends on depth alone; by Melan the limit found is a lower bound of the
true one. ASSUME: at the surface itself only the shear traction counts, as in Johnson's 1/mu.
Stresses in the plane of the surface would lower the limit of a patch that slides with mu = 0.4 by 4
to 7 % more.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from trackroller.damage.histories import RollerTractions
from trackroller.damage.limit import (
    TRACTIONS,
    Limit,
    LimitUse,
    SolvedRollers,
    Values,
    variables,
    worst,
)
from trackroller.numerics.variable import BODIES, LARGEST


def _shears_of_patches(
    t: RollerTractions, poisson_ratio: np.ndarray, wanted: np.ndarray, hertzian: bool
) -> np.ndarray:
    """Return the shear yield stress at which the stresses below solved patches just shake down.

    `wanted` marks patches and bodies of `t.solved_patches`, (m, body), and the result has its
    shape [MPa]; it is NaN where no number is wanted.
    """
    # numba compiles on import, and planning needs none of it
    from trackroller.damage.deep_planes import LoadedPatches, shakedown_shears

    out = np.full(wanted.shape, np.nan)
    some = wanted.any(axis=1)
    if not some.any():
        return out
    case, contact = t.solved_patches
    at = case[some], contact[some]
    lateral, rolling, pressure = (
        field[at] for field in (t.shear_lateral, t.shear_rolling, t.pressure)
    )
    steps = np.stack(t.steps, axis=2)[at]
    own = LoadedPatches(lateral, rolling, pressure, steps, poisson_ratio[at[0]], wanted[some])
    surface = np.sqrt(np.max(lateral**2 + rolling**2, axis=(1, 2)))
    out[some] = np.maximum(shakedown_shears(own, hertzian), surface[:, None])
    return out


def shears(t: RollerTractions, poisson_ratio: np.ndarray, hertzian: bool = False) -> np.ndarray:
    """Return the shear yield stress k at which the stresses below each patch just shake down.

    Parameters
    ----------
    t : RollerTractions
        The patches.
    poisson_ratio : numpy.ndarray
        nu of the bodies, (n, 2) [1].
    hertzian : bool
        Whether all patches are ellipses.

    Returns
    -------
    numpy.ndarray
        k, (n, contact, body) [MPa].
    """
    case, _ = t.solved_patches
    wanted = np.ones((case.size, len(BODIES)), dtype=bool)
    return t.of_all_patches(_shears_of_patches(t, poisson_ratio, wanted, hertzian))


def largest_shears(
    t: RollerTractions,
    poisson_ratio: np.ndarray,
    most: np.ndarray,
    bounded: np.ndarray,
    hertzian: bool = False,
) -> np.ndarray:
    """Return the shear yield stress of `shears` for the contact that decides, and a bound for a
    contact that does not.

    The contact with the larger bound is computed first. The other contact is computed only if its
    bound exceeds the number of the first.

    Parameters
    ----------
    t : RollerTractions
        The patches.
    poisson_ratio : numpy.ndarray
        nu of the bodies, (n, 2) [1].
    most : numpy.ndarray
        Upper bounds of k, (n, contact, body) [MPa]; NaN where no bound is known.
    bounded : numpy.ndarray of bool
        Bodies of which no number is wanted, (n, 2).
    hertzian : bool
        Whether all patches are ellipses.

    Returns
    -------
    numpy.ndarray
        (n, contact, body) [MPa], whose largest value over the contacts is that of `shears`; NaN
        where no number is wanted.
    """
    case, contact = t.solved_patches
    wanted = ~bounded[case]
    # an unknown bound counts as the larger one
    comes_first = contact[:, None] == np.argmax(most, axis=1)[case]
    shear = _shears_of_patches(t, poisson_ratio, wanted & comes_first, hertzian)
    first = np.fmax.reduce(t.of_all_patches(shear), axis=1)
    decided = most[case, contact] <= first[case]
    others = wanted & ~comes_first
    rest = _shears_of_patches(t, poisson_ratio, others & ~decided, hertzian)
    shear = np.where(others, np.where(decided, most[case, contact], rest), shear)
    return t.of_all_patches(shear)


def bound(solved: SolvedRollers) -> np.ndarray:
    """Return an upper bound of the utilisation, (n, body) [1]: stresses that nowhere yield shake
    down without a residual stress.
    """
    return worst(solved.values["_elastic"] / solved.materials["yield_strength"][:, None, :])


def of_mechanics(solved: SolvedRollers) -> Values:
    """Return what does not depend on strength and speed.

    These are the shear yield stress that just shakes down, `_shaken`, (n, contact, body) [MPa], the
    peak stress with its error, `_elastic`, (n, contact, body) [MPa], and the largest |tau|/p of
    each patch, `_traction`, (n, contact) [1]. Where no output asks for the numbers of each contact,
    `_traction` is NaN, and `_shaken` is that of `largest_shears`.
    """
    v = solved.values
    elastic = v["peak_stress"] * (1.0 + v["error_estimate"])
    if solved.options.get("stress_bodies") == "published":
        elastic = np.full_like(elastic, np.nan)  # these peaks are those of a mean body
    bounded = LIMIT.kept_by_bound(replace(solved, values={"_elastic": elastic}))
    unknown = np.full_like(elastic, np.nan)
    out = {"_shaken": unknown, "_elastic": elastic, "_traction": unknown[:, :, 0]}
    ratio = solved.materials["poisson_ratio"]
    hertzian = solved.options.get("normal") == "hertz"
    if LIMIT.group in solved.options.get("outputs", (LIMIT.group,)):
        out["_shaken"] = shears(solved.tractions(), ratio, hertzian)
        out["_traction"] = _largest_traction(solved.tractions())
    elif not bounded.all():
        most = elastic / np.sqrt(3.0)
        out["_shaken"] = largest_shears(solved.tractions(), ratio, most, bounded, hertzian)
    return out


def _largest_traction(t: RollerTractions) -> np.ndarray:
    """Return the largest |tau|/p of each patch, (n, contact) [1]."""
    pressed = t.pressure > 0.02 * np.nanmax(t.pressure, axis=(2, 3), keepdims=True, initial=0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        local = t.shear / t.pressure
    return np.asarray(np.max(np.where(pressed, local, 0.0), axis=(2, 3)))


def evaluate(solved: SolvedRollers) -> Values:
    """Return utilisations, (n, contact, body), and surface fatigue indices, (n, contact) [1].

    The indices are mu_used - k/p_max of the weaker body, with mu_used as |F_T, F_A|/F_N of the
    whole patch and as the largest |tau|/p in it; the two differ under spin.
    """
    v = solved.values
    strength = solved.materials["yield_strength"]
    k = strength / np.sqrt(3.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        used = np.hypot(v["lateral_force"], v["driving_force"]) / v["normal_force"]
    ratio = np.min(k, axis=1)[:, None] / v["max_pressure"]
    return {
        "elastic_utilisation": v["peak_stress"] / strength[:, None, :],
        "shakedown_utilisation": v["_shaken"] / k[:, None, :],
        "surface_fatigue_index": used - ratio,
        "surface_fatigue_index_local": np.where(np.isnan(used), np.nan, v["_traction"]) - ratio,
    }


LIMIT = Limit(
    name="shakedown",
    title="elastic shakedown (no ratchetting)",
    short="shakedown",
    group="shakedown",
    meaning="elastic limit, elastic shakedown by Melan's theorem, and surface fatigue index",
    shared=of_mechanics,
    bound=bound,
    evaluate=evaluate,
    use=lambda solved, results: LimitUse(worst(results["shakedown_utilisation"]), None),
    needs=("peak_stress", TRACTIONS),
    results=variables(
        "shakedown",
        (
            "elastic_utilisation",
            ("contact", "body"),
            "1",
            "sigma_DEH,max/R_e",
            "peak stress over the yield strength",
            LARGEST,
        ),
        (
            "shakedown_utilisation",
            ("contact", "body"),
            "1",
            "k_s/k",
            "load over the load that just shakes down",
            LARGEST,
        ),
        (
            "surface_fatigue_index",
            ("contact",),
            "1",
            "mu_used - k/p_max",
            "surface fatigue index of the resultants",
            LARGEST,
        ),
        (
            "surface_fatigue_index_local",
            ("contact",),
            "1",
            "max|tau|/p - k/p_max",
            "surface fatigue index, of the largest |tau|/p",
            LARGEST,
        ),
    ),
    requires=("yield_strength",),
    compares=("shakedown_utilisation", "load that just shakes down"),
    assumes=("Shakedown: residual stresses depend on the depth alone, which gives a lower bound.",),
)
