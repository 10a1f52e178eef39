"""Fatigue by multiaxial criteria: von Mises amplitude, Goodman, Findley and Dang Van, from the
stresses of a point.

The unloaded state before and after the overrolling belongs to the stress path of each point, see
`paths`.

ASSUME: Goodman's amplitude and mean are the von Mises stresses of half the difference and of the
middle of two states of a point (Budynas and Nisbett, Shigley's Mechanical Engineering Design, 10th
ed., section 6-14); the worst two count. A von Mises stress has no sign, so that a mean under
pressure lowers the strength as one under tension does. ASSUME: shakedown to the centre of the
smallest ball that holds the path of the deviator (Dang Van, mesoscopic).
"""

from __future__ import annotations

import numpy as np

from trackroller.damage.histories import RollerTractions, planes
from trackroller.damage.limit import TRACTIONS, Limit, SolvedRollers, Values, optional, variables
from trackroller.numerics.variable import LARGEST


def findley_constants(bending: np.ndarray, torsion: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return k_F [1] and the largest stress that Findley's criterion allows [MPa].

    Parameters
    ----------
    bending, torsion : numpy.ndarray
        Fully reversed limits [MPa]; their ratio lies between 1 and 2.
    """
    share = 2.0 * torsion / bending - 1.0
    k = share / np.sqrt(1.0 - share**2)
    return k, bending / 2.0 * (k + np.sqrt(1.0 + k**2))


def dang_van_constants(bending: np.ndarray, torsion: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return a_D [1] and the stress that Dang Van's criterion allows [MPa]; torsion over bending
    exceeds 0.5.
    """
    return 3.0 * (torsion / bending - 0.5), torsion


def _twice(values: np.ndarray) -> np.ndarray:
    """Return values with values between those along the last axis, by cubic interpolation."""
    out = np.empty((*values.shape[:-1], 2 * values.shape[-1] - 1), values.dtype)
    out[..., ::2] = values
    out[..., 1::2] = 0.5 * (values[..., 1:] + values[..., :-1])
    out[..., 3:-3:2] = 1.125 * out[..., 3:-3:2] - 0.0625 * (values[..., 3:] + values[..., :-3])
    return out


def stress_paths(
    t: RollerTractions, case: int, contact: int, poisson_ratio: np.ndarray
) -> np.ndarray:
    """Return the stress paths of points at the surface and below one patch.

    Parameters
    ----------
    t : RollerTractions
        The patches.
    case, contact : int
        Place of the patch.
    poisson_ratio : numpy.ndarray
        nu of both bodies, (2,) [1].

    Returns
    -------
    numpy.ndarray
        Stresses, (body, path, time, 6) [MPa]. Each path ends with the unloaded state.
    """
    # numba compiles on import, and planning reads only the declaration
    from trackroller.damage.deep_planes import deep_planes

    loads = t.loads(case, contact)
    surface = planes(loads, np.zeros(1), poisson_ratio)
    below = deep_planes(loads, poisson_ratio)
    parts = surface.swapaxes(3, 4), _twice(_twice(below).swapaxes(3, 4))
    lines = [part.transpose(0, 1, 3, 4, 2).reshape(2, -1, part.shape[4], 6) for part in parts]
    out = np.zeros(
        (2, sum(part.shape[1] for part in lines), max(part.shape[2] for part in lines) + 1, 6)
    )
    out[:, : lines[0].shape[1], : lines[0].shape[2]] = lines[0]
    out[:, lines[0].shape[1] :, : lines[1].shape[2]] = lines[1]
    return out


def evaluate(solved: SolvedRollers) -> Values:
    """Return stresses [MPa] and utilisations [1] of the criteria, (n, contact, body)."""
    # numba compiles on import, and planning reads only the declaration
    from trackroller.damage.paths import governing

    m = solved.materials
    t = solved.tractions()
    limits = m["fatigue_limit"], m["fatigue_limit_torsion"]
    (k, findley_limit), (a, dang_van_limit) = (
        findley_constants(*limits),
        dang_van_constants(*limits),
    )

    def of_patch(case: int, contact: int) -> list[np.ndarray]:
        paths = stress_paths(t, case, contact, m["poisson_ratio"][case])
        return [
            governing(*own)
            for own in zip(paths, k[case], a[case], m["tensile_strength"][case], strict=True)
        ]

    criteria = t.by_patch(of_patch, 2, 5)
    criteria[..., 0] *= np.sqrt(3.0)  # from the coordinates of the deviator to a von Mises stress
    return {
        "von_mises_amplitude": criteria[..., 0],
        "goodman_stress": criteria[..., 4],
        "findley_stress": criteria[..., 1],
        "dang_van_stress": criteria[..., 2],
        "dang_van_stress_without_pressure": criteria[..., 3],
        "findley_utilisation": criteria[..., 1] / findley_limit[:, None, :],
        "dang_van_utilisation": criteria[..., 2] / dang_van_limit[:, None, :],
        "dang_van_utilisation_without_pressure": criteria[..., 3] / dang_van_limit[:, None, :],
    }


_CB = ("contact", "body")
LIMIT = Limit(
    name="multiaxial",
    title="multiaxial fatigue (Findley, Dang Van)",
    short="multiaxial fatigue",
    group="multiaxial",
    meaning="von Mises amplitude, Goodman's, Findley's and Dang Van's stress while a point is "
    "overrolled",
    evaluate=evaluate,
    needs=(TRACTIONS,),
    results=variables(
        "multiaxial",
        (
            "von_mises_amplitude",
            _CB,
            "MPa",
            "sigma_a",
            "half the longest chord of the deviator's path, von Mises",
            LARGEST,
        ),
        (
            "goodman_stress",
            _CB,
            "MPa",
            "sigma_a/(1 - sigma_m/R_m)",
            "von Mises amplitude, fully reversed by Goodman's line",
            LARGEST,
        ),
        (
            "findley_stress",
            _CB,
            "MPa",
            "tau_a + k_F sigma_n",
            "largest stress of Findley's criterion",
            LARGEST,
        ),
        (
            "dang_van_stress",
            _CB,
            "MPa",
            "tau + a_D sigma_h",
            "largest stress of Dang Van's criterion",
            LARGEST,
        ),
        (
            "dang_van_stress_without_pressure",
            _CB,
            "MPa",
            "",
            "the same, with negative sigma_h counted as 0",
            LARGEST,
        ),
        ("findley_utilisation", _CB, "1", "", "Findley's stress over its limit", LARGEST),
        ("dang_van_utilisation", _CB, "1", "", "Dang Van's stress over its limit", LARGEST),
        (
            "dang_van_utilisation_without_pressure",
            _CB,
            "1",
            "",
            "the same, with negative sigma_h counted as 0",
            LARGEST,
        ),
    ),
    materials=(
        optional(
            "fatigue_limit_torsion",
            "tau_D",
            "MPa",
            "fully reversed fatigue limit in torsion",
            0.0,
            2e5,
        ),
    ),
    requires=("fatigue_limit_torsion",),
)
