"""A rigid carriage on one-sided springs: the forces of its rollers, and the loads at which it lifts
a roller or tips.

The carriage has six freedoms. The drive holds it along the track, so that five remain:
displacements along y and z and rotations about x, y and z. Each roller presses on its rail with a
spring that takes no tension. A locating roller has a second spring along its axis, which acts as
long as the roller presses on its rail.

The radial springs have a potential energy that is convex, so that its minimum is the equilibrium
and is found by a damped Newton method, which linearises each spring at its load. The axial
stiffness follows from the radial load, and is computed again until the forces stay the same; close
to the solution, Newton's method solves for both together. A roller that is about to lift loses its
axial load by a jump, beyond which no equilibrium with this roller exists.

Rollers on one line leave the carriage free to roll about it, as a door leaf that hangs on its rail.
This freedom is left out: the carriage swings until the loads have no moment about the line, see
`trackroller.carriage.loads.swing_of`.

ASSUME: displacements are small; a lifted locating roller carries no axial load.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from scipy.optimize import brentq, linprog, nnls, root

MOTIONS = (
    "moves sideways",
    "moves up or down",
    "rolls about the x axis",
    "pitches about the y axis",
    "yaws about the z axis",
)
MOST_PASSES = 24  # of the axial stiffness; two are usual before Newton's method takes over
NEWTON = (1, 4, 11, 23)  # passes after which Newton's method is tried
MOST_STEPS = 20  # of this method
MOST_SPRINGS = 16  # linear springs whose 2^16 sets of loaded ones are all tried
MOST_SETS = 256  # carrying sets that are tried for other springs, the nearest ones first
BALANCED = 1e-9  # of the largest force: what the sums of a solution may leave
# of the largest force: how far a force of a solution may be off the one of its springs
SETTLED = 1e-7
TOUCHES = 1e-10  # of the largest force: a roller on a linear spring with less only touches its rail
UNLOADED = 1e-60  # N: a contact with less has no axial stiffness
# a carriage that holds so many times its loads counts as one that never tips
LARGEST_MULTIPLIER = 1000.0
_INFEASIBLE = 1e-9  # of the wrench: what no force of the rollers balances


class Moves(Exception):
    """The rollers do not hold the carriage.

    Parameters
    ----------
    motion : str
        How the carriage moves, one of `MOTIONS`.
    """

    def __init__(self, motion: str) -> None:
        self.motion = motion
        super().__init__(motion)


@dataclass(frozen=True)
class Springs:
    """The springs of n rollers.

    Parameters
    ----------
    radial, axial : numpy.ndarray, shape (n, 5)
        Displacement of a roller into its rail and along its axis for a unit of each freedom;
        rotations count as displacements at the distance `length`.
    locating : numpy.ndarray of bool, shape (n,)
        Whether the roller carries axial load.
    contact : numpy.ndarray, shape (n,)
        Radial approach of the two contacts over F^(2/3) [mm N^(-2/3)]; 0 for linear springs.
    tangent : numpy.ndarray, shape (n,)
        Tangent of the contact angle [1].
    radial_compliance, axial_compliance : numpy.ndarray, shape (n,)
        Compliance in series with the contacts [mm/N].
    offset : numpy.ndarray, shape (n,)
        Approach before any displacement [mm]: that of the preload, negative for play.
    length : float
        Length that turns rotations into displacements [mm].
    basis : numpy.ndarray, shape (5, m)
        The freedoms that the rollers hold, as columns; `radial` and `axial` have m columns then.
        All five by default.
    hinge : numpy.ndarray, optional
        Place (2,) along y and z of the line about which the carriage swings [mm].
    """

    radial: np.ndarray
    axial: np.ndarray
    locating: np.ndarray
    contact: np.ndarray
    tangent: np.ndarray
    radial_compliance: np.ndarray
    axial_compliance: np.ndarray
    offset: np.ndarray
    length: float
    basis: np.ndarray = field(default_factory=lambda: np.eye(len(MOTIONS)))
    hinge: np.ndarray | None = None

    def approach(self, force: np.ndarray) -> np.ndarray:
        """Return the approach of each roller to its rail under radial forces >= 0 (n,) [N],
        in mm.
        """
        return self.contact * np.cbrt(force) ** 2 + self.radial_compliance * force

    def force(self, approach: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return radial forces [N] and stiffness [N/mm] at approaches (n,) [mm]; both are 0 for a
        lifted roller.
        """
        pressed = np.maximum(approach, 0.0)
        with np.errstate(divide="ignore", invalid="ignore"):
            root = np.fmin(
                np.sqrt(pressed / self.contact), np.cbrt(pressed / self.radial_compliance)
            )
            steps = 0
            if self._mixed:
                steps = 60
            # from above: the approach is a convex function of the cube root of the force
            for _ in range(steps):
                over = self.contact * root**2 + self.radial_compliance * root**3 - pressed
                slope = 2 * self.contact * root + 3 * self.radial_compliance * root**2
                step = np.where(pressed > 0, over / slope, 0.0)
                root = root - step
                if (np.abs(step) <= 1e-15 * root).all():
                    break
            stiffness = 1.0 / (2 / 3 * self.contact / root + self.radial_compliance)
        root = np.where(pressed > 0, root, 0.0)
        return root**3, np.where(
            approach >= 0, np.where(root > 0, stiffness, self._unloaded()), 0.0
        )

    @cached_property
    def _mixed(self) -> bool:
        """Return whether a roller has a contact and a compliance in series; otherwise its force is
        a closed form.
        """
        return bool(np.any((self.contact > 0) & (self.radial_compliance > 0)))

    def _unloaded(self) -> np.ndarray:
        """Return the stiffness of a roller that just touches: that of a linear spring, 0 for a
        Hertzian contact.
        """
        with np.errstate(divide="ignore"):
            return np.where(self.contact > 0, 0.0, 1.0 / self.radial_compliance)

    def energy(self, approach: np.ndarray, force: np.ndarray) -> float:
        """Return the energy of the radial springs [N mm]."""
        complementary = (
            0.6 * self.contact * np.cbrt(force) ** 5 + 0.5 * self.radial_compliance * force**2
        )
        return float(np.sum(force * np.maximum(approach, 0.0) - complementary))

    def axial_stiffness(self, force: np.ndarray) -> np.ndarray:
        """Return the axial stiffness under radial forces > 0 (n,) [N], in N/mm.

        Both contacts of a wedge approach by u_r cos(alpha) +- u_a sin(alpha), so that the axial
        stiffness of the contacts is tan(alpha)^2 times the radial one.
        """
        of_contacts = self.contact / (1.5 * np.cbrt(force) * self.tangent**2)
        return 1.0 / (of_contacts + self.axial_compliance)

    def axial_slope(self, force: np.ndarray) -> np.ndarray:
        """Return the derivative of `axial_stiffness` by the radial force (n,) [1/mm]."""
        of_contacts = self.contact / (4.5 * np.cbrt(force) ** 4 * self.tangent**2)
        return self.axial_stiffness(force) ** 2 * of_contacts

    def linear_at(self, force: float) -> Springs:
        """Return linear springs with the compliance of these at one radial force; preload and play
        are kept.
        """
        compliance = 2 / 3 * self.contact / np.cbrt(force) + self.radial_compliance
        preload, _ = self.force(self.offset)
        offset = np.where(self.offset > 0, preload * compliance, self.offset)
        return replace(
            self, contact=np.zeros_like(compliance), radial_compliance=compliance, offset=offset
        )


@dataclass(frozen=True)
class RollerForces:
    """Forces of n rollers: `radial` >= 0 presses on the rail, `axial` acts on the roller along its
    axis [N], (n,).

    `approach` is that of each roller to its rail [mm], (n,); below 0 the roller has lifted by so
    much. `start` is the displacement, from which a similar wrench is solved faster. `converged`
    tells whether the state fulfils all conditions of an equilibrium, see `fulfils`.
    """

    radial: np.ndarray
    axial: np.ndarray
    approach: np.ndarray
    start: np.ndarray
    converged: bool = True

    @property
    def loaded(self) -> np.ndarray:
        """Return which rollers press on their rail, (n,)."""
        return self.radial > 0


def free_ways(springs: Springs) -> np.ndarray:
    """Return the motions (k, 5) of the carriage although all rollers touch their rails; k is 0 if
    they hold it.
    """
    rows = np.vstack([springs.radial, springs.axial[springs.locating]])
    _, values, ways = np.linalg.svd(rows)
    values = np.concatenate([values, np.zeros(len(ways) - values.size)])
    return np.asarray(ways[values <= 1e-9 * values[0]])


def without(springs: Springs, way: np.ndarray, hinge: np.ndarray) -> Springs:
    """Return the springs without one freedom, a motion (5,) of length 1 about the line `hinge`."""
    _, _, ways = np.linalg.svd(way[None, :])
    basis = ways[1:].T
    return replace(
        springs,
        radial=springs.radial @ basis,
        axial=springs.axial @ basis,
        basis=basis,
        hinge=hinge,
    )


def motion_of(way: np.ndarray) -> str:
    """Return the word for a motion (5,); one that turns the carriage and moves it counts as
    turning.
    """
    size = np.abs(way) * np.array([0.5, 0.5, 1.0, 1.0, 1.0])
    return MOTIONS[int(np.argmax(size))]


def equilibrium(
    springs: Springs, wrench: np.ndarray, start: np.ndarray | None = None, thorough: bool = True
) -> RollerForces:
    """Return the forces of the rollers under a wrench.

    Parameters
    ----------
    springs : Springs
        The rollers.
    wrench : numpy.ndarray, shape (5,)
        Forces along y and z [N], and moments about x, y and z over `springs.length` [N].
    start : numpy.ndarray, shape (5,), optional
        Displacement of a similar equilibrium.
    thorough : bool
        Whether other sets of carrying rollers are tried where removing those that lift leads to no
        equilibrium.

    Returns
    -------
    RollerForces
        With `converged` False where no state that fulfils all conditions was found.

    Raises
    ------
    Moves
        If no forces of the rollers balance the wrench.
    """
    size = _size(springs, wrench)
    _check_balance(springs, springs.locating, wrench)
    visited = [springs.locating]
    radial = np.full(springs.locating.shape, size / springs.locating.size)
    moves: Moves | None = None
    while True:
        state = _settled(springs, visited[-1], wrench, size, radial, start)
        if fulfils(springs, wrench, state):
            return state
        carries = springs.locating & state.loaded
        if any((carries == other).all() for other in visited):
            break
        try:
            _check_balance(springs, carries, wrench)
        except Moves as error:
            moves = error
            break
        visited.append(carries)
        radial = np.maximum(state.radial, 1e-6 * size)
    other = None
    if thorough:
        other = _searched(springs, wrench, size, state.start, visited)
    if other is not None:
        return other
    if moves is not None:
        raise moves
    return replace(state, converged=False)


def fulfils(springs: Springs, wrench: np.ndarray, state: RollerForces) -> bool:
    """Return whether a state is an equilibrium of the rollers.

    Notes
    -----
    Forces and moments balance the wrench, no roller pulls on its rail, a roller without radial
    force carries no axial force, and each force is that of its springs at the displacement.
    """
    size = _size(springs, wrench)
    residual = wrench - springs.radial.T @ state.radial - springs.axial.T @ state.axial
    radial, _ = springs.force(springs.offset + springs.radial @ state.start)
    carries = springs.locating & state.loaded
    stiffness = springs.axial_stiffness(np.maximum(state.radial, UNLOADED))
    axial = np.where(carries, stiffness * (springs.axial @ state.start), 0.0)
    largest = max(size, float(radial.max()), float(np.abs(axial).max()))
    return bool(
        state.converged
        and (state.radial >= 0).all()
        and not state.axial[~carries].any()
        and np.abs(residual).max() <= BALANCED * largest
        and np.abs(state.radial - radial).max() <= SETTLED * largest
        and np.abs(state.axial - axial).max() <= SETTLED * largest
    )


def _searched(
    springs: Springs,
    wrench: np.ndarray,
    size: float,
    displacement: np.ndarray,
    visited: list[np.ndarray],
) -> RollerForces | None:
    """Return an equilibrium among the other sets of rollers, None if none is found.

    Parameters
    ----------
    springs, wrench, size
        The problem, and the size of its forces.
    displacement : numpy.ndarray, shape (5,)
        Displacement at which the search begins.
    visited : list of numpy.ndarray of bool
        Sets of carrying rollers without an equilibrium, (n,) each.
    """
    if not springs.contact.any() and len(springs.radial) <= MOST_SPRINGS:
        return _enumerated(springs, wrench, size, displacement)
    for carries in _other_sets(springs, visited):
        if not _can_balance(springs, carries, wrench):
            continue
        state = _from_start(
            springs, carries, wrench, size, _stiff_place(springs, carries, wrench, size)
        )
        if fulfils(springs, wrench, state):
            return state
    return None


def _enumerated(
    springs: Springs, wrench: np.ndarray, size: float, displacement: np.ndarray
) -> RollerForces | None:
    """Return the equilibrium of linear springs, of all sets of loaded rollers that with most of
    them.
    """
    n = len(springs.radial)
    sets = ((np.arange(2**n)[:, None] >> np.arange(n)) & 1).astype(bool)
    stiffness = 1.0 / springs.radial_compliance
    of_axial = np.where(springs.locating, 1.0 / springs.axial_compliance, 0.0)
    shares = [
        np.einsum("ni,nj->nij", rows, rows) * own[:, None, None]
        for rows, own in ((springs.radial, stiffness), (springs.axial, of_axial))
    ]
    curve = np.tensordot(sets, shares[0] + shares[1], 1)
    approach = springs.offset + springs.radial @ displacement
    residuals = wrench - (sets * (stiffness * approach)) @ springs.radial
    residuals -= (sets * (of_axial * (springs.axial @ displacement))) @ springs.axial
    # where a set leaves the carriage free, it moves as little as possible
    damping = 1e-14 * np.trace(curve[-1])
    step = np.linalg.solve(curve + damping * np.eye(len(wrench)), residuals[:, :, None])[:, :, 0]
    forces = stiffness * (approach + step @ springs.radial.T)
    good = (np.where(sets, forces, -forces) >= -TOUCHES * size).all(axis=1)
    for i in np.flatnonzero(good)[np.argsort(-sets[good].sum(axis=1), kind="stable")]:
        state = _state(
            springs, sets[i] & springs.locating, wrench, size, displacement + step[i], True
        )
        if fulfils(springs, wrench, state):
            return state
    return None


def _other_sets(springs: Springs, visited: list[np.ndarray]) -> list[np.ndarray]:
    """Return at most `MOST_SETS` sets of carrying rollers, those first that differ least from the
    visited ones.
    """
    places = np.flatnonzero(springs.locating)
    sets = []
    for removed in range(len(places) + 1):
        for lifted in itertools.combinations(places, removed):
            carries = springs.locating.copy()
            carries[list(lifted)] = False
            sets.append(carries)
            if len(sets) == 16 * MOST_SETS:
                break
    known = np.array(visited)
    changes = [int((known ^ carries).sum(axis=1).min()) for carries in sets]
    return [sets[i] for i in np.argsort(changes, kind="stable")[:MOST_SETS]]


def _stiff_place(
    springs: Springs, carries: np.ndarray, wrench: np.ndarray, size: float
) -> np.ndarray:
    """Return the displacement (5,) if some rollers carry axial load with the stiffness under an
    equal radial load.
    """
    stiffness = np.where(
        carries, springs.axial_stiffness(np.full(carries.shape, size / carries.size)), 0.0
    )
    return _minimum(springs, stiffness, wrench, np.zeros(len(wrench)), size)


def _from_start(
    springs: Springs, carries: np.ndarray, wrench: np.ndarray, size: float, displacement: np.ndarray
) -> RollerForces:
    """Return the state that Powell's hybrid method reaches from a displacement.

    A contact has no axial stiffness without load, so that a locating roller with contacts may
    always count as carrying.
    """
    carries = carries | (springs.locating & (springs.contact > 0))
    at = _coupled_forces(springs, carries, wrench, UNLOADED)
    scale = max(float(np.abs(displacement).max()), 1e-12)
    zero = root(
        lambda own: at(scale * own)[0] / size,
        displacement / scale,
        jac=lambda own: at(scale * own)[1] * (scale / size),
        options={"xtol": 1e-14},
    )
    return _state(springs, carries, wrench, size, scale * zero.x, True)


def _size(springs: Springs, wrench: np.ndarray) -> float:
    """Return the size of the forces [N], to which tolerances refer."""
    return max(float(np.abs(wrench).max()), float(springs.force(springs.offset)[0].max()), 1e-9)


def _can_balance(springs: Springs, carries: np.ndarray, wrench: np.ndarray) -> bool:
    """Return whether forces of rollers that only press can balance a wrench."""
    try:
        _check_balance(springs, carries, wrench)
    except Moves:
        return False
    return True


def _check_balance(springs: Springs, carries: np.ndarray, wrench: np.ndarray) -> None:
    """Raise `Moves` if forces of the rollers that only press cannot balance a wrench."""
    axial = springs.axial[carries]
    columns = np.vstack([springs.radial, axial, -axial]).T
    forces, residual = nnls(columns, wrench)
    if residual > _INFEASIBLE * max(1e-30, float(np.abs(wrench).max())):
        raise Moves(motion_of(springs.basis @ (wrench - columns @ forces)))


def _settled(
    springs: Springs,
    carries: np.ndarray,
    wrench: np.ndarray,
    size: float,
    radial: np.ndarray,
    start: np.ndarray | None,
) -> RollerForces:
    """Return the equilibrium with the axial stiffness that belongs to its radial forces."""
    least = 1e-6 * size
    stiffness = np.where(carries, springs.axial_stiffness(np.maximum(radial, least)), 0.0)
    if start is None:
        start = _minimum(
            springs.linear_at(size / radial.size), stiffness, wrench, np.zeros(len(wrench)), size
        )
    displacement = start
    converged = not (carries.any() and springs.contact.any())
    for turn in range(MOST_PASSES):
        displacement = _minimum(springs, stiffness, wrench, displacement, size)
        if converged or turn not in NEWTON:
            coupled = None
        else:
            coupled = _coupled(springs, carries, wrench, displacement, size)
        if coupled is not None:
            displacement = coupled
            converged = True
            break
        new, _ = springs.force(springs.offset + springs.radial @ displacement)
        change = np.abs(new - radial).max()
        if turn < 12:
            radial = new
        else:
            radial = (new + radial) / 2
        stiffness = np.where(carries, springs.axial_stiffness(np.maximum(radial, least)), 0.0)
        converged = converged or bool(change <= 1e-9 * size)
        if converged:
            break
    approach = springs.offset + springs.radial @ displacement
    radial, _ = springs.force(approach)
    radial[radial < 1e-12 * size] = 0.0
    axial = np.where(carries, springs.axial_stiffness(np.maximum(radial, least)), 0.0) * (
        springs.axial @ displacement
    )
    return RollerForces(
        *_balanced(springs, carries, wrench, radial, axial), approach, displacement, converged
    )


def _state(
    springs: Springs,
    carries: np.ndarray,
    wrench: np.ndarray,
    size: float,
    displacement: np.ndarray,
    converged: bool,
) -> RollerForces:
    """Return the forces at a displacement, of which a roller that only touches its rail has
    none.
    """
    approach = springs.offset + springs.radial @ displacement
    radial, _ = springs.force(approach)
    radial = np.where((radial < TOUCHES * size) & (springs.contact == 0), 0.0, radial)
    own = carries & (radial > 0)
    stiffness = springs.axial_stiffness(np.maximum(radial, UNLOADED))
    axial = np.where(own, stiffness * (springs.axial @ displacement), 0.0)
    return RollerForces(
        *_balanced(springs, own, wrench, radial, axial), approach, displacement, converged
    )


def _coupled_forces(
    springs: Springs, carries: np.ndarray, wrench: np.ndarray, least: float
) -> Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]:
    """Return the function that gives what the forces at a displacement (5,) leave of the wrench,
    and its derivative.

    The axial stiffness is that under the radial forces, of which those below `least` [N] count as
    `least`.
    """

    def at(displacement: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        force, radial_stiffness = springs.force(springs.offset + springs.radial @ displacement)
        pressed = np.maximum(force, least)
        slide = springs.axial @ displacement
        stiffness = np.where(carries, springs.axial_stiffness(pressed), 0.0)
        slope = np.where(
            carries & (force > least), springs.axial_slope(pressed) * radial_stiffness, 0.0
        )
        residual = springs.radial.T @ force + springs.axial.T @ (stiffness * slide) - wrench
        curve = (springs.radial.T * radial_stiffness) @ springs.radial + (
            springs.axial.T * stiffness
        ) @ springs.axial
        return residual, curve + (springs.axial.T * (slope * slide)) @ springs.radial

    return at


def _coupled(
    springs: Springs, carries: np.ndarray, wrench: np.ndarray, displacement: np.ndarray, size: float
) -> np.ndarray | None:
    """Return the displacement (5,) at which forces and axial stiffness belong together, by Newton's
    method.

    None if the method does not come closer from `displacement`.
    """
    at = _coupled_forces(springs, carries, wrench, 1e-6 * size)
    residual, curve = at(displacement)
    norm = float(np.abs(residual).max())
    for _ in range(MOST_STEPS):
        if norm <= 1e-11 * size:
            return displacement
        try:
            step = np.linalg.solve(curve, -residual)
        except np.linalg.LinAlgError:
            return None
        for share in (1.0, 0.5, 0.25, 0.125):
            residual, curve = at(displacement + share * step)
            new = float(np.abs(residual).max())
            if new < (1 - 0.1 * share) * norm:
                break
        else:
            if norm <= 1e-9 * size:  # rounding ends the decrease
                return displacement
            return None
        displacement = displacement + share * step
        norm = new
    return None


def _minimum(
    springs: Springs,
    axial_stiffness: np.ndarray,
    wrench: np.ndarray,
    displacement: np.ndarray,
    size: float,
) -> np.ndarray:
    """Return the displacement (5,) of least potential energy, by a damped Newton method."""
    of_axial = (springs.axial.T * axial_stiffness) @ springs.axial

    def at(displacement: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
        approach = springs.offset + springs.radial @ displacement
        force, stiffness = springs.force(approach)
        energy = (
            springs.energy(approach, force)
            + 0.5 * displacement @ of_axial @ displacement
            - wrench @ displacement
        )
        slope = springs.radial.T @ force + of_axial @ displacement - wrench
        return energy, slope, (springs.radial.T * stiffness) @ springs.radial + of_axial

    energy, slope, curve = at(displacement)
    damping = 1e-12
    for _ in range(400):
        if np.abs(slope).max() <= 1e-12 * size or damping > 1e4:
            break
        scale = max(float(np.trace(curve)), 1e-6 * size)
        step = np.linalg.solve(curve + damping * scale * np.eye(len(slope)), -slope)
        new = at(displacement + step)
        better = new[0] <= energy + 1e-4 * float(slope @ step)
        flat = np.abs(new[1]).max() < 0.5 * np.abs(slope).max() and new[0] <= energy + 1e-12 * abs(
            energy
        )
        if not flat and abs(float(slope @ step)) <= 1e-15 * abs(energy):
            break
        if better or flat:  # close to the minimum, rounding hides the decrease of the energy
            displacement = displacement + step
            energy, slope, curve = new
            damping = max(damping / 30, 1e-14)
        else:
            damping *= 10
    return displacement


def _balanced(
    springs: Springs, carries: np.ndarray, wrench: np.ndarray, radial: np.ndarray, axial: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the forces after the least change that makes their sums exact; determinate forces
    become exact by it.
    """
    loaded = radial > 0
    rows = np.vstack([springs.radial[loaded], springs.axial[carries]])
    for _ in range(2):
        residual = wrench - springs.radial.T @ radial - springs.axial.T @ axial
        if rows.size:
            change = np.linalg.lstsq(rows.T, residual, rcond=1e-12)[0]
        else:
            change = np.zeros(0)
        radial = radial.copy()
        axial = axial.copy()
        radial[loaded] += change[: loaded.sum()]
        axial[carries] += change[loaded.sum() :]
    return np.maximum(radial, 0.0), axial


def is_determinate(springs: Springs, state: RollerForces) -> bool:
    """Return whether the sums of forces and moments give all forces of the rollers, whatever their
    stiffness is.
    """
    rows = np.vstack([springs.radial[state.loaded], springs.axial[springs.locating & state.loaded]])
    return rows.size == 0 or np.linalg.matrix_rank(rows, tol=1e-9) == len(rows)


def multipliers(springs: Springs, fixed: np.ndarray, varying: np.ndarray) -> tuple[float, float]:
    """Return the multipliers of a part of the loads at which the first roller lifts, and at which
    the carriage tips.

    Parameters
    ----------
    springs : Springs
        The rollers.
    fixed, varying : numpy.ndarray, shape (5,)
        Wrench that stays, and wrench that is multiplied; see `equilibrium`.

    Returns
    -------
    tuple of float
        Multipliers [1]; inf if it does not happen up to `LARGEST_MULTIPLIER`. Rollers count that
        carry load at the multiplier 1 or by their preload; one that has lifted at 1 gives a
        multiplier below 1. Loads for which no equilibrium with all of these rollers is found count
        as lifting one. Both are NaN without an equilibrium at 1.
    """
    given = equilibrium(springs, fixed + varying)
    if not given.converged:
        return np.nan, np.nan
    watched = given.loaded | (springs.offset > 0)
    searched = not _holds(springs, fixed + varying, thorough=False)

    def lowest(multiplier: float) -> float:
        """Return the smallest approach of the rollers that carry load; below 0 where they do not
        carry all loads.
        """
        try:
            state = equilibrium(springs, fixed + multiplier * varying, given.start, searched)
        except Moves:
            return -springs.length
        smallest = float(state.approach[watched].min())
        if state.converged:
            return smallest
        return min(smallest, -1e-12 * springs.length)

    tipping = _tipping(
        springs, fixed, varying, lambda multiplier: _holds(springs, fixed + multiplier * varying)
    )
    if not watched.any() or not np.any(varying):
        return np.inf, tipping
    if given.approach[watched].min() <= 0:
        return (float(brentq(lowest, 0.0, 1.0, xtol=1e-9)) if lowest(0.0) > 0 else 0.0), tipping
    last = min(tipping * (1 - 1e-9), LARGEST_MULTIPLIER)
    if last <= 1 or lowest(last) > 0:
        return tipping, tipping
    return float(brentq(lowest, 1.0, last, xtol=1e-9)), tipping


def to_one_contact(
    springs: Springs, fixed: np.ndarray, varying: np.ndarray, tangent: np.ndarray, lift_off: float
) -> float:
    """Return the multiplier of a part of the loads at which the first contact of a roller lifts,
    without friction.

    Parameters
    ----------
    springs : Springs
        The rollers.
    fixed, varying : numpy.ndarray, shape (5,)
        Wrench that stays, and wrench that is multiplied; see `equilibrium`.
    tangent : numpy.ndarray, shape (n,)
        Tangent of the contact angle of each roller [1], NaN where it is not known.
    lift_off : float
        Multiplier at which the first roller lifts [1], the largest result.

    Notes
    -----
    The contacts of a wedge carry F_rad +- F_ax/tan(alpha): one of them lifts where the axial force
    exceeds F_rad tan(alpha).
    """
    known = springs.locating & np.isfinite(tangent)
    if np.isnan(lift_off) or not known.any() or not np.any(varying):
        return lift_off

    def spare(multiplier: float) -> float:
        """Return the smallest axial force that is left [N], of the rollers that carry load."""
        try:
            state = equilibrium(springs, fixed + multiplier * varying)
        except Moves:
            return -1.0
        if not state.converged:
            return -1.0
        loaded = known & state.loaded
        if not loaded.any():
            return -1.0
        unused = state.radial[loaded] * tangent[loaded] - np.abs(state.axial[loaded])
        return float(unused.min(initial=np.inf))

    steps = np.geomspace(1.0, max(min(lift_off, LARGEST_MULTIPLIER), 1.0) * (1 - 1e-9), 25)
    if spare(1.0) <= 0:
        if spare(0.0) > 0:
            return float(brentq(spare, 0.0, 1.0, xtol=1e-9))
        return 0.0
    for low, high in itertools.pairwise(steps.tolist()):
        if spare(high) <= 0:
            return float(brentq(spare, low, high, xtol=1e-9))
    return lift_off


def _holds(springs: Springs, wrench: np.ndarray, thorough: bool = True) -> bool:
    """Return whether the rollers have an equilibrium under a wrench."""
    try:
        return equilibrium(springs, wrench, thorough=thorough).converged
    except Moves:
        return False


def _tipping(
    springs: Springs, fixed: np.ndarray, varying: np.ndarray, holds: Callable[[float], bool]
) -> float:
    """Return the largest multiplier with an equilibrium, inf beyond `LARGEST_MULTIPLIER`."""
    axial = springs.axial[springs.locating]
    n = len(springs.radial)
    columns = np.vstack([springs.radial, axial]).T
    size = max(float(np.abs(fixed).max()), float(np.abs(varying).max()), 1e-30)
    most = linprog(
        np.append(np.zeros(columns.shape[1]), -1.0),
        A_eq=np.column_stack([columns, -varying / size]),
        b_eq=fixed / size,
        bounds=[(0, None)] * n + [(None, None)] * len(axial) + [(0, LARGEST_MULTIPLIER)],
    )
    bound = 1.0
    if most.success:
        bound = float(most.x[-1])
    if holds(bound * (1 - 1e-7)):
        if bound >= LARGEST_MULTIPLIER * (1 - 1e-9):
            return np.inf
        return bound
    low, high = 1.0, max(bound, 1.0)
    while high > low * (1 + 1e-6):
        middle = np.sqrt(low * high)
        if holds(middle):
            low = middle
        else:
            high = middle
    return low
