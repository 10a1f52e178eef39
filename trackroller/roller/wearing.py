"""Follow the groove of one roller while it wears: states along the travel, which do not depend on
where one looks.

ASSUME: every place of the roller's circumference is overrolled once in 2 pi r_A of travel, and
every place of the guide `guide_overrollings_per_hour` times in the travel of an hour. A guide
without this number does not wear. ASSUME: debris and plastic flow play no part, and the wear
coefficients do not change with the travel.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from trackroller.contact.cross_sections import Gap
from trackroller.contact.drawn_profiles import gap, treats_sides_alike, with_wear
from trackroller.contact.hertz import contact_modulus
from trackroller.contact.normal.measure import Box
from trackroller.contact.normal.wearing import WearingPatch, evened_at_rims, on_cells, smoothed
from trackroller.contact.quantities import Resultants
from trackroller.damage.limit import roller_overrollings
from trackroller.damage.wear import ERROR, KM_PER_HOUR, energy_ratio, leaves_table, local_rates
from trackroller.errors import InputError
from trackroller.parameters import REGIMES
from trackroller.roller import equilibrium as eq
from trackroller.roller.case_table import CaseTable
from trackroller.roller.geometry import contact_geometry
from trackroller.roller.options import Options, model_in_use
from trackroller.roller.stages.balance import balance
from trackroller.roller.stages.mechanics import dissipation, prepare
from trackroller.roller.stages.models import bodies, finer_across
from trackroller.roller.stages.scene import StageResults, surface_tractions

REACH = 20.0  # half width of the cells over the lateral semi-axis of the new patch
TOLERANCE = 0.02  # largest error of the depth in a step over the elastic approach of the new bodies
# beyond DEEP elastic approaches, this share of the depth beyond them is allowed in addition
DEEP, SHARE = 2.0, 0.1
FIRST = 0.05  # depth of the first step over the elastic approach of the new bodies
# depth of the least step over that of the first step, or of a step that wears SHARE of the depth
LEAST = 0.02
GROWTH, SHRINK = 2.5, 0.3  # limits of the change of a step
BALANCED = 1e-6  # residual of a balance from which the groove can go on
TRIES = 3  # steps in a row, each shorter, that end without a balance or in another regime
# largest number of states, which bounds the processor time of a groove that goes on growing
STEPS = 25
ENDS = {
    "travel": "the travel asked for is reached",
    "permissible": "the permissible wear depth is reached",
    "lift_off": "a contact has lifted off",
    "full_slip": "friction can no longer transmit the motor force, so that wear per travel has no "
    "limit",
    "failed": "no balance of the forces was found",
    "steps": f"the steps became too small, or {STEPS} states were not enough",
    "wide": f"the patch has grown beyond {REACH:g} times the new one",
}


@dataclass(frozen=True)
class Groove:
    """The worn state of one roller and its guide, and where the search for its balance starts.

    Attributes
    ----------
    travel : float
        Travel since the bodies were new [km].
    depth : numpy.ndarray, shape (m, 2, cells)
        Mean depth that wear took off the cells of roller and guide, outward from the first cell
        [mm]; m is 1 if both contacts are mirror images, otherwise 2.
    closing : numpy.ndarray, shape (m,)
        How far wear let the bodies close along the contact normal [mm].
    inclined : numpy.ndarray, shape (m,)
        Angle by which the contact normal has turned outward [rad].
    error : float
        Sum of the estimated errors of the depth in all steps [mm].
    balance : numpy.ndarray, shape (3,), optional
        Rolling radius shift [mm] and normal forces [N] of a similar state.
    boxes : numpy.ndarray, shape (m, 3), optional
        Ends and half length of the boxes around the patches of that state [mm].
    """

    travel: float
    depth: np.ndarray
    closing: np.ndarray
    inclined: np.ndarray
    error: float = 0.0
    balance: np.ndarray | None = None
    boxes: np.ndarray | None = None


def between(one: Groove, two: Groove, travel: float) -> Groove:
    """Return the state at a travel [km] between two states of a march, by linear interpolation."""
    part = (travel - one.travel) / (two.travel - one.travel)
    names = "depth", "closing", "inclined", "error"
    return Groove(
        travel, *((1.0 - part) * getattr(one, name) + part * getattr(two, name) for name in names)
    )


def travel_to_depth(one: Groove, two: Groove, depth: float) -> float:
    """Return the travel [km] at which the deepest place reaches `depth` [mm] between two states;
    inf if it does not.
    """
    grown = two.depth - one.depth
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        part = np.where(two.depth >= depth, (depth - one.depth) / grown, np.inf)
    return float(one.travel + max(np.min(part, initial=np.inf), 0.0) * (two.travel - one.travel))


class Wearing:
    """One roller whose groove wears.

    Parameters
    ----------
    table : CaseTable
        The case, one row.
    options : Options
        Options of the solution, with `normal: halfspace`.

    Raises
    ------
    InputError
        For Hertzian patches, or if neither body has a wear coefficient and overrollings.
    """

    def __init__(self, table: CaseTable, options: Options) -> None:
        self.table = table
        self.options = options.changed(
            contact_model=model_in_use(
                options, str(table.friction_law[0]), float(table.layer_flexibility[0])
            )
        )
        self.alpha, self.radius, *_ = contact_geometry(vars(table))
        self.modulus = float(contact_modulus(*bodies(table))[0])
        hourly = np.array(
            [
                roller_overrollings(table.velocity, self.radius)[0],
                table.guide_overrollings_per_hour[0],
            ]
        )
        # overrollings of a place of roller and guide
        self.per_km = hourly / (KM_PER_HOUR * table.velocity[0])
        self.rates = _rates(table, options, self.per_km)
        self._law = ""
        if options.wear_law == "energy":
            self._law = str(table.loss_tables[0])
        self._texts = str(table.guide_profile[0]), str(table.roller_profile[0])
        if table.axial_force[0] == 0.0 and all(map(treats_sides_alike, self._texts)):
            self.contacts = 1
        else:
            self.contacts = 2
        self._across = int(finer_across(table, options)[0])
        none = np.zeros(self.contacts)
        self.start = Groove(0.0, np.zeros((self.contacts, 2, 2)), none, none)
        self.new = self.solve(self.start)
        self.cells = np.array([-1.0, 0.0, 1.0])
        self.scale = np.nan
        self._lean = none
        self.element_error = 0.0
        if self.end(self.new):
            return
        patch: Any = self.new.patch
        wide = float(np.min(patch.semi_axis_lateral))
        low, high = self._gap(table, 1).limits
        step = 2.0 * wide / patch.shape[1]
        self.cells = step * np.arange(
            np.floor(max(low / step, -REACH * wide / step)),
            np.ceil(min(high, REACH * wide) / step) + 1,
        )
        self.scale = float(np.mean(patch.approach))
        # of the depth
        self.element_error = ERROR.get(self.options.contact_model, np.nan) / patch.shape[1]
        self.start = replace(self.start, depth=np.zeros((self.contacts, 2, self.cells.size - 1)))
        self._lean = self._leaning(self.new, table)

    @property
    def places(self) -> np.ndarray:
        """Return the middles of the cells outward of the nominal contact, (cells,) [mm]."""
        return 0.5 * (self.cells[1:] + self.cells[:-1])

    def _moved(self, closing: np.ndarray) -> np.ndarray:
        """Return how far the roller has moved outward along the tangent planes, (m,) [mm]: it sinks
        by the closing.
        """
        tangent = np.tan(self.alpha[0])
        sides = np.broadcast_to(closing, 2)
        sunk = sides.mean() * tangent
        apart = 0.5 * (sides[1] - sides[0]) / tangent
        return np.array([sunk + apart, sunk - apart])[: self.contacts]

    def worn_table(self, state: Groove) -> CaseTable:
        """Return the case with the worn profiles of a state; the case itself if nothing was worn
        off.
        """
        if not state.depth.any():
            return self.table
        radii = (
            float(self.table.guide_profile_radius[0]),
            float(self.table.roller_profile_radius[0]),
        )
        common = {"start": float(self.places[0]), "step": float(self.places[1] - self.places[0])}
        guide = common | {"depth": state.depth[:, 1].tolist(), "inclined": state.inclined.tolist()}
        roller = common | {
            "depth": state.depth[:, 0].tolist(),
            "moved": self._moved(state.closing).tolist(),
        }
        texts = with_wear(*self._texts, radii, [guide, roller])
        guide_text, roller_text = (np.array([text], dtype=object) for text in texts)
        profiles: Any = {"guide_profile": guide_text, "roller_profile": roller_text}
        return replace(self.table, **profiles)

    def gaps(self, state: Groove) -> np.ndarray:
        """Return the gap of the worn bodies at `places` where they touch without load, (2, cells)
        [mm].
        """
        table = self.worn_table(state)
        lateral = np.array(
            [self._gap(table, k + 1).lateral(self.places) for k in range(self.contacts)]
        )
        return np.broadcast_to(lateral - lateral.min(axis=1, keepdims=True), (2, self.places.size))

    def solve(self, state: Groove) -> StageResults:
        """Return balance and patches of a state."""
        if state.balance is None or state.boxes is None:
            scene = prepare(self.worn_table(state), self.options, self._across)
            return StageResults.start(scene, balance(scene))
        nan = np.full((3, 1, 2), np.nan)
        boxes = np.broadcast_to(state.boxes, (2, 3)).tolist()
        shift = state.balance[:1]
        normal = state.balance[None, 1:]
        rolls = np.full(1, eq.ROLLING, np.int8)
        near = eq.Equilibrium(
            rolls, rolls > 0, nan[0, :, 0], rolls > 0, shift, normal, Resultants(*nan)
        )
        scene = prepare(
            self.worn_table(state), self.options, self._across, [Box(*row) for row in boxes]
        )
        return StageResults.start(scene, balance(scene, near))

    def end(self, results: StageResults) -> str:
        """Return why the groove cannot be followed beyond these results; "" if it can."""
        name = REGIMES[int(results.regime[0])]
        if name == "rolling":
            # a balance that misses its tolerance by little is told in its row, and the groove goes
            # on
            if results.converged[0] or results.values["residual"][0] <= BALANCED:
                return ""
            return "failed"
        return name

    def turned(self, state: Groove, results: StageResults) -> Groove:
        """Return a solved state with its own inclination, balance and boxes, from which the next
        state starts.
        """
        patch: Any = results.patch
        side = np.array([1.0, -1.0])[: self.contacts]
        middle = side * patch.centre[: self.contacts]
        wide = patch.semi_axis_lateral[: self.contacts]
        return replace(
            state,
            inclined=self._lean - self._leaning(results, self.worn_table(state)),
            balance=np.concatenate([results.balance.shift, results.balance.normal_force[0]]),
            boxes=np.stack(
                [middle - wide, middle + wide, patch.semi_axis_rolling[: self.contacts]], axis=1
            ),
        )

    def _gap(self, table: CaseTable, side: int) -> Gap:
        columns = table.guide_profile_radius, table.roller_profile_radius, self.alpha, self.radius
        g, r, alpha, radius = (float(column[0]) for column in columns)
        texts = str(table.guide_profile[0]), str(table.roller_profile[0])
        return gap(*texts, g, r, alpha, radius, float(table.guide_curve_radius[0]), side)

    def _patches(self, results: StageResults, table: CaseTable) -> list[WearingPatch]:
        """Return the patch of each contact with its pressure and its rates of wear; x counts
        outward in the gap.
        """
        t = surface_tractions(results)
        out = []
        energy = dissipation(results)[0][0]
        for k in range(self.contacts):
            slip = np.hypot(t.slip_lateral[k], t.slip_rolling[k])
            shear = np.hypot(t.shear_lateral[k], t.shear_rolling[k])
            cell = (t.x[k, 1] - t.x[k, 0]) * (t.y[k, 1] - t.y[k, 0])
            # constant friction: |tau| = mu p wherever surfaces slide, to more digits than an
            # iteration has
            bound = shear
            if self.table.friction_law[0] == "":
                bound = self.table.friction_coefficient[0] * t.pressure[k]
            ratio = energy_ratio(energy[k], cell * np.sum(bound * slip))
            rates = (
                ratio
                * self.rates[:, None, None]
                * local_rates(t.pressure[k], shear, slip, self._law)
            )
            outward = slice(None, None, 1 - 2 * k)  # x counts outward in a gap
            fields = t.pressure[k][:, outward], rates[..., outward]
            x = (1 - 2 * k) * t.x[k, outward]
            out.append(WearingPatch(self._gap(table, k + 1), x, t.y[k], *fields, self.modulus))
        return out

    def leaves_table(self, results: StageResults) -> bool:
        """Return whether the frictional work of a state lies outside the table of the energy
        law.
        """
        if not self._law or self.end(results):
            return False
        t = surface_tractions(results)
        work = t.shear * t.slip
        return bool(leaves_table(work, self._law).any())

    def _leaning(self, results: StageResults, table: CaseTable) -> np.ndarray:
        """Return the mean slope of the guide under the pressure, (m,) [1]; elastic slopes have no
        mean.
        """
        patch: Any = results.patch
        out = []
        for k in range(self.contacts):
            load = patch.pressure[k].sum(axis=0)
            slope = self._gap(table, k + 1).guide.slope((1 - 2 * k) * patch.x[k])
            out.append(float((slope * load).sum() / load.sum()))
        return np.array(out)

    def _advanced(self, state: Groove, patches: list[WearingPatch], travel: float) -> Groove:
        """Return the state after an implicit step of `travel` [km]."""
        depth = state.depth.copy()
        closing = state.closing.copy()
        moved = self._moved(state.closing)
        for k, patch in enumerate(patches):
            worn, closes = patch.worn(travel)
            worn = evened_at_rims(worn, patch.loaded)
            closing[k] += closes
            for body, shift in enumerate((moved[k], 0.0)):
                grown = depth[k, body] + on_cells(patch.edges - shift, worn[body], self.cells)
                depth[k, body] = smoothed(grown, patch.width / (self.cells[1] - self.cells[0]))
        return replace(state, travel=state.travel + travel, depth=depth, closing=closing)

    def _two_ways(
        self, at: Groove, patches: list[WearingPatch], step: float
    ) -> tuple[Groove | None, float, str]:
        """Return the state after a step, its error over the allowed one, and why there is none."""
        full, half = (self._advanced(at, patches, part * step) for part in (1.0, 0.5))
        middle = self.solve(half)
        reason = self.end(middle)
        if reason:
            return None, np.inf, reason
        two = self._advanced(
            self.turned(half, middle), self._patches(middle, self.worn_table(half)), 0.5 * step
        )
        apart = np.abs(two.depth - full.depth).sum(axis=1)
        wore = np.any(two.depth > at.depth, axis=1).sum(axis=1)
        error = float(np.max((apart**2).sum(axis=1) / np.maximum(wore, 1))) ** 0.5
        allowed = TOLERANCE * self.scale + SHARE * max(
            float(at.depth.max()) - DEEP * self.scale, 0.0
        )
        # extrapolation makes the noise of long steps larger
        beyond = TOLERANCE * self.scale / allowed
        depth = np.maximum(two.depth + beyond * (two.depth - full.depth), at.depth)
        closing = two.closing + beyond * (two.closing - full.closing)
        new = replace(two, depth=depth, closing=closing, error=at.error + error)
        return new, error / allowed, ""

    def _begin(self, state: Groove | None) -> tuple[Groove, StageResults]:
        """Return the state from which a march begins, with its results; the new groove if none is
        given.
        """
        if state is None:
            return self.start, self.new
        return state, self.solve(state)

    def march(
        self, state: Groove | None = None, step: float = 0.0, states: int = 1
    ) -> Iterator[tuple[Groove, StageResults, float, str]]:
        """Yield states with their results, the next step [km], and at the last one why it cannot go
        on.

        A state and its next step determine all that follows, so that a march that goes on has the
        same bits. Without wear the new groove is the only state.

        Parameters
        ----------
        state : Groove, optional
            State from which the march goes on; default: the new groove.
        step : float
            Next step of a march that goes on [km].
        states : int
            Number of states so far, which counts towards the limit.
        """
        at, results = self._begin(state)
        reason = self.end(self.new)
        yield at, results, step, reason
        if reason:
            return
        for _ in range(states, STEPS):
            patches = self._patches(results, self.worn_table(at))
            at = self.turned(at, results)
            if any(
                p.edges[0] < self.cells[0] - p.width or p.edges[-1] > self.cells[-1] + p.width
                for p in patches
            ):
                yield at, results, step, "wide"
                return
            fastest = max(float(patch.rate.max()) for patch in patches)
            if not fastest > 0.0:
                return
            step = step or FIRST * self.scale / fastest
            least = LEAST * max(FIRST * self.scale, SHARE * float(at.depth.max())) / fastest
            tries = 0
            while True:
                new, ratio, reason = self._two_ways(at, patches, step)
                if new is not None and ratio <= 1.0:
                    after = self.solve(new)
                    reason = self.end(after)
                    if not reason:
                        break
                if reason:
                    step *= SHRINK
                    tries += 1
                else:
                    step *= max(SHRINK, 0.9 / np.sqrt(ratio))
                    tries = 0
                if step < least or tries == TRIES:
                    yield at, results, step, reason or "steps"
                    return
            at = new
            results = after
            step = step * min(GROWTH, 0.9 / np.sqrt(max(ratio, 1e-12)))
            yield at, results, step, ""
        yield at, results, step, "steps"


def _rates(table: CaseTable, options: Options, per_km: np.ndarray) -> np.ndarray:
    """Return the depth per km of roller and guide over the integral of `local_rates`, (2,); 0 where
    it is not known.
    """
    if options.normal != "halfspace":
        raise InputError(
            "normal",
            options.normal,
            "halfspace, because a worn groove is no circle",
            "Set normal to halfspace.",
        )
    bodies = table.roller, table.guide
    if options.wear_law == "energy":
        if not table.loss_tables[0]:
            remedy = "Give wear_table, or energy_wear of both materials, or take wear_law: archard."
            raise InputError(
                "wear_table",
                None,
                "a table of mass loss over frictional work for wear_law: energy",
                remedy,
            )
        name = "density"
        allowed = "a number [kg/m3]"
        k = np.array([1.0 / body.density[0] for body in bodies])
    else:
        name = "wear_coefficient"
        allowed = "a number [mm3/(N m)]"
        k = np.array([body.wear_coefficient[0] for body in bodies])
    if np.isnan(k).all():
        remedy = f"Give it: roller_material: {{like: NAME, {name}: NUMBER}}."
        raise InputError(name, None, f"{allowed} of roller or guide", remedy)
    return np.nan_to_num(
        1e-3 * np.nan_to_num(table.wear_coefficient_factor[0], nan=1.0) * k * per_km
    )
