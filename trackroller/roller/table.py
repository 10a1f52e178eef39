"""Cases as arrays: what the solver works on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trackroller.materials import Material
from trackroller.numerics.rows import Rows


@dataclass(frozen=True)
class MaterialArrays(Rows):
    """Values of one body's material, arrays of shape (n,): name, E [MPa], nu [1], R_m, sigma_D [MPa], N_Rm, N_k [1]."""

    name: np.ndarray
    youngs_modulus: np.ndarray
    poisson_ratio: np.ndarray
    tensile_strength: np.ndarray
    fatigue_limit: np.ndarray
    cycles_at_tensile_strength: np.ndarray
    cycles_at_fatigue_limit: np.ndarray

    @classmethod
    def of(cls, materials: list[Material]) -> MaterialArrays:
        """Return the arrays of a list of n materials; the same few objects fill a list of millions."""
        distinct = {id(m): m for m in materials}
        places = {key: place for place, key in enumerate(distinct)}
        index = np.array([places[id(m)] for m in materials], dtype=int)

        def values(attribute: str) -> np.ndarray:
            return np.array([getattr(m, attribute) for m in distinct.values()], dtype=float)[index]

        return cls(
            name=np.array([m.name for m in distinct.values()], dtype=object)[index],
            youngs_modulus=values("youngs_modulus"),
            poisson_ratio=values("poisson_ratio"),
            tensile_strength=values("tensile_strength"),
            fatigue_limit=values("fatigue_strength_ratio") * values("tensile_strength"),
            cycles_at_tensile_strength=values("cycles_at_tensile_strength"),
            cycles_at_fatigue_limit=values("cycles_at_fatigue_limit"),
        )


@dataclass(frozen=True)
class CaseTable(Rows):
    """Checked cases as arrays of shape (n,), with the units of `PARAMETERS` and the friction coefficient resolved.

    The mappings of a case (friction law, drawn profiles) stand as canonical JSON in arrays of str objects, "" for none.
    """

    axis_distance: np.ndarray
    guide_profile_radius: np.ndarray
    roller_profile_radius: np.ndarray
    guide_curve_radius: np.ndarray
    contact_angle: np.ndarray
    radial_force: np.ndarray
    axial_force: np.ndarray
    motor_force: np.ndarray
    friction_coefficient: np.ndarray
    velocity: np.ndarray
    guide_overrollings_per_hour: np.ndarray
    roller: MaterialArrays
    guide: MaterialArrays
    friction_law: np.ndarray
    guide_profile: np.ndarray
    roller_profile: np.ndarray

    def __len__(self) -> int:
        return len(self.axis_distance)
