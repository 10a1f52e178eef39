"""The margins of one solved roller: each limit with the value now, the value permitted, and what comes first."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import xarray as xr

from trackroller.damage import LIMITS, heat, judged
from trackroller.damage.limit import OF_GUIDE, SN_SCATTER, Limit
from trackroller.damage.verdict import ENDS, STATES
from trackroller.fit.stored import fits_of_case
from trackroller.materials import Material
from trackroller.parameters import BODIES
from trackroller.report.numbers import between, capital, listing, number, rounded, row_unit
from trackroller.report.tables.lives import overrollings
from trackroller.report.words.by_tests import worst
from trackroller.results.lives import past_data
from trackroller.roller import temperature
from trackroller.roller.limit_notes import Placeholder, given_in_vain, lacks_of, notes_of, placeholders_of
from trackroller.roller.regime_limits import Limits
from trackroller.roller.stored_inputs import CASE, inputs_of

OVERLOADED = "tensile strength"  # in the reason why a body has no fatigue life
YIELD = 1.6  # of the yield strength: the pressure at which a contact yields below its surface
BOTH = "roller and guide"


GUESSED = " (rests on placeholders)"
TIED = 1e-9  # relative difference of lives that count as equal


@dataclass(frozen=True)
class Margin:
    """A limit of the roller, of the guide, of both, or of the pair.

    Parameters
    ----------
    title, body : str
        Words of the limit, and "roller", "guide", `BOTH` or "pair".
    now, required : str
        The value, and the value that it must not exceed.
    used : float
        Load over the load at the limit [1]; NaN if it is not known.
    hours, low, high : float
        Life to the limit and the ends of its range [h]; NaN if the limit has no life, or if the life is not known.
    state : str
        One of `trackroller.damage.verdict.STATES`.
    breaks : bool
        Whether the body breaks at once by this limit.
    timed, beside : bool
        Whether the limit has a life, known or not, and whether it is a second model of an end that another limit has.
    beyond, guessed : bool
        Whether the life lies beyond the S-N data, and whether the limit rests on placeholders of a material.
    lifeless : bool
        Whether the body has no fatigue life, because it breaks at once or the roller skids.
    """

    title: str
    body: str
    now: str
    required: str
    used: float = math.nan
    hours: float = math.nan
    low: float = math.nan
    high: float = math.nan
    state: str = "unknown"
    breaks: bool = False
    timed: bool = False
    beside: bool = False
    beyond: bool = False
    guessed: bool = False
    lifeless: bool = False

    @property
    def short(self) -> str:
        """Return the words of the limit without the remark in brackets."""
        return self.title.partition(" (")[0]

    @property
    def words(self) -> str:
        """Return the limit with the body that it concerns, for running text."""
        of = {BOTH: f" of {BOTH}", "pair": ""}.get(self.body, f" of the {self.body}")
        return f"{self.title}{of}{GUESSED * self.guessed}"

    @property
    def ends(self) -> bool:
        """Return whether the limit ends a life: it has known hours and stands beside no other, or the body breaks."""
        return self.breaks or (self.timed and not self.beside and not math.isnan(self.hours))

    @property
    def reached(self) -> float:
        """Return the hours until the limit is reached: 0 if the body breaks, infinity if they are not known."""
        if self.breaks:
            return 0.0
        return math.inf if math.isnan(self.hours) else self.hours

    @property
    def share(self) -> str:
        """Return the share that is used, in percent."""
        return "" if math.isnan(self.used) else f"{rounded(100.0 * self.used)} %"

    @property
    def factor(self) -> str:
        """Return the permitted load over the load, which has to be at least 1."""
        return rounded(1.0 / self.used) if self.used > 0 else ""

    @property
    def life(self) -> str:
        """Return the hours to the limit with their range, or whether a limit without hours is kept."""
        if self.breaks:
            return "exceeded now"
        if self.lifeless:
            return "no fatigue life"
        if math.isnan(self.hours):
            return "not known" if self.timed else {"unknown": ""}.get(self.state, self.state)
        return between(self.low, self.high, self.beyond)

    @property
    def when(self) -> str:
        """Say when the limit is reached."""
        if self.breaks:
            return self.life
        return f"after {self.life}" if math.isfinite(self.reached) else self.life


def margins(
    ds: xr.Dataset,
    ranges: Limits,
    inputs: Mapping[str, Any],
    materials: Mapping[str, Material],
    lifeless: Mapping[str, str],
) -> list[Margin]:
    """Return the margins of a solved case in the order in which their limits are reached.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of one case. The limits of the room `damage` need the output `limits`.
    ranges : Limits
        Ranges of forces and friction in which the roller rolls.
    inputs : mapping
        Inputs of the case by name.
    materials : mapping of str to Material
        Material of each body.
    lifeless : mapping of str to str
        Why a body has no fatigue life; an empty text if it has one.
    """
    out: list[Margin] = []
    for margin in (
        *_of_limits(ds, inputs, materials, lifeless),
        *_of_pressure(ds, materials),
        *_of_loads(ranges, inputs),
    ):
        if out and str(margin) == str(replace(out[-1], body=margin.body)):  # as texts, because NaN equals nothing
            out[-1] = replace(margin, body=BOTH)
        else:
            out.append(margin)
    # the limit that the verdict names leads; a second model of an end, such as a standard rating, stands behind it
    first = min((m.reached for m in out if m.ends), default=0.0)
    return sorted(
        out,
        key=lambda m: (
            m.state != "exceeded",
            max(m.reached, first) if m.beside else m.reached,
            m.beside,
            0.0 if math.isnan(m.used) else -m.used,
        ),
    )


def _of_limits(
    ds: xr.Dataset, inputs: Mapping[str, Any], materials: Mapping[str, Material], lifeless: Mapping[str, str]
) -> list[Margin]:
    """Return the margins of the limits of a result, for the bodies that they concern."""
    out, (tested, _) = [], fits_of_case(ds)
    places = {dim: ds[dim].values.tolist() for dim in ("limit", "body") if dim in ds}
    rests_on = placeholders_of(ds)
    broken = {body: OVERLOADED in lifeless[body] for body in lifeless}
    for name in places["limit"] if "utilisation" in ds else ():
        limit = LIMITS[name]
        variable = next((one for one in limit.compares[0].split() if one in ds), "utilisation")
        words = f": {limit.compares[1]}" if limit.compares[1] else ""
        unit = row_unit(ds.variables[variable].attrs["units"])
        timed = bool(np.any(~np.isnan(_at(ds, "life_hours_by_limit", places, limit=name))))
        for body in limit.bodies:
            here = {"limit": name, "body": body}
            used = float(_at(ds, "utilisation", places, **here))
            hours, low, high = (float(_at(ds, f"life_hours_by_limit{end}", places, **here)) for end in ENDS)
            if math.isnan(used) and math.isnan(hours):
                continue
            # a body that breaks at once breaks by its strength, unless that limit is left out
            breaks = broken[body] and name == ("static" if "static" in places["limit"] else "fatigue")
            state = STATES[int(_at(ds, "limit_state", places, **here))]
            values = np.asarray(_at(ds, variable, places, **here), dtype=float)
            value = float(np.nanmax(values)) if np.isfinite(values).any() else math.nan
            bound = f"{rounded(value / used if used > 0 else math.nan)} {unit}".strip()
            bound = _given_bound(limit, inputs) if math.isnan(used) else bound + words
            texts = f"{rounded(value)} {unit}".strip(), bound
            cycles = hours * overrollings(inputs, body)
            beyond = limit.distribution == SN_SCATTER and (used < 1.0 or bool(past_data(cycles)))
            if name == "fatigue" and body in tested and math.isfinite(hours):
                stress, median = worst(ds, body, tested[body])
                beyond = bool(tested[body].extrapolates(stress, median))
                ends = tested[body].cycles(stress, float(ds.attrs["failure_probability"]))
                low, high = (end / overrollings(inputs, body) for end in ends)
            # both bodies share the heat of a contact
            of = [one.material for one in rests_on if one.limit == name]
            guessed = bool(of) if limit is heat.LIMIT else materials[body].name in of
            no_life = name == "fatigue" and bool(lifeless[body])
            numbers = used, hours, low, high
            kind = timed and not no_life, limit.beside, beyond, guessed, no_life
            out.append(Margin(limit.title, body, *texts, *numbers, state, breaks, *kind))
    return out


def _given_bound(limit: Limit, inputs: Mapping[str, Any]) -> str:
    """Return the given value that a limit with a life needs, such as the permissible wear depth; a dash without one."""
    for parameter in limit.parameters:
        value = inputs.get(parameter.name)
        if parameter.name in limit.requires and value is not None and not math.isnan(float(value)):
            return f"{number(value)} {row_unit(parameter.unit)}: {parameter.long_name}"
    return "–"


def _at(ds: xr.Dataset, name: str, places: Mapping[str, list[Any]], **labels: str) -> np.ndarray:
    """Return the values of a variable at labels; xarray's own selection takes fifty times as long."""
    variable = ds.variables[name]
    return variable.values[tuple(places[d].index(labels[d]) if d in labels else slice(None) for d in variable.dims)]


def _of_pressure(ds: xr.Dataset, materials: Mapping[str, Material]) -> list[Margin]:
    """Return the margins of the largest pressure to the pressure that the validity flag `yield` allows."""
    pressure = float(ds["max_pressure"].max()) if "max_pressure" in ds else math.nan
    if math.isnan(pressure):
        return []
    bounds = {body: YIELD * material.tensile_strength for body, material in materials.items()}
    words = f"{YIELD:g} R_m; R_m stands for the yield strength"
    return [
        Margin(
            "pressure limit (yield below the surface)",
            body,
            f"{rounded(pressure)} MPa",
            f"{rounded(bound)} MPa: {words}",
            pressure / bound,
            state=_state(pressure / bound),
        )
        for body, bound in bounds.items()
    ]


def _state(used: float) -> str:
    """Return the state of a limit without placeholders."""
    return "unknown" if math.isnan(used) else STATES[1 if used < 1.0 else 3]


def _of_loads(ranges: Limits, inputs: Mapping[str, Any]) -> list[Margin]:
    """Return the margins of the pair to lift-off, full slip and self-locking."""
    out = []
    for title, name, (low, high) in (
        ("lift-off of a contact (axial force)", "axial_force", ranges.axial_force),
        ("full slip (motor force)", "motor_force", ranges.motor_force),
    ):
        if not math.isnan(low + high):
            value = float(inputs[name])
            bound = high if value >= 0 else low
            used = value / bound if bound else math.inf
            span = f"{rounded(low)} to {rounded(high)} N"
            used = used if math.isfinite(bound) else math.nan
            out.append(Margin(title, "pair", f"{number(value)} N", span, used, state=_state(used)))
    now, friction = float(inputs["friction_coefficient"]), number(inputs["friction_coefficient"])
    for title, bound in (
        ("self-locking (friction coefficient)", ranges.self_locking_friction),
        ("lift-off of a contact (friction coefficient)", ranges.lift_off_friction),
    ):
        if math.isfinite(bound):
            used = now / bound if bound else math.inf
            out.append(Margin(title, "pair", friction, f"{rounded(bound)}", used, state=_state(used)))
        elif math.isinf(bound):
            out.append(Margin(title, "pair", friction, "none up to 2"))
    return out


@dataclass(frozen=True)
class First:
    """What ends a life first: the limits that may come first within their ranges, and the life with its range.

    Attributes
    ----------
    margins : tuple of Margin
        The limits that may come first, the one that does with the values themselves at the head.
    low, high : float
        Ends of the life [h].
    """

    margins: tuple[Margin, ...]
    low: float
    high: float

    @classmethod
    def of(cls, listed: Iterable[Margin]) -> First | None:
        """Return what comes first of some limits; None where no life is known."""
        ending = sorted((margin for margin in listed if margin.ends), key=lambda margin: margin.reached)
        if not ending:
            return None
        low, high = (min(0.0 if m.breaks else getattr(m, end) for m in ending) for end in ("low", "high"))
        return cls(tuple(m for m in ending if m is ending[0] or m.low <= high * (1.0 + TIED)), low, high)

    @property
    def breaks(self) -> bool:
        """Return whether the body breaks at once."""
        return self.margins[0].breaks

    @property
    def guessed(self) -> bool:
        """Return whether placeholders decide the life."""
        return any(margin.guessed for margin in self.margins) and self.low < self.high * (1.0 - TIED)

    @property
    def when(self) -> str:
        """Say when it ends."""
        return self.margins[0].when if len(self.margins) == 1 else f"after {self.life}"

    @property
    def life(self) -> str:
        """Return the hours with their range."""
        return between(self.low, self.high, any(margin.beyond for margin in self.margins))


def first_limits(listed: list[Margin], judged: bool = True) -> list[str]:
    """Return one sentence for roller, guide and pair each on what ends its life first; `judged` by the model or not."""
    out, head = [], "First limit" if judged else "If the model holds, first limit"
    for body in BODIES:
        if (own := First.of(m for m in listed if m.body in (body, BOTH))) is not None:
            titles = " or ".join(f"{m.title}{GUESSED * m.guessed}" for m in own.margins)
            out.append(f"{head} of the {body}: {titles}, {own.when}.")
    if (pair := First.of(listed)) is not None:
        words = " or ".join(margin.words for margin in pair.margins)
        out.append(f"{head} of the pair: {words}, {pair.when}{_guide_alone(listed)}.")
    return out


def _guide_alone(listed: list[Margin]) -> str:
    """Say that the guide's hours are not known; an empty text if they are, or if a body breaks at once."""
    unknown = any(m.timed and not m.beside and math.isnan(m.hours) and m.body == "guide" for m in listed)
    return "; the guide's hours are not known" if unknown and not any(m.breaks for m in listed) else ""


def what_ends(listed: list[Margin]) -> str:
    """Say what ends the life of the pair, after how many hours, and what would end it next, as a part of a sentence.

    The text is empty where no life is known, or where a body breaks at once.
    """
    first = First.of(listed)
    if first is None or first.breaks or math.isinf(first.low):
        return ""
    shorts = list(dict.fromkeys(margin.short for margin in first.margins))
    bodies = {margin.body for margin in first.margins}
    body = bodies.pop() if len(bodies) == 1 else "pair"
    body = "pair" if body == BOTH else body
    later: dict[str, str] = {}
    for margin in sorted((margin for margin in listed if margin.ends), key=lambda margin: margin.reached):
        if margin.short not in shorts:
            other = f" end the {margin.body}" * (margin.body not in (body, BOTH))
            later.setdefault(margin.short, f"; {margin.short} would{other} after {margin.life}")
    unmeasured = ", by values that nobody has measured" * first.guessed
    head = f"{capital(' or '.join(shorts))} ends the {body}"
    return f"{head} after {first.life}{unmeasured}{''.join(later.values())}{_guide_alone(listed)}"


def unchecked(ds: xr.Dataset) -> list[str]:
    """Return the names of the limits that were checked for neither body."""
    if "limit_state" not in ds:
        return []
    state = ds.variables["limit_state"]
    known = (state != STATES.index("unknown")).any([dim for dim in state.dims if dim != "limit"]).values
    return ds["limit"].values[~known].tolist()


def not_checked(ds: xr.Dataset) -> list[str]:
    """Return what was not checked and what it lacks, and the limits that the user left out."""
    lacking: dict[str, list[str]] = {}
    for lack in lacks_of(ds):
        lacking.setdefault(lack.limit, []).append(lack.words if lack.material else f"give {lack.name}")
    for name in [name for name in lacking if "limit_state" in ds and name in ds["limit"].values]:
        state = ds["limit_state"].sel(limit=name)
        known = [b for b in BODIES if bool((state.sel(body=b) != STATES.index("unknown")).any())]
        if known == ["guide"]:  # so that only the roller lacks it
            lacking = {f"{n} of the roller" if n == name else n: texts for n, texts in lacking.items()}
    for_guide = [name for name, texts in lacking.items() if texts == [f"give {OF_GUIDE[0]}"]]
    parts = [f"{name} ({', '.join(texts)})" for name, texts in lacking.items() if name not in for_guide]
    parts += [f"{listing(for_guide)} of the guide (give {OF_GUIDE[0]})"] if for_guide else []
    out = [f"Not checked: {'; '.join(parts)}."] if parts else []
    asked = str(ds.attrs.get("limits", "")).split()
    missing = [limit.name for limit in judged() if limit.name not in asked]
    out += [f"Left out: {listing(missing)}."] if missing else []
    return out + _given_in_vain(ds, [*unchecked(ds), *missing])


def _given_in_vain(ds: xr.Dataset, idle: list[str]) -> list[str]:
    """Name the values of a case that were given for limits which were not checked, and for nothing else."""
    if CASE not in ds.attrs or "case" in ds.dims or not idle:
        return []
    unused: dict[str, list[str]] = {}
    for name, users in given_in_vain(inputs_of(ds), idle).items():
        unused.setdefault(listing(users), []).append(name)
    return [
        f"Given, but not used: {listing(names)}, because {limits} {'are' if ' ' in limits else 'is'} not checked."
        for limits, names in unused.items()
    ]


def placeholders(ds: xr.Dataset) -> list[str]:
    """Return the placeholders of materials on which the limits rest, one sentence for a material."""
    found: dict[str, dict[str, list[Placeholder]]] = {}
    for one in placeholders_of(ds):
        found.setdefault(one.material, {}).setdefault(one.limit, []).append(one)
    return [
        f"Placeholders of material '{material}': "
        + "; ".join(f"{limit} with {', '.join(one.words for one in own)}" for limit, own in by_limit.items())
        + "."
        for material, by_limit in found.items()
    ]


def at_temperature(ds: xr.Dataset) -> list[str]:
    """Return one sentence for each table over temperature that the results rest on."""
    return [note for note in notes_of(ds) if note.startswith(temperature.HEAD)]
