"""Find cases with the same mechanics and mirror-symmetric rollers, so that each contact is solved
only once.

These shortcuts change no number beyond rounding; `solve(..., shortcuts=False)` switches them off.
Mirror images of whole rollers are the subject of `reflection`.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

import numpy as np

from trackroller.contact.drawn_profiles import treats_sides_alike
from trackroller.contact.quantities import Resultants, SurfaceTractions
from trackroller.numerics.numbers import rounded
from trackroller.parameters import MECHANICAL_MAPPINGS, OF_LIMITS, PARAMETERS
from trackroller.roller.case import CaseTable

if TYPE_CHECKING:
    from trackroller.roller.equilibrium import ContactLaw


def is_mirror_symmetric(table: CaseTable) -> np.ndarray:
    """Return True for rollers whose contact 2 is the mirror image of contact 1, (n,).

    They have no axial force and the same cross-section on both sides.
    """
    alike = [
        list(map(treats_sides_alike, texts))
        for texts in (table.guide_profile, table.roller_profile)
    ]
    return (table.axial_force == 0.0) & np.logical_and.reduce(np.array(alike, bool).reshape(2, -1))


def is_frictionless(table: CaseTable) -> np.ndarray:
    """Return True for cases without friction, in which all contact models agree, (n,)."""
    return table.friction_coefficient == 0.0


def distinct_mechanics(
    table: CaseTable, marks: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Group cases whose forces, tractions and stresses are equal.

    Travel speed (under constant friction), overrollings per hour and strength do not change forces
    and stresses.

    Parameters
    ----------
    table : CaseTable
        The n cases.
    marks : numpy.ndarray, optional
        Numbers that cases of a group have in common as well, (n, k).

    Returns
    -------
    rows : numpy.ndarray of int, shape (m,)
        First case of each group.
    number : numpy.ndarray of int, shape (n,)
        Number of the group of each case.
    """
    mechanical = [
        name for name, own in PARAMETERS.items() if not (own.afterwards or name in OF_LIMITS)
    ]
    columns = [getattr(table, name) for name in mechanical]
    columns += [m.youngs_modulus for m in (table.roller, table.guide)]
    columns += [m.poisson_ratio for m in (table.roller, table.guide)]
    columns.append(np.where(table.friction_law != "", table.velocity, 0.0))
    # the wear of a patch by the energy law is computed once, too
    mappings = [getattr(table, name) for name in MECHANICAL_MAPPINGS]
    for texts in (*mappings, table.loss_tables):
        known = {text: i for i, text in enumerate(dict.fromkeys(texts.tolist()))}
        columns.append(np.array([known[text] for text in texts.tolist()], dtype=float))
    values = np.stack(columns, axis=1)
    if marks is not None:
        values = np.hstack([values, marks])
    return distinct_rows(values)


def distinct_rows(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Group equal rows of an array (n, k).

    Returns
    -------
    first : numpy.ndarray of int, shape (m,)
        First row of each group, rising.
    number : numpy.ndarray of int, shape (n,)
        Number of the group of each row.
    """
    # turns -0.0 into 0.0, because the rows are compared by their bytes
    rows = np.ascontiguousarray(values + 0.0)
    keys = rows.view(np.dtype((np.void, rows.shape[1] * rows.itemsize))).reshape(-1)
    _, first, number = np.unique(keys, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty_like(order)
    rank[order] = np.arange(order.size)
    return first[order], rank[number.reshape(-1)]


def normalised_patches(patches: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Scale patches with one traction direction, or without friction, to the semi-axis a = 1.

    Their stresses over p_max depend on b/a, mu and the direction only. The ratio b/a is rounded, so
    that patches under different loads become equal. The other patches stay unchanged.

    Parameters
    ----------
    patches : numpy.ndarray, shape (n,)
        Records of `ellipse.patch_rows`.

    Returns
    -------
    scaled : numpy.ndarray, shape (n,)
        Records.
    length : numpy.ndarray, shape (n,)
        Length that stands for 1 [mm]; 1 for unchanged patches.
    """
    plain = (patches["friction"] == 0.0) | (patches["fixed"] != 0.0)
    length = np.where(plain, patches["a"], 1.0)
    out = patches.copy()
    unit = np.zeros(1, patches.dtype)  # the slip, on which the stresses do not depend
    unit["a"] = 1.0
    unit["sine"] = 0.5
    unit["cosine"] = np.sqrt(0.75)
    unit["radius"] = 1e3
    out[plain] = unit
    out["b"][plain] = rounded(patches["b"] / patches["a"])[plain]
    for name in ("friction", "fixed"):
        out[name][plain] = patches[name][plain]
    return out, length


@dataclass(frozen=True)
class Mirror:
    """Mark rollers whose two contacts are mirror images, so that only contact 1 is solved.

    Arrays over patches have contact 1 of all rollers first, then contact 2.

    Parameters
    ----------
    symmetric : numpy.ndarray of bool, shape (n,)
        True for these rollers.
    """

    symmetric: np.ndarray

    def law(self, law: ContactLaw) -> ContactLaw:
        """Return a contact law that solves contact 1 of symmetric rollers and copies it to contact
        2.
        """
        if not self.symmetric.any():
            return law

        def one_sided(ellipse, slip, friction, rows, fine):
            half = len(rows) // 2
            twin = self.symmetric[rows[half:]]
            solved = np.concatenate([np.ones(half, bool), ~twin])
            resultants = law(
                ellipse.take(solved), slip.take(solved), friction[solved], rows[solved], fine
            )
            full = np.empty((len(rows), 3))
            full[solved] = resultants.columns
            full[half:][twin] = full[:half][twin] * (-1.0, 1.0, -1.0)
            return Resultants(*full.T)

        return one_sided

    def to_solve(self, good: np.ndarray) -> np.ndarray:
        """Return True for the patches among `good` (2 n,) that have to be solved, (2 n,)."""
        return good & ~np.concatenate([np.zeros_like(self.symmetric), self.symmetric])

    def source(self, flat: np.ndarray) -> np.ndarray:
        """Return the patches (m,) that are solved for the patches `flat` (m,) of 2 n: contact 1 for
        a mirror image.
        """
        n = self.symmetric.size
        return np.where((flat >= n) & self.symmetric[flat % n], flat % n, flat)

    def _copies(
        self, good: np.ndarray, values: np.ndarray, patches: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the values (2 n, ...) with contact 1 copied to contact 2 of symmetric rollers, and
        mark the copies.
        """
        kind = values.dtype
        if values.dtype.kind == "b":
            kind = np.dtype(float)
        full = np.full((good.size, *values.shape[1:]), np.nan, dtype=kind)
        full[patches] = values
        half = good.size // 2
        twin = np.concatenate([np.zeros(half, bool), self.symmetric & good[half:]])
        full[twin] = full[:half][self.symmetric & good[half:]]
        return full, twin

    def spread(self, good: np.ndarray, values: np.ndarray, sign: float = 1.0) -> np.ndarray:
        """Copy the values of the solved patches `to_solve(good)` to all patches `good`.

        With `sign` = -1 mirror images get the negative value.
        """
        full, twin = self._copies(good, values, self.to_solve(good))
        if sign < 0:
            full[twin] = -full[twin] + 0.0
        return full[good]

    def spread_surface(self, good: np.ndarray, tractions: SurfaceTractions) -> SurfaceTractions:
        """Copy the tractions of the solved patches `to_solve(good)` to all patches `good`; x rises
        in each patch.
        """
        if not self.symmetric.any():
            return tractions
        out = {}
        for field in fields(SurfaceTractions):
            full, twin = self._copies(good, getattr(tractions, field.name), self.to_solve(good))
            if field.name != "y":
                full[twin] = full[twin][..., ::-1]
            if field.name in ("x", "shear_lateral", "slip_lateral"):
                full[twin] = 0.0 - full[twin]
            out[field.name] = full[good]
        return SurfaceTractions(**out | {"stick": out["stick"].astype(bool)})
