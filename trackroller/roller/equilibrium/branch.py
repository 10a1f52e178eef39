"""Which of several equilibria near self-locking: solutions followed from little friction to the given."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from trackroller.roller.equilibrium.newton import bracketed, newton_polish
from trackroller.roller.equilibrium.roller import LIFTED, ContactLaw, Loads, Roller


def follow_friction(loads, law, rows, low, high):
    """Solutions followed from little friction to the given; a contact that lifts off on the way stays off.

    Near self-locking, mu f = tan(alpha), the equations have several solutions or none; the one that grows out of the
    frictionless wedge is the one that loading reaches. Returns what `newton_polish` does, and the rows that lift off.
    """
    m = rows.size
    lifted, w = np.zeros(m, bool), np.zeros(m)
    normal = np.full((2, m), np.nan)
    best, f = np.full(m, np.inf), np.full((3, 2, m), np.nan)
    lost, found, grip = np.zeros(m, bool), np.zeros(m, bool), np.zeros(m)
    scale = np.ones_like(loads.friction)
    tangent = np.tan(loads.contact_angle[rows])
    start = np.clip(0.2 * tangent / loads.friction[rows], 1e-8, 0.05)  # well before the wedge may lock
    load, pushed = Roller(loads, law, rows).load, loads.axial_force[rows] != 0
    shed = np.zeros(m, bool)  # a branch that ends where friction nearly carries the lateral load has shed a contact
    for k in range(21):
        go = np.flatnonzero(~shed & ~lifted)
        if go.size == 0:
            break
        scale[rows] = np.maximum(start ** (1 - k / 20), k / 20)
        eased = replace(loads, friction=loads.friction * scale, motor_force=loads.motor_force * scale)
        roller = Roller(eased, law, rows[go])
        if k == 0:
            w, normal = bracketed(roller, low.copy(), high.copy(), fine=True, sweeps=60, tolerance=1e-12)
        # to the last digit: small differences grow along a branch that nearly locks
        best[go], w_new, n_new, f[:, :, go] = newton_polish(roller, w[go], normal[:, go], low[go], high[go])
        fine = best[go] <= 1e-8
        lost[go], found[go] = lost[go] | ~fine, found[go] | np.isfinite(best[go])
        shrunk = np.any(normal[:, go] < 0.15 * roller.load, axis=0)
        lifted[go] = np.where(fine, np.any(n_new <= LIFTED * roller.load, axis=0), shrunk)
        on = go[fine]
        w[on], normal[:, on] = w_new[fine], n_new[:, fine]
        with np.errstate(invalid="ignore"):
            grip[on] = np.max(np.abs(f[0][:, on] / normal[:, on]), axis=0) / tangent[on]
        shed = lost & ((grip > 0.5) | np.any(normal < 0.2 * load, axis=0)) & pushed
    best = np.where(lost, np.inf, best)
    lifted |= np.where(lost, shed, ~Roller(loads, law, rows).wedged(normal, f))
    return best, w, normal, f, lifted & found  # a law that has no answer at all tells nothing


def self_locking(loads: Loads, law: ContactLaw, rows: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Would friction lock the wedge of these rollers without axial force, mu f >= tan(alpha)? Shape (m,).

    Then the even balance is unstable: the lateral friction turns with the load, and the slightest axial force sheds a
    contact. Judged with the coarse law; one without an answer says no.
    """
    roller = Roller(replace(loads, axial_force=np.zeros_like(loads.axial_force)), law, rows)
    w, normal = bracketed(roller, low.copy(), high.copy(), fine=False, sweeps=25, tolerance=1e-3)
    return roller.grips(normal, roller.contact(roller.shift(w), normal, False))
