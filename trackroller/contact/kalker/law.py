"""The exact theory for the equilibrium, which solves the same patches many times with small changes of creepage."""

from __future__ import annotations

import dataclasses

import numpy as np

from trackroller.contact import table
from trackroller.contact.grid_patch import GridPatch
from trackroller.contact.kalker.patch import solve_patch
from trackroller.contact.kalker.problem import KalkerSettings, PatchSolution, joined
from trackroller.contact.quantities import Elastic, Ellipse, Resultants
from trackroller.contact.slip import Creepage, Slip

NEAR = 0.3  # largest change of creepage, over the slip in the patch, for which the last solution is a good start
# Under a friction law that falls too steeply, a patch has several solutions or none, and the equilibrium cannot be met.
# After MISSES solutions without convergence, the later solutions of the patch stop after SHORT_STEPS steps. The
# residual is always reported.
MISSES, SHORT_STEPS = 3, 4


class KalkerLaw:
    """Exact theory that starts each patch from the patch's last solution.

    Parameters
    ----------
    elastic : Elastic
        Combined constants of n rollers, arrays (n,).
    settings : KalkerSettings, optional
        Discretisation of the fine solution. The rough solution is read from the table of exact solutions. Outside the
        range of the table it is computed with half the elements and without extrapolation.
    travel_speed : array_like, shape (n,), optional
        Travel speed of each roller [mm/s]; default: that of `settings`.

    Notes
    -----
    A negative sine of the contact angle marks contact 2 of a roller. A patch starts from its own earlier solutions
    only, so the result of a case does not depend on the other cases.
    """

    def __init__(self, elastic: Elastic, settings: KalkerSettings | None = None, travel_speed=None) -> None:
        self.elastic, self.settings = elastic, settings or KalkerSettings()
        self.travel = None if travel_speed is None else np.asarray(travel_speed, float)
        self._starts: dict[tuple[int, int, bool], tuple[np.ndarray, float]] = {}  # tractions and creepage
        n = np.size(elastic.shear_modulus)
        # of the last fine solution of both patches of each roller; the misses count those that did not converge
        self._residual, self._converged = np.zeros((n, 2)), np.ones((n, 2), bool)
        self._error, self._misses = np.full((n, 2), np.nan), np.zeros((n, 2), int)
        self._kept: tuple[dict[bytes, int], PatchSolution] | None = None

    def __call__(
        self, patch: Ellipse | GridPatch, slip: Slip, friction, rows: np.ndarray, fine: bool = True
    ) -> Resultants:
        """Return the resultants on the roller, (n,); if not `fine`, from the table or from half the elements."""
        if fine or not patch.is_hertzian or not self._in_table:
            return self.solve(patch, slip, friction, rows, fine).resultants
        creep = Creepage.of_slip(slip, self.settings.profile_slip)
        looked_up = table.solve_patch(patch, creep.longitudinal, creep.spin, friction, self.elastic.take(rows))
        rest = np.flatnonzero(~looked_up.known)
        if not rest.size:
            return looked_up.resultants
        other = self.solve(patch.take(rest), slip.take(rest), friction[rest], rows[rest], False).resultants
        return looked_up.resultants.replaced(rest, other)

    @property
    def _in_table(self) -> bool:
        """Return whether the table may hold the patches: constant friction, slip of the tangent, and no film."""
        plain = self.settings.law_in_use.is_constant and not self.settings.profile_slip
        return plain and not np.any(self.elastic.film)

    def solve(
        self, patch: Ellipse | GridPatch, slip: Slip, friction, rows: np.ndarray, fine: bool = True
    ) -> PatchSolution:
        """Return the solution of the patches of the rollers `rows`; see `solve_patch` for the units."""
        settings = self.settings
        if not fine:
            settings = dataclasses.replace(settings, elements=settings.elements // 2, extrapolate=False)
        side = (slip.sine < 0).astype(int)
        keys = [(*key, fine) for key in zip(rows.tolist(), side.tolist(), strict=True)]
        creep = Creepage.of_slip(slip, self.settings.profile_slip)
        friction = np.broadcast_to(np.asarray(friction, float), len(rows))
        known = self._near(keys, creep, patch)
        tired = self._misses[rows, side] >= MISSES
        picks, parts = [], []
        for started, cut in ((True, False), (True, True), (False, True), (False, False)):
            pick = np.flatnonzero((known == started) & (tired == cut))
            if not (pick.size or (not len(keys) and not started and not cut)):
                continue
            where = rows[pick]
            start = np.stack([self._starts[keys[i]][0] for i in pick]).astype(float) if started else None
            parts.append(
                solve_patch(
                    patch.take(pick),
                    creep.take(pick),
                    friction[pick],
                    self.elastic.take(where),
                    dataclasses.replace(settings, steps=SHORT_STEPS) if cut else settings,
                    start,
                    None if self.travel is None else self.travel[where],
                )
            )
            picks.append(pick)
        solution = parts[0] if len(parts) == 1 else joined(parts, np.argsort(np.concatenate(picks)))
        kept = zip(solution.traction.astype(np.float32), creep.longitudinal, strict=True)
        self._starts.update(zip(keys, kept, strict=True))
        if fine and settings.extrapolate:
            with np.errstate(divide="ignore", invalid="ignore"):
                self._error[rows, side] = solution.force_error / (friction * patch.normal_force)
        np.add.at(self._misses, (rows, side), ~solution.converged)
        if fine:
            self._residual[rows, side], self._converged[rows, side] = solution.residual, solution.converged
        return solution

    def _near(self, keys, creep: Creepage, patch: Ellipse | GridPatch) -> np.ndarray:
        """Return True where the last solution has nearly the same creepage; otherwise half the elements are closer."""
        last = np.array([self._starts[key][1] if key in self._starts else np.inf for key in keys], float)
        size = np.sqrt(patch.semi_axis_lateral * patch.semi_axis_rolling)
        with np.errstate(invalid="ignore"):
            return np.abs(creep.longitudinal - last) <= NEAR * (np.abs(creep.longitudinal) + np.abs(creep.spin) * size)

    def state(self, n: int) -> tuple[np.ndarray, np.ndarray]:
        """Return the larger residual of both patches at the last fine solution, and if both converged, (n,)."""
        return self._residual.max(axis=1), np.logical_and.reduce(self._converged, axis=1)

    def error(self, n: int) -> np.ndarray:
        """Return the estimated error of the friction forces over mu F_N, (n, 2)."""
        return self._error.copy()

    def kept(self, patch: Ellipse | GridPatch, slip: Slip, friction, rows: np.ndarray) -> PatchSolution:
        """Return the solution as `solve` does; reuse that of the last call of `kept` for the same patches."""
        content = np.stack(
            [
                rows,
                slip.sine,
                slip.shift,
                patch.semi_axis_lateral,
                patch.max_pressure,
                np.broadcast_to(friction, len(rows)),
            ],
            axis=1,
        )
        keys = [row.tobytes() for row in content]
        if self._kept is None or not all(key in self._kept[0] for key in keys):
            self._kept = {key: i for i, key in enumerate(keys)}, self.solve(patch, slip, friction, rows)
        places, solution = self._kept
        return solution.take(np.array([places[key] for key in keys], int))
