"""Choose between the equilibria near self-locking: follow the solution from low friction upwards."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from trackroller.roller.equilibrium.newton import Bounds, Solution, bracketed, newton_polish
from trackroller.roller.equilibrium.roller import LIFTED, Roller

STEPS = 20  # of the friction between its start and its full value
FOLLOWED = 1e-8  # largest residual of a solution that is followed further


def follow_friction(roller: Roller, bounds: Bounds) -> tuple[Solution, np.ndarray]:
    """Follow the solutions of m rollers from little friction to the given friction.

    Near self-locking, mu f = tan(alpha), the equations have several solutions or none. A roller that is loaded from
    zero reaches the solution that is connected to the frictionless wedge. A contact that lifts off on the way stays
    off.

    Parameters
    ----------
    roller : Roller
        The m rollers.
    bounds : Bounds
        Lowest and highest slip of each roller.

    Returns
    -------
    solution : Solution
        Solution at the given friction; the residual is inf where the branch ended before.
    lifted : numpy.ndarray of bool, shape (m,)
        True for rollers that lift off.
    """
    loads = roller.loads
    law = roller.law
    rows = roller.rows
    m = rows.size
    solution = Solution(np.full(m, np.inf), np.zeros(m), np.full((2, m), np.nan), np.full((3, 2, m), np.nan))
    lifted, lost, answered, shed, grip = *np.zeros((4, m), bool), np.zeros(m)
    scale = np.ones_like(loads.friction)
    tangent = np.tan(loads.contact_angle[rows])
    start = np.clip(0.2 * tangent / roller.friction, 1e-8, 0.05)  # well below the friction at which the wedge may lock
    for k in range(STEPS + 1):
        go = np.flatnonzero(~shed & ~lifted)
        if go.size == 0:
            break
        scale[rows] = np.maximum(start ** (1 - k / STEPS), k / STEPS)
        eased = replace(loads, friction=loads.friction * scale, motor_force=loads.motor_force * scale)
        part = Roller(eased, law, rows[go])
        if k == 0:
            solution.w[:], solution.normal[:] = bracketed(part, bounds.copy(), fine=True, sweeps=60, tolerance=1e-12)
        # down to rounding errors, because small errors grow along a branch that nearly locks
        new = newton_polish(part, solution.w[go], solution.normal[:, go], bounds.take(go))
        solution.residual[go], solution.forces[:, :, go] = new.residual, new.forces
        fine = new.residual <= FOLLOWED
        lost[go], answered[go] = lost[go] | ~fine, answered[go] | np.isfinite(new.residual)
        shrunk = np.any(solution.normal[:, go] < 0.15 * part.load, axis=0)
        lifted[go] = np.where(fine, np.any(new.normal <= LIFTED * part.load, axis=0), shrunk)
        on = go[fine]
        solution.w[on], solution.normal[:, on] = new.w[fine], new.normal[:, fine]
        with np.errstate(invalid="ignore"):
            grip[on] = np.max(np.abs(solution.forces[0][:, on] / solution.normal[:, on]), axis=0) / tangent[on]
        # a branch that ends where friction nearly carries the lateral load has lost a contact
        weak = (grip > 0.5) | np.any(solution.normal < 0.2 * roller.load, axis=0)
        shed = lost & weak & (roller.axial_force != 0)
    solution.residual[lost] = np.inf
    lifted |= np.where(lost, shed, ~roller.wedged(solution.normal, solution.forces))
    return solution, lifted & answered  # rollers for which the contact law gave no forces at all did not show lift-off


def self_locking(roller: Roller, bounds: Bounds) -> np.ndarray:
    """Return True where friction would lock the wedge without axial force, mu f >= tan(alpha), (m,).

    The balance with equal normal forces is then unstable: the lateral friction changes its sign with the load, and the
    slightest axial force makes a contact lift off. The coarse law decides; where it gives no forces, the result is
    False. Parameters are those of `follow_friction`.
    """
    loads = roller.loads
    even = Roller(replace(loads, axial_force=np.zeros_like(loads.axial_force)), roller.law, roller.rows)
    w, normal = bracketed(even, bounds.copy(), fine=False, sweeps=25, tolerance=1e-3)
    return even.grips(normal, even.contact(even.shift(w), normal, False))
