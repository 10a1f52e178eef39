"""Fatigue by multiaxial criteria: von Mises amplitude, Findley and Dang Van, from the stresses during an overrolling.

The unloaded state before and after the overrolling belongs to the stress path of each point, see `paths`.

ASSUME: shakedown to the centre of the smallest ball that holds the path of the deviator (Dang Van, mesoscopic).
"""

from __future__ import annotations

import numpy as np

from trackroller.damage.histories import Tractions, planes
from trackroller.damage.limit import TRACTIONS, Limit, Results, SolvedRollers, optional, variables


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
    """Return a_D [1] and the stress that Dang Van's criterion allows [MPa]; torsion over bending exceeds 0.5."""
    return 3.0 * (torsion / bending - 0.5), torsion


def stresses(t: Tractions, case: int, contact: int, constants: np.ndarray, poisson_ratio: np.ndarray) -> np.ndarray:
    """Return amplitude, Findley's and Dang Van's stress of both bodies below one patch.

    Parameters
    ----------
    t, case, contact : the tractions and the place of the patch
    constants : k_F and a_D of both bodies, (body, 2) [1]; NaN where they are not known
    poisson_ratio : of both bodies, (2,) [1]

    Returns
    -------
    numpy.ndarray
        Amplitude, Findley, Dang Van, Dang Van without credit of pressure, (body, 4) [MPa].
    """
    from trackroller.damage.paths import governing  # numba compiles on import, and planning reads only the declaration

    out = np.empty((2, 4))
    for body, planar in enumerate(planes(t, case, contact, poisson_ratio)):
        lines = planar.transpose(0, 3, 2, 1).reshape(-1, planar.shape[2], 6)
        out[body] = governing(np.append(lines, np.zeros((len(lines), 1, 6)), axis=1), *constants[body])
    out[:, 0] *= np.sqrt(3.0)  # from the coordinates of the deviator to a von Mises stress
    return out


def evaluate(solved: SolvedRollers) -> Results:
    """Return stresses [MPa] and utilisations [1] of the criteria, (n, contact, body)."""
    m, t = solved.materials, solved.tractions()
    limits = m["fatigue_limit"], m["fatigue_limit_torsion"]
    (k, findley_limit), (a, dang_van_limit) = findley_constants(*limits), dang_van_constants(*limits)
    criteria = np.full((*t.x.shape[:2], 2, 4), np.nan)
    for case, contact in t.patches():
        constants = np.stack([k[case], a[case]], axis=1)
        criteria[case, contact] = stresses(t, case, contact, constants, m["poisson_ratio"][case])
    criteria = t.spread(criteria)
    return {
        "von_mises_amplitude": criteria[..., 0],
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
    group="multiaxial",
    meaning="von Mises amplitude, Findley's and Dang Van's stress while a point is overrolled",
    evaluate=evaluate,
    needs=(TRACTIONS,),
    results=variables(
        "multiaxial",
        ("von_mises_amplitude", _CB, "MPa", "sigma_a", "half the longest chord of the deviator's path, von Mises"),
        ("findley_stress", _CB, "MPa", "tau_a + k_F sigma_n", "largest stress of Findley's criterion"),
        ("dang_van_stress", _CB, "MPa", "tau + a_D sigma_h", "largest stress of Dang Van's criterion"),
        ("dang_van_stress_without_pressure", _CB, "MPa", "", "the same, with negative sigma_h counted as 0"),
        ("findley_utilisation", _CB, "1", "", "Findley's stress over its limit"),
        ("dang_van_utilisation", _CB, "1", "", "Dang Van's stress over its limit"),
        ("dang_van_utilisation_without_pressure", _CB, "1", "", "the same, with negative sigma_h counted as 0"),
    ),
    materials=(optional("fatigue_limit_torsion", "tau_D", "MPa", "fully reversed fatigue limit in torsion", 0.0, 2e5),),
    requires=("fatigue_limit_torsion",),
)
