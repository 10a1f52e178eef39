"""Solve the recorded cases, group by group."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

import trackroller as tr
from validation.same_numbers.archive import Archive, from_dataset, text
from validation.same_numbers.groups import Group, groups


def record_group(group: Group) -> Archive:
    """Solve the cases of a group in one call.

    Parameters
    ----------
    group : Group
        Cases and options.

    Returns
    -------
    Archive
        Results and the cases themselves. A group that the version refuses leaves a text that says so: then the
        comparison shows its results as missing.
    """
    where = f"cases/{group.name}"
    archive = {f"{where}/given.json": text({"cases": group.cases, "options": group.options})}
    try:
        found = tr.solve(group.cases, **group.options)
    except (tr.InputError, TypeError) as error:
        print(f"{where}: refused: {error}")
        return archive | {f"{where}/refused": np.array(str(error))}
    return archive | from_dataset(found, where)


def record_cases(wanted: Iterable[Group] | None = None) -> Archive:
    """Solve all recorded cases, and the stresses of the public half-space functions.

    Parameters
    ----------
    wanted : iterable of Group, optional
        All groups if not given.

    Returns
    -------
    Archive
    """
    archive: Archive = {}
    chosen = groups() if wanted is None else list(wanted)
    for group in chosen:
        archive |= record_group(group)
    if wanted is None:
        archive |= _halfspace()
    print(f"{sum(len(group.cases) for group in chosen)} cases in {len(chosen)} groups")
    return archive


def _halfspace() -> Archive:
    """Return stresses under tractions that a user gives, by every public function."""
    axis = np.linspace(-1.0, 1.0, 15)
    height = np.sqrt(np.clip(1.0 - axis[:, None] ** 2 / 0.8 - axis[None, :] ** 2 / 0.6, 0.0, None))
    given = (axis, axis, 900.0 * height, 80.0 * height * axis, 120.0 * height**2)
    points = np.stack(np.meshgrid([-0.5, 0.0, 0.31], [-0.4, 0.2], [0.0, 0.07, 0.5], indexing="ij"), axis=-1)
    archive: Archive = {}
    for nu in (0.0, 0.3, 0.5):
        archive[f"cases/public_halfspace/grid_{nu}"] = tr.stress_on_grid(*given, [0.0, 0.1, 0.6], nu)
        for kind in ("bilinear", "constant"):
            stress = tr.stress_from_tractions(*given, points, nu, kind)
            archive[f"cases/public_halfspace/{kind}_{nu}"] = stress
            for function in (tr.von_mises, tr.principal_stresses, tr.max_shear):
                archive[f"cases/public_halfspace/{function.__name__}_{kind}_{nu}"] = function(stress)
    return archive
