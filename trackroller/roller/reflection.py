"""Solve rollers in one handed form, and reflect the results of their mirror images.

The equations have a mirror: with the axial force of opposite sign, contacts 1 and 2 swap, and lateral quantities change
their sign. Numerical solutions break this symmetry by their errors. Rollers are therefore solved with an axial force
>= 0, so that mirrored rollers have mirrored numbers, bit for bit, and designs with both signs of the axial force are
solved once.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from trackroller.contact.drawn_profiles import treats_sides_alike
from trackroller.halfspace.arrays import COMPONENTS
from trackroller.roller.case_table import CaseTable
from trackroller.roller.dataset import VARIABLES

LATERAL = ("x", "section_x")  # dimensions along x_C
ODD_COMPONENTS = [name in ("tau_xy", "tau_xz") for name in COMPONENTS]


def handed(table: CaseTable) -> tuple[CaseTable, np.ndarray]:
    """Return the cases with axial forces >= 0 where a mirror image exists, and mark the mirrored ones, (n,)."""
    mirrored = table.axial_force < 0.0
    for texts in (table.guide_profile, table.roller_profile):
        for text in dict.fromkeys(texts[mirrored].tolist()):
            if not treats_sides_alike(text):
                mirrored &= texts != text
    loads = {"axial_force": np.where(mirrored, -table.axial_force, table.axial_force)}
    return replace(table, **loads), mirrored


def reflect(values: dict[str, np.ndarray], rows: np.ndarray) -> None:
    """Replace the results of the cases `rows` (n,), marked by True, by those of their mirror images, in place."""
    if not rows.any():
        return
    for name in VARIABLES.keys() & values.keys():  # flags have no side
        array = values[name].copy()
        array[rows] = _mirror_image(name, array[rows])
        values[name] = array


def _mirror_image(name: str, values: np.ndarray) -> np.ndarray:
    variable = VARIABLES[name]
    for axis, dimension in enumerate(variable.dims, start=1):
        if dimension == "contact":
            values = np.flip(values, axis)
        elif dimension in LATERAL:
            values = _turned(values, axis)
        elif dimension == "component":
            odd = np.reshape(ODD_COMPONENTS, (-1, *(1,) * (values.ndim - axis - 1)))
            values = np.where(odd, 0.0 - values, values)
    if variable.odd:
        return 0.0 - values
    return values


def _turned(values: np.ndarray, axis: int) -> np.ndarray:
    """Reverse an axis; NaN that fills the end of a shorter grid stays at the end."""
    moved = np.moveaxis(values, axis, -1)
    known = ~np.isnan(moved).all(axis=tuple(range(1, moved.ndim - 1)))
    size = moved.shape[-1]
    length = np.where(known.any(axis=1), size - np.argmax(known[:, ::-1], axis=1), size)
    places = length[:, None] - 1 - np.arange(size)
    places = np.where(places >= 0, places, np.arange(size)).reshape(len(moved), *(1,) * (moved.ndim - 2), size)
    return np.moveaxis(np.take_along_axis(moved, np.broadcast_to(places, moved.shape), axis=-1), -1, axis)
