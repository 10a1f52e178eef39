"""The stage that balances the rollers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from trackroller.contact.quantities import Patch, Resultants
from trackroller.contact.slip import Slip
from trackroller.roller import equilibrium as eq
from trackroller.roller.equilibrium.corrected import balance_again, merged, solve_corrected, solve_some
from trackroller.roller.stages.scene import Scene


def balance(scene: Scene, near: eq.Equilibrium | None = None) -> eq.Equilibrium:
    """Return the equilibrium of the cases of a scene, arrays (n,); `near` is one from which the search can start.

    A model that offers a corrected law is solved with it. Rollers that do not settle so are solved with the law itself.
    Where the law itself finds no balance, the last corrected one is kept, with its last correction as residual.
    """
    correction = scene.model.correction
    if correction is None and near is not None:
        return balance_again(scene.loads, scene.mirror.law(scene.law), np.arange(scene.n), near)
    if correction is None:
        return eq.solve_equilibrium(scene.loads, scene.mirror.law(scene.law))

    def law(patch: Patch, slip: Slip, friction: np.ndarray, rows: np.ndarray, fine: bool) -> Resultants:
        return correction.law(patch, scene.kinematics(slip, rows), friction, rows, fine)

    def correct(rows: np.ndarray, balanced: eq.Equilibrium) -> np.ndarray:
        in_rows = np.zeros(scene.n, bool)
        in_rows[rows] = True
        solved = np.flatnonzero(scene.mirror.to_solve(np.tile(in_rows, 2)))
        patch, slip = scene.contacts(balanced)
        number = solved % scene.n
        change = correction.solve(patch.take(solved), slip.take(solved), scene.loads.friction[number], number)
        largest = np.zeros(scene.n)
        np.maximum.at(largest, number, change)  # NaN stays NaN
        return largest[rows]

    loads = replace(scene.loads, difference_step=correction.difference_step, converged=correction.residual)
    balanced, unsettled = solve_corrected(loads, scene.mirror.law(law), correct)
    if unsettled.size:
        correction.forget(unsettled)
        own = solve_some(scene.loads, scene.mirror.law(scene.law), unsettled)
        solved = np.flatnonzero((own.regime != eq.FAILED) | (balanced.regime[unsettled] != eq.ROLLING))
        balanced = merged(balanced, unsettled[solved], own, solved)
    return balanced
