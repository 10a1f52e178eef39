"""Solve one roller while its groove wears: results along the travel as a labelled data set (`tr.wear`)."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.contact.normal.measure import roughness
from trackroller.damage.limit import variables
from trackroller.damage.wear import BEYOND_TABLE
from trackroller.errors import InputError, check_names
from trackroller.materials import load_database
from trackroller.numerics.numbers import number_in
from trackroller.parameters import OPTIONS
from trackroller.roller.case import Case, to_table
from trackroller.roller.dataset import NOTES
from trackroller.roller.limit_notes import notes_on_limits
from trackroller.roller.options import Options
from trackroller.roller.reflection import handed, reflect
from trackroller.roller.solver import assemble, block_of
from trackroller.roller.stages import outcome as stages_outcome
from trackroller.roller.stages.scene import StageResults
from trackroller.roller.stored_inputs import CASE, MATERIALS, with_inputs
from trackroller.roller.wearing import ENDS, Groove, Wearing, between, travel_to_depth

if TYPE_CHECKING:
    import xarray as xr

    from trackroller.materials import MaterialDatabase

OUTPUTS = ("forces", "contact", "friction_work", "peak_stress", "life")
PATCH = "contact"  # group of pressure and patch, which the states of every run have: page and sentences show them
_C = ("contact",)
_CB = ("contact", "body")
VARIABLES = variables(
    "groove",
    ("groove_depth", _CB, "mm", "d", "depth of the deepest worn place"),
    ("groove_depth_error", (), "mm", "delta(d)", "estimated error of the depth, by steps and elements"),
    ("groove_step_error", (), "mm", "", "estimated error of the depth, summed over the steps"),
    ("pressure_error", _C, "1", "", "estimated relative error of the largest pressure of a worn groove"),
    ("groove_volume", _CB, "mm3", "V", "worn volume of the roller's circumference, and of a metre of the guide"),
    ("worn_depth", (*_CB, "place"), "mm", "d(x)", "depth that wear took off normal to the contact plane"),
    ("guide_surface", (*_C, "place"), "mm", "z", "worn surface of the guide over the new one"),
    ("roller_surface", (*_C, "place"), "mm", "z", "worn surface of the roller over the new guide, where both touch"),
    ("contact_angle", _C, "degree", "alpha", "inclination of the resultant of the pressure"),
    ("closing", _C, "mm", "", "distance by which wear let the bodies close"),
    ("next_step", (), "km", "", "next step of a run that goes on; missing at the end, which lies between two steps"),
    ("start_inclination", _C, "rad", "", "turning of the contact normal outward, from which the solution started"),
    (
        "start_balance",
        ("unknown",),
        "1",
        "",
        "rolling radius shift [mm] and forces [N] from which the solution started",
    ),
    ("start_box", ("contact", "side"), "mm", "", "ends and half length of the patch from which the solution started"),
)
FARTHEST = 1e9  # km
# Relative difference of two damage rates up to which their mean is the arithmetic one, which is then right to its
# square. The logarithmic mean divides two differences, of which rounding leaves nothing for nearly equal rates.
ALIKE = 1e-6
# Error of the largest pressure times the columns of elements, and over its `roughness` within NEAR columns: wear leaves
# a ridge at the spin pole. The sum covers the difference to finer runs in 95 % of states of random rollers.
COLUMN_ERROR = 0.5
RIDGE_ERROR = 0.2
NEAR = 3
Tell = Callable[["xr.Dataset", float], None]


def wear(
    case: Case | dict[str, Any],
    to: float | str,
    outputs: Iterable[str] | str | None = None,
    *,
    resume: xr.Dataset | None = None,
    tell: Tell | None = None,
    database: MaterialDatabase | None = None,
    **options: Any,
) -> xr.Dataset:
    """Follow roller and guide while their profiles wear, and return the results along the travel.

    The case has to give wear coefficients by its materials. Both profiles, the balance of the roller, the pressures and
    the contact angles are solved anew after each step.

    Parameters
    ----------
    case : Case or mapping
        The new roller and its guide.
    to : float
        Travel at which to end, > 0 [km]. The travel also ends at `permissible_wear_depth`, and where a contact is lost;
        the attribute `end` says which.
    outputs : str or iterable of str
        Groups of results as of `solve`; by default "forces", "contact", "friction_work", "peak_stress" and "life". The
        group "contact" is always among them.
    resume : xarray.Dataset, optional
        Result of the same case to a shorter travel, from which the run goes on. The result has the same bits.
    tell : callable, optional
        Function that receives the results so far and the goal `to` after each step.
    database : MaterialDatabase, optional
        The materials; by default the built-in ones with the user's own over them.
    **options
        Options of `solve`; `normal` is "halfspace".

    Returns
    -------
    xarray.Dataset
        Results of `solve` along `travel` [km], and in addition depth, volume and worn profiles along `place` [mm],
        contact angles, the damage sum of the S-N curve, and the estimated error of the depth.

    Raises
    ------
    InputError
        For bad input, a material without wear coefficient, or `resume` of another roller.

    Notes
    -----
    A step is implicit in the pressure, and is taken once whole and once in two halves. Both results extrapolate the
    depth, and their difference controls the step. To 50 km it takes some seconds of processor time.

    Examples
    --------
    >>> import trackroller as tr
    >>> steel = {"like": "1.7225-quenched-tempered", "wear_coefficient": 1e-5}
    >>> case = tr.Case(motor_force=0, axial_force=0, friction_coefficient=0.2, roller_material=steel)
    >>> ds = tr.wear(case, to=10, contact_model="sliding", accuracy="preview")
    >>> float(ds.travel[-1]), ds.attrs["end"]
    (10.0, 'travel')
    """
    if database is None:
        database = load_database()
    if not isinstance(case, Case):
        case = Case.from_dict(case)
    allowed = "a travel > 0 km and at most 1e9 km, such as 500km"
    to = number_in(to, "to", allowed, np.nextafter(0.0, 1.0), FARTHEST, unit="km")
    check_names("option", options, OPTIONS)
    if outputs is None:
        outputs = OUTPUTS
    settings = Options(**{"normal": "halfspace", "outputs": outputs} | options)
    if PATCH not in settings.outputs:
        settings = settings.changed(outputs=(*settings.outputs, PATCH))
    record = _Record(case, settings, database, tell, to)
    return record.run(resume)


class _Record:
    """The run of one roller: its march, and the results that were made of its states."""

    def __init__(self, case: Case, options: Options, database: MaterialDatabase, tell: Tell | None, to: float) -> None:
        self.case = case
        self.options = options
        self.database = database
        self.tell = tell
        self.to = to
        self.table, self.mirrored = handed(to_table(case, database))
        self.wearing = Wearing(self.table, options)
        self.rows: list[xr.Dataset] = []

    def run(self, resume: xr.Dataset | None) -> xr.Dataset:
        """Return the results up to the end."""
        if resume is None:
            state = None
            step = 0.0
        else:
            state, step = self._taken_up(resume)
        before: Groove | None = None
        for at, results, onward, reason in self.wearing.march(state, step, len(self.rows) or 1):
            if reason and (before is None or at.travel == before.travel):
                if before is None and state is None:
                    self._add(at, at, results, np.nan)
                return self._joined(reason)
            turned = self.wearing.turned(at, results)
            if before is None:
                goal = None
            else:
                goal = self._goal(before, turned)
            if goal:
                end, place = goal
                self._add(place, place, self.wearing.solve(place), np.nan)
                return self._joined(end)
            if before is not None or state is None:  # a state that is taken up has its row
                self._add(at, turned, results, onward)
            before = turned
        # nothing wears
        self._add(replace(self.wearing.start, travel=self.to), before or self.wearing.start, self.wearing.new, np.nan)
        return self._joined("travel")

    def _goal(self, one: Groove, two: Groove) -> tuple[str, Groove] | None:
        """Return the first goal between two states, and the state there."""
        permissible = float(self.table.permissible_wear_depth[0])
        if permissible > 0.0:
            deep = travel_to_depth(one, two, permissible)
        else:
            deep = np.inf
        travel = min(deep, self.to)
        if travel > two.travel:
            return None
        place = between(one, two, travel)
        return ("permissible" if deep < self.to else "travel"), place

    def _add(self, state: Groove, turned: Groove, results: StageResults, onward: float) -> None:
        """Add the row of a solved state; `turned` has the inclination by its own pressure."""
        block = block_of(results, self.options)
        block.values[BEYOND_TABLE] = np.array([self.wearing.leaves_table(results)])
        stages_outcome.finish(self.table, block, self.options)
        reflect(block.values, self.mirrored)
        row = assemble(block, self.options, single=True)
        values = self._values(state, turned, onward) | {"pressure_error": _pressure_error(state, results)}
        for v in VARIABLES:
            if v.name in values:
                array = np.asarray(values[v.name])
                row[v.name] = v.dims, self._seen(array, v.dims), {"units": v.units, "long_name": v.long_name}
        self.rows.append(row.assign_coords(travel=state.travel))
        if self.tell is not None:
            self.tell(self._joined("running"), self.to)

    def _seen(self, array: np.ndarray, dims: tuple[str, ...]) -> np.ndarray:
        """Return an array with contacts 1 and 2 swapped if the mirror image of the roller was solved, and back."""
        if self.mirrored[0] and dims[:1] == ("contact",):
            return array[::-1]
        return array

    def _values(self, state: Groove, turned: Groove, onward: float) -> dict[str, Any]:
        w = self.wearing
        both = (2, *state.depth.shape[1:])
        depth = np.broadcast_to(state.depth, both)
        step = w.places[1] - w.places[0]
        balance = boxes = np.full(3, np.nan)
        if state.balance is not None:
            balance = state.balance
        if state.boxes is not None:
            boxes = state.boxes
        around = 2.0 * np.pi * (w.radius[0] + w.places * np.sin(w.alpha[0]))
        return {
            "groove_depth": depth.max(axis=2),
            "groove_depth_error": state.error + w.element_error * float(depth.max()),
            "groove_step_error": state.error,
            "groove_volume": np.stack([(depth[:, 0] * around).sum(axis=1), 1e3 * depth[:, 1].sum(axis=1)], 1) * step,
            "worn_depth": depth,
            "guide_surface": -depth[:, 1],
            "roller_surface": w.gaps(state) - depth[:, 1],
            "contact_angle": np.broadcast_to(np.degrees(w.alpha[0] + turned.inclined), 2),
            "closing": np.broadcast_to(state.closing, 2),
            "next_step": onward,
            "start_inclination": np.broadcast_to(state.inclined, 2),
            "start_balance": balance,
            "start_box": np.broadcast_to(boxes, (2, 3)),
        }

    def _joined(self, end: str) -> xr.Dataset:
        """Return the rows along `travel` with the damage sum, and say why the travel ends."""
        import xarray as xr  # noqa: PLC0415 - heavy

        ds = xr.concat(self.rows, "travel", coords="minimal", compat="override", combine_attrs="override")
        ds = ds.assign_coords(place=("place", self.wearing.places, {"units": "mm", "long_name": "place outward"}))
        ds["travel"].attrs |= {"units": "km", "long_name": "travel since the bodies were new"}
        if "life_cycles" in ds:
            ds = ds.assign(_of_lives(ds, self.wearing.per_km))
        ds.attrs |= {"title": "A roller and its guide while they wear", "end": end, "to": self.to}
        ds.attrs[NOTES] = "\n".join(notes_on_limits(self.table, self.options.changed(outputs=("wear",))))
        ds.attrs |= {"wear_per_km": self.wearing.rates.tolist(), "end_meaning": ENDS.get(end, "")}
        return with_inputs(ds, self.case, self.database)

    def _taken_up(self, ds: xr.Dataset) -> tuple[Groove | None, float]:
        """Take over the rows of a shorter travel, and return the last state and its next step [km]."""
        if "next_step" not in ds:
            raise InputError("resume", ds.attrs.get("title"), "a result of wear", "Give another file.")
        own = with_inputs(ds.isel(travel=0).copy(), self.case, self.database).attrs
        stated = self.options.attributes() | {name: own[name] for name in (CASE, MATERIALS)}
        for name, value in stated.items():
            if str(ds.attrs.get(name)) != str(value):
                remedy = "Give the same case and options, or start anew in another file."
                raise InputError("resume", name, "results of the same case with the same options", remedy)
        states = np.flatnonzero(np.isfinite(ds.next_step.values) & (ds.travel.values < self.to))
        if states.size == 0:
            return None, 0.0
        derived = ("fatigue_damage", "fatigue_damage_error", "life_travel", "life_travel_new", "place")
        self.rows = [ds.drop_vars(derived, errors="ignore").isel(travel=int(i)) for i in states]
        last = self.rows[-1]
        m = self.wearing.contacts
        known = {v.name: self._seen(last[v.name].values, v.dims) for v in VARIABLES if v.name in last}
        state = Groove(
            float(last.travel),
            known["worn_depth"][:m],
            known["closing"][:m],
            known["start_inclination"][:m],
            float(known["groove_step_error"]),
        )
        if not np.isnan(known["start_balance"]).any():
            state = replace(state, balance=known["start_balance"], boxes=known["start_box"][:m])
        return state, float(last.next_step)


def _pressure_error(state: Groove, results: StageResults) -> np.ndarray:
    """Return the estimated relative error of the largest pressure, (2,) [1]; 0 for the new groove."""
    patch: Any = results.patch
    out = np.zeros(2)
    if not state.depth.any():
        return out
    for k in range(2):
        top = int(np.argmax(patch.pressure[k].max(axis=0)))
        ridge = roughness(patch.pressure[k][:, max(top - NEAR, 0) : top + NEAR + 1])
        out[k] = COLUMN_ERROR / patch.shape[1] + RIDGE_ERROR * ridge
    return out


def _of_lives(ds: xr.Dataset, per_km: np.ndarray) -> dict[str, Any]:
    """Return the damage sum along the travel, and the travel at which it reaches 1, with and without wear."""
    travel = ds["travel"].values
    cycles = ds["life_cycles"].transpose("travel", "contact", "body").values
    with np.errstate(divide="ignore", invalid="ignore"):
        rate = per_km / cycles
        one, two = rate[:-1], rate[1:]
        # between two states the damage rate follows a power of the stress, so that its logarithm is interpolated
        grows = (one > 0) & (two > 0) & (np.abs(two - one) > ALIKE * one)
        mean = np.where(grows, (two - one) / np.log(two / one), 0.5 * (one + two))
    grown = mean * np.diff(travel)[:, None, None]
    damage = np.concatenate([np.zeros_like(rate[:1]), np.cumsum(grown, axis=0)]) + 0.0 * rate
    error = ds["life_error_estimate"].transpose("travel", "contact", "body").values
    with np.errstate(divide="ignore", invalid="ignore"):
        error = np.cumsum(grown * np.maximum(error[1:], error[:-1]), axis=0) / damage[1:]
    error = np.concatenate([np.zeros_like(rate[:1]), error])
    life = np.full(rate.shape[1:], np.nan)
    for place in np.ndindex(*life.shape):
        own = damage[(slice(None), *place)]
        if np.isfinite(own).all() and own[-1] >= 1.0:
            life[place] = np.interp(1.0, own, travel)
    with np.errstate(divide="ignore"):
        new = 1.0 / rate[0]
    words = "travel at which the damage sum reaches 1"
    of_error = {"units": "1", "long_name": "estimated relative error of the damage sum and of its travel"}
    return {
        "fatigue_damage": (("travel", *_CB), damage, {"units": "1", "long_name": "damage sum of the S-N curve"}),
        "fatigue_damage_error": (("travel", *_CB), error, of_error),
        "life_travel": (_CB, life, {"units": "km", "long_name": f"{words}; missing if it lies beyond the end"}),
        "life_travel_new": (_CB, new, {"units": "km", "long_name": f"{words} under the stress of the new groove"}),
    }
