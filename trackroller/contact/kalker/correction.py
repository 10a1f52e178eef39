"""A cheap contact law that is corrected by a few solutions of the exact theory.

The table of the exact theory gives the forces of a patch at any slip. The patch is solved on
elements at the slip where the roller balances, and the difference between both forces is added to
the table's forces. The corrected law is exact at the solved slip and has the table's derivatives.
One or two solutions of a patch are therefore enough for the equilibrium (deferred correction). From
two solutions of a patch on, the difference varies linearly with the slip.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from trackroller.contact import table
from trackroller.contact.kalker import extrapolation
from trackroller.contact.kalker.patch import on_elements, solve_patch
from trackroller.contact.kalker.problem import KalkerSettings, PatchSolution, Store
from trackroller.contact.quantities import Elastic, Ellipse, Resultants, Works, force_scales
from trackroller.contact.rollers import converged_up_to
from trackroller.contact.slip import Creepage, Slip
from trackroller.contact.wedge import determinant
from trackroller.numerics.knots import rise

# if the normalised slip changed less than this, the iteration starts from the patch's last solution
NEAR = 0.02
# least change of the normalised slip from which a derivative of the difference is taken
LEAST_STEP = 1e-9
STEEPEST = 3.0  # largest such derivative
REACH = 2.0  # steps over which the derivative is trusted
# Outside its range the table has the derivatives of the end of its range, so that one correction
# removes less of the error. A change of the forces is therefore multiplied by this factor there.
OUTSIDE = 20.0
# Largest residual of the friction law over mu p_max for solutions that give the tractions only, and
# for solutions on twice the elements. A smaller residual changes the forces of twice the elements
# by less than 1e-5 of mu F_N.
TRACTION_TOLERANCE = 1e-3
# Estimated error of the friction forces above which a patch is solved again on twice the elements.
# The error is divided by mu F_N. The change of F_N that it causes in the other contact, divided by
# that F_N, must not exceed it either. The limit holds for `extrapolation.FITTED_AT` elements.
REFINED_ERROR = 4e-3
# Estimated relative error of F_N in the other contact above which a patch is solved on three times
# the elements, too. Only contacts near lift-off have such an error. At 0.08, F_N of contacts with 1
# % of the load would err by 3 %.
LIGHT_ERROR, LIGHT_FACTOR = 5e-2, 3
# Relative error of F_N in the other contact that the error of the table may cause. From the first
# value on the elements take over by and by, so that the forces have no step. Beyond the second
# value they serve alone, which keeps the estimated error of the friction forces below 5 % of mu
# F_N.
TABLE_SERVES = 0.037, 0.047
# Elements across patches that serve for the table. A patch takes the first number that promises the
# error of F_N.
SERVING, SERVED_ERROR = (20, 28, 40, 56, 80), 0.04


def refined_above(elements: int) -> float:
    """Return `REFINED_ERROR` for patches of `elements` along each axis."""
    return REFINED_ERROR * extrapolation.error_scale(elements)


class Correction:
    """The corrected law of n rollers and the solutions behind it.

    Parameters
    ----------
    elastic : Elastic
        Combined constants of the rollers, arrays (n,).
    settings : KalkerSettings
        Discretisation of the elements; the friction law must be constant.
    trusts_table : bool
        True: inside the table's range the forces are corrected only where `TABLE_SERVES` asks for
        it. Elsewhere the elements give the tractions only.
    """

    difference_step = 1e-5  # relative step of derivatives of the corrected law
    residual = 1e-10  # relative residual of the equilibrium that the corrected law can reach
    traction_tolerance = TRACTION_TOLERANCE

    def __init__(
        self, elastic: Elastic, settings: KalkerSettings, trusts_table: bool = False
    ) -> None:
        n = np.size(elastic.shear_modulus)
        self.elastic, self.settings, self.trusts_table = elastic, settings, trusts_table
        # over mu F_N, mu F_N and mu F_N c
        self.offset, self.slope = np.zeros((n, 2, 3)), np.zeros((n, 2, 3))
        self.limit = np.zeros((n, 2, 3))  # extrapolation to small elements, in the same units
        self.place, self.reach = np.full((n, 2), np.nan), np.zeros((n, 2))
        # F_N at the last balance, and F_T/F_N by the table
        self.normal, self.ratio = np.full((2, n, 2), np.nan)
        self.error = np.full((n, 2), np.nan)  # of the friction forces over mu F_N, estimated
        self.share = np.zeros((n, 2))  # of the elements in the forces, from 0 to 1
        self.count = 0  # of solved patches
        self.store = Store(2 * n)  # solutions
        self.finer = Store(2 * n)  # solutions on twice the elements

    def _table(
        self, patch: Ellipse, slip: Slip, friction: np.ndarray, rows: np.ndarray
    ) -> tuple[np.ndarray, ...]:
        """Return the table's forces (m, 3) over mu F_N and mu F_N c, the place of the slip, and its
        validity, (m,).
        """
        elastic = self.elastic.take(rows)
        return table.nearest_forces(patch, slip.longitudinal, slip.spin, friction, elastic)

    def _corrected(
        self, forces: np.ndarray, place: np.ndarray, rows: np.ndarray, side: np.ndarray
    ) -> np.ndarray:
        reach = self.reach[rows, side]
        step = np.where(reach > 0.0, place - self.place[rows, side], 0.0)
        step = np.minimum(np.maximum(step, -reach), reach)
        return forces + self.offset[rows, side] + self.slope[rows, side] * step[:, None]

    def law(
        self, patch: Ellipse, slip: Slip, friction: np.ndarray, rows: np.ndarray, fine: bool = True
    ) -> Resultants:
        """Return the resultants on the roller by the corrected table, arrays (m,)."""
        forces, place, _ = self._table(patch, slip, friction, rows)
        forces = self._corrected(forces, place, rows, _side(slip))
        scale = force_scales(patch, friction)
        return Resultants(*(forces * scale).T)

    def solve(
        self, patch: Ellipse, slip: Slip, friction: np.ndarray, rows: np.ndarray
    ) -> np.ndarray:
        """Solve patches by elements and correct the law there.

        Returns
        -------
        Largest change of a force over mu F_N (or of M_R over mu F_N c) that the solution brought,
        (m,); `OUTSIDE` times the change outside the table's range.
        """
        change = np.zeros(len(rows))
        forces, place, held = self._table(patch, slip, friction, rows)
        self.ratio[rows, _side(slip)] = friction * forces[:, 0]
        share = np.where(held & self.trusts_table, self._share(patch, slip, friction, rows), 1.0)
        # it only grows, so that the corrections settle
        share = np.maximum(share, self.share[rows, _side(slip)])
        self.share[rows, _side(slip)], pick = share, np.flatnonzero(share > 0.0)
        if pick.size:
            own, side, part = rows[pick], _side(slip)[pick], share[pick]
            before = self._corrected(forces[pick], place[pick], own, side)
            offset = (
                self._elements(patch.take(pick), slip.take(pick), friction[pick], own, place[pick])
                - forces[pick]
            )
            if self.trusts_table:
                table_error = (1.0 - part) * table.stored().force_error("p99")
                self.error[own, side] = np.fmax(self.error[own, side], table_error)
            offset *= part[:, None]
            self._learn(offset, place[pick], own, side)
            change[pick] = np.max(np.abs(forces[pick] + offset - before), axis=1)
        return np.where(held, change, OUTSIDE * change)

    def _share(
        self, patch: Ellipse, slip: Slip, friction: np.ndarray, rows: np.ndarray
    ) -> np.ndarray:
        """Return the share of the elements in the forces of patches inside the table, (m,), see
        `TABLE_SERVES`.
        """
        unloading = self._unloading_shear(patch, slip, rows)
        with np.errstate(divide="ignore", invalid="ignore"):
            error = table.stored().force_error("p99") * friction * patch.normal_force / unloading
        return rise(np.nan_to_num(error), TABLE_SERVES)

    def _unloading_shear(self, patch: Ellipse, slip: Slip, rows: np.ndarray) -> np.ndarray:
        """Return the change of F_T in patches that changes F_N of the other contact by all of it,
        (m,) [N].

        The normal forces of the patches are kept, because the other contact asks for them.
        """
        side = _side(slip)
        other_side = 1 - side
        self.normal[rows, side] = patch.normal_force
        other_load = self.normal[rows, other_side]
        is_alone = np.isnan(other_load)  # of two mirror images only one is given
        own_ratio = self.ratio[rows, side]
        other_ratio = np.where(is_alone, -own_ratio, self.ratio[rows, other_side])
        other_load = np.where(is_alone, patch.normal_force, other_load)
        sign = np.sign(slip.sine)
        per_load = determinant(np.abs(slip.sine), slip.cosine, sign * own_ratio, sign * other_ratio)
        return np.abs(per_load) * other_load

    def _learn(
        self, offset: np.ndarray, place: np.ndarray, rows: np.ndarray, side: np.ndarray
    ) -> None:
        """Store the differences `offset` (m, 3) at the places of the slip, and their derivatives if
        known.
        """
        change = place - self.place[rows, side]
        known = np.abs(change) > LEAST_STEP
        slope = (offset - self.offset[rows, side]) / np.where(known, change, 1.0)[:, None]
        self.slope[rows, side] = np.where(known[:, None], np.clip(slope, -STEEPEST, STEEPEST), 0.0)
        self.reach[rows, side] = np.where(known, REACH * np.abs(change), 0.0)
        self.offset[rows, side], self.place[rows, side] = offset, place

    def _elements(
        self, patch: Ellipse, slip: Slip, friction, rows: np.ndarray, place=np.nan, forces=True
    ) -> np.ndarray:
        """Return the forces (m, 3) of the elements over mu F_N and mu F_N c; keep the solutions.

        Without `forces` only the tractions are needed, so that nothing is extrapolated.
        """
        side, scale = _side(slip), force_scales(patch, friction)
        near = np.abs(place - self.place[rows, side]) <= NEAR
        exact = np.empty((len(rows), 3))
        self.count += len(rows)
        for started in (False, True):
            pick = np.flatnonzero(near == started)
            if not pick.size:
                continue
            own, slot = rows[pick], 2 * rows[pick] + side[pick]
            tolerance = converged_up_to("kalker", "hertz") if forces else self.traction_tolerance
            wanted = {
                "extrapolate": forces and not started,
                "between": forces,
                "tolerance": tolerance,
            }
            settings = dataclasses.replace(self.settings, **wanted)
            before = self.store.get(slot) if started else None
            start = None if before is None else before.traction
            creep = Creepage.of_slip(slip.take(pick), settings.profile_slip)
            solution = solve_patch(
                patch.take(pick), creep, friction[pick], self.elastic.take(own), settings, start
            )
            plain, value = (
                solution.resultants.columns - solution.limit[:, :3],
                solution.resultants.columns,
            )
            if before is not None:
                solution = solution.extrapolated_as(before)
            else:
                if forces:
                    value, force_error = self._refined(
                        patch.take(pick), slip.take(pick), friction[pick], own, solution
                    )
                    self.error[own, side[pick]] = force_error / scale[pick, 0]
                self.limit[own, side[pick]] = (value - plain) / scale[pick]
            exact[pick] = plain / scale[pick] + self.limit[own, side[pick]]
            self.store.put(slot, solution)
        return exact

    def _refined(
        self, patch: Ellipse, slip: Slip, friction, rows: np.ndarray, solution: PatchSolution
    ):
        """Return the forces (m, 3) [N, N, N mm] of patches and their estimated error (m,) [N].

        They are those of the solutions `solution`, or of two or three times the elements where the
        error counts. In the balance an error of F_T in one contact changes F_N of the other, see
        `stages.mechanics.force_error`.
        """
        value, force_error = solution.resultants.columns, solution.force_error.copy()
        other = self._unloading_shear(patch, slip, rows)
        creep = Creepage.of_slip(slip, self.settings.profile_slip)

        def solve_again(pick: np.ndarray, elements: int, start: np.ndarray | None = None) -> None:
            settings = dataclasses.replace(
                self.settings, elements=elements, tolerance=self.traction_tolerance
            )
            elastic = self.elastic.take(rows[pick])
            best = solve_patch(
                patch.take(pick), creep.take(pick), friction[pick], elastic, settings, start
            )
            self.count, good = self.count + pick.size, best.converged
            value[pick[good]], force_error[pick[good]] = (
                best.resultants.columns[good],
                best.force_error[good],
            )

        if self.trusts_table:
            wanted = extrapolation.elements_for(
                force_error / (SERVED_ERROR * other), self.settings.elements
            )
            enough = np.searchsorted(SERVING, np.minimum(wanted, SERVING[-1]))
            for number in range(1, len(SERVING)):
                if (enough == number).any():
                    solve_again(np.flatnonzero(enough == number), SERVING[number])
            return value, force_error
        # an error of F_T counts over mu F_N, and as the change of F_N that it causes in the other
        # contact
        limit = refined_above(self.settings.elements) * np.minimum(
            friction * patch.normal_force, other
        )
        rough = np.flatnonzero(force_error > limit)
        if not rough.size:
            return value, force_error
        part, mu, elastic = patch.take(rough), friction[rough], self.elastic.take(rows[rough])
        coarse = solution.take(rough)
        finer = self.on_finer(part, slip.take(rough), mu, rows[rough], coarse, forces=True)
        self.count, good = self.count + rough.size, finer.converged
        twice, change = extrapolation.doubled(part, creep.take(rough), mu, elastic, finer, coarse)
        error = extrapolation.force_error(
            part, mu, finer.stick_fraction, change, finer.traction.shape[-1]
        )
        value[rough[good]], force_error[rough[good]] = twice[good], error[good]
        light = np.flatnonzero(force_error[rough] > LIGHT_ERROR * other[rough])
        if light.size:
            start = on_elements(
                part.take(light), finer.take(light), LIGHT_FACTOR * self.settings.elements
            )
            solve_again(rough[light], start.shape[-1], start)
        return value, force_error

    def on_finer(
        self,
        patch: Ellipse,
        slip: Slip,
        friction,
        rows: np.ndarray,
        coarse: PatchSolution,
        forces: bool = False,
    ) -> PatchSolution:
        """Solve patches on twice the elements of the solutions `coarse`, arrays (m,), from the
        tractions at hand.
        """
        slot, creep = 2 * rows + _side(slip), Creepage.of_slip(slip, self.settings.profile_slip)
        elements = 2 * coarse.traction.shape[-1]
        known = self.finer.known[slot]
        start = np.empty((len(rows), 2, elements, elements))
        if known.any():
            start[known] = self.finer.get(slot[known]).traction
        if not known.all():
            start[~known] = on_elements(patch.take(~known), coarse.take(~known), elements)
        wanted = {
            "elements": elements,
            "tolerance": self.traction_tolerance,
            "extrapolate": False,
            "between": forces,
        }
        elastic, settings = self.elastic.take(rows), dataclasses.replace(self.settings, **wanted)
        solution = solve_patch(patch, creep, friction, elastic, settings, start)
        if forces:
            self.finer.put(slot, solution)
        return solution

    def solution(
        self, patch: Ellipse, slip: Slip, friction: np.ndarray, rows: np.ndarray
    ) -> PatchSolution:
        """Return the last solutions of patches, arrays (m,); patches without one are solved."""
        slot = 2 * rows + _side(slip)
        if not slot.size:
            return solve_patch(
                patch, Creepage.of_slip(slip), friction, self.elastic.take(rows), self.settings
            )
        missing = np.flatnonzero(~self.store.known[slot])
        if missing.size:
            given = patch.take(missing), slip.take(missing), friction[missing], rows[missing]
            self._elements(*given, forces=not self.trusts_table)
        return self.store.get(slot)

    def works(self, patch: Ellipse, slip: Slip, friction: np.ndarray, rows: np.ndarray) -> Works:
        """Return the dissipation and the work of the pressures at the given slip, arrays (m,)."""
        solution = self.solution(patch, slip, friction, rows)
        if self.settings.profile_slip:
            return solution.works
        r = self.law(patch, slip, friction, rows)
        work = (
            solution.pressure_work - slip.longitudinal * r.driving_force - slip.spin * r.spin_moment
        )
        lost = (
            0.0 if self.trusts_table else self.share[rows, _side(slip)] * solution.energy_residual
        )
        return Works(work * (1.0 + lost), solution.pressure_work)

    def forget(self, rows: np.ndarray) -> None:
        """Drop the solutions of the rollers `rows`, so that their patches are solved again when
        needed.
        """
        slots = np.concatenate([2 * rows, 2 * rows + 1])
        for store in (self.store, self.finer):
            store.known[slots] = False
        self.error[rows] = np.nan

    def state(self, n: int) -> tuple[np.ndarray, np.ndarray]:
        """Return the larger residual of the friction law in both patches of n rollers, and whether
        it is met, (n,).
        """
        residual, converged = self.store.state()
        return residual.reshape(n, 2).max(axis=1), np.logical_and.reduce(
            converged.reshape(n, 2), axis=1
        )


def _side(slip: Slip) -> np.ndarray:
    return (slip.sine < 0).astype(int)
