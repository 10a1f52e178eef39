"""The margins of one solved roller: each limit with its value, what is permitted, its use and its
range of lives.

Beside the limits of the room `damage` stand the pressure at which a body yields, and what lifts a
contact off, makes the roller skid or locks it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import xarray as xr

from trackroller.damage import LIMITS, heat
from trackroller.damage.first_limit import ENDS, STATES
from trackroller.damage.limit import SN_SCATTER, Limit, roller_overrollings
from trackroller.fit.stored import StoredFit, fits_of_case
from trackroller.materials import Material
from trackroller.parameters import BODIES, PARAMETERS, REGIMES
from trackroller.results.fatigue_lines import line_of
from trackroller.results.life_columns import past_data
from trackroller.roller.dataset import validity_bit
from trackroller.roller.geometry import rolling_radius
from trackroller.roller.limit_notes import placeholders_of
from trackroller.roller.regime_limits import Limits

YIELD = 1.6  # of the yield strength: the pressure at which a contact yields below its surface
BOTH = "roller and guide"
TIED = 1e-9  # relative difference of lives that count as equal
BROKEN = "breaks"  # why a body has no fatigue life
SKIDS = "skids"


@dataclass(frozen=True)
class Margin:
    """A limit of the roller, of the guide, of both, or of the pair.

    Parameters
    ----------
    name, word, title : str
        Name of the limit, its word in tables and headlines, and its definition.
    body : str
        "roller", "guide", `BOTH` or "pair".
    value, permitted : float
        The value, and the value that it must not exceed [units]; NaN if it is not known.
    units, bound : str
        Unit of both, and what the permitted value is.
    least : float
        Smallest permitted value of a load that has a range [units]; NaN without one.
    used, used_low, used_high : float
        Load over the load at the limit [1], with the ends of its range; NaN if it is not known.
    hours, low, high : float
        Life to the limit and the ends of its range [h]; NaN if the limit has no life, or if the
        life is not known.
    state : str
        One of `trackroller.damage.first_limit.STATES`.
    breaks : bool
        Whether the body breaks at once by this limit.
    timed, beside : bool
        Whether the limit has a life, known or not, and whether it is a second model of an end that
        another limit has.
    beyond, guessed : bool
        Whether the life lies beyond the S-N data, and whether the limit rests on placeholders of a
        material.
    lines : tuple of str
        Tests that the low and the high end of a life by fatigue follow from, see `line_of`.
    alone : bool
        Whether the life by fatigue follows from one kind of tests, because the material has no
        others.
    lifeless : bool
        Whether the body has no fatigue life, because it breaks at once or the roller skids.
    """

    name: str
    word: str
    title: str
    body: str
    value: float = math.nan
    permitted: float = math.nan
    units: str = "1"
    bound: str = ""
    least: float = math.nan
    used: float = math.nan
    used_low: float = math.nan
    used_high: float = math.nan
    hours: float = math.nan
    low: float = math.nan
    high: float = math.nan
    state: str = "unknown"
    breaks: bool = False
    timed: bool = False
    beside: bool = False
    beyond: bool = False
    guessed: bool = False
    lines: tuple[str, str] = ("", "")
    alone: bool = False
    lifeless: bool = False

    @property
    def ends(self) -> bool:
        """Return whether the limit ends a life: it has known hours and stands beside no other, or
        the body breaks.
        """
        return self.breaks or (self.timed and not self.beside and not math.isnan(self.hours))

    @property
    def reached(self) -> float:
        """Return the hours until the limit is reached: 0 if the body breaks, infinity if they are
        not known.
        """
        if self.breaks:
            return 0.0
        if math.isnan(self.hours):
            return math.inf
        return self.hours

    @property
    def soonest(self) -> float:
        """Return the low end of the hours; 0 if the body breaks, NaN if they are not known."""
        if self.breaks:
            return 0.0
        return self.low

    @property
    def latest(self) -> float:
        """Return the high end of the hours; 0 if the body breaks, NaN if they are not known."""
        if self.breaks:
            return 0.0
        return self.high

    @property
    def bodies(self) -> tuple[str, ...]:
        """Return the bodies that the limit concerns; none for the pair."""
        if self.body == BOTH:
            return BODIES
        return tuple(body for body in BODIES if body == self.body)


def overrollings(inputs: Mapping[str, Any], body: str) -> float:
    """Return the overrollings of a point of a body [1/h]; NaN if the overrollings of the guide are
    not given.
    """
    if body == "guide":
        rate = inputs.get("guide_overrollings_per_hour")
        if rate is None:
            return math.nan
        return float(rate)
    alpha = math.radians(inputs["contact_angle"])
    radius = rolling_radius(inputs["axis_distance"], inputs["guide_profile_radius"], alpha)
    return float(roller_overrollings(inputs["velocity"], radius))


def worst_contact(ds: xr.Dataset, body: str, fit: StoredFit) -> tuple[float, float]:
    """Return the stress of a body that enters its line [MPa], and its overrollings to failure, at
    its worse contact.

    A result without stresses gives the stress by the line of the fit, from which its overrollings
    follow.
    """
    cycles = float(ds["life_cycles"].sel(body=body).min("contact"))
    for name in ("fatigue_stress", "peak_stress"):
        if name in ds:
            return float(ds[name].sel(body=body).max("contact")), cycles
    best = fit.line.best
    return math.exp(
        fit.line.reference + float((best.level - math.log(cycles)) / best.slope)
    ), cycles


def overload_of(ds: xr.Dataset, body: str, material: Material) -> float:
    """Return the peak stress of a body over its tensile strength [1]; NaN without a stress."""
    if "peak_stress" not in ds:
        return math.nan
    peaks = ds["peak_stress"].sel(body=body).values
    return float(np.nan_to_num(peaks).max()) / material.tensile_strength


def lifeless_bodies(ds: xr.Dataset, materials: Mapping[str, Material]) -> dict[str, str]:
    """Return why each body has no fatigue life: `BROKEN` or `SKIDS`; an empty text if it has
    one.
    """
    regime = REGIMES[int(ds["regime"])]
    reasons = {}
    for body, material in materials.items():
        marked = False
        if "validity_body" in ds:
            marked = bool(int(ds["validity_body"].sel(body=body)) & validity_bit("static"))
        breaks = marked or overload_of(ds, body, material) > 1
        if breaks:
            reasons[body] = BROKEN
        elif regime == "full_slip":
            reasons[body] = SKIDS
        else:
            reasons[body] = ""
    return reasons


def margins(
    ds: xr.Dataset, ranges: Limits, inputs: Mapping[str, Any], materials: Mapping[str, Material]
) -> list[Margin]:
    """Return the margins of a solved case in the order in which their limits may be reached;
    exceeded ones come first.

    The limit that the headline names leads those that are kept.

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
    """
    out: list[Margin] = []
    for margin in (
        *_of_limits(ds, inputs, materials),
        *_of_pressure(ds, materials),
        *_of_loads(ranges, inputs),
    ):
        # as texts, because NaN equals nothing
        if out and str(margin) == str(replace(out[-1], body=margin.body)):
            out[-1] = replace(margin, body=BOTH)
        else:
            out.append(margin)
    first = First.of(out)
    leader = None
    if first is not None:
        leader = first.margins[0]
    return sorted(
        out, key=lambda margin: (margin.state != "exceeded", margin is not leader, *_order(margin))
    )


def _order(margin: Margin) -> tuple[float, bool, float]:
    """Return by what margins are ordered: the low end of the life, a second model behind others,
    and the use.
    """
    low = margin.soonest
    if math.isnan(low):
        low = math.inf
    used = margin.used
    if math.isnan(used):
        used = 0.0
    return low, margin.beside, -used


def _of_limits(
    ds: xr.Dataset, inputs: Mapping[str, Any], materials: Mapping[str, Material]
) -> list[Margin]:
    """Return the margins of the limits of a result, for the bodies that they concern."""
    lifeless = lifeless_bodies(ds, materials)
    if "utilisation" not in ds:
        return _of_fatigue_alone(ds, inputs, materials, lifeless)
    out = []
    tested, _ = fits_of_case(ds)
    listed = ds["limit"].values.tolist()
    places = {dim: ds[dim].values.tolist() for dim in ("limit", "body")}
    for name in listed:
        timed = bool(np.any(~np.isnan(_at(ds, "life_hours_by_limit", places, limit=name))))
        for body in LIMITS[name].bodies:
            margin = _of_body(ds, LIMITS[name], body, places, inputs)
            if math.isnan(margin.used) and math.isnan(margin.hours):
                continue
            if name == "fatigue" and body in tested and math.isfinite(margin.hours):
                margin = _by_tests(ds, margin, tested[body], overrollings(inputs, body))
            # a body that breaks at once breaks by its strength, unless that limit is left out
            own = "fatigue"
            if "static" in listed:
                own = "static"
            no_life = name == "fatigue" and bool(lifeless[body])
            out.append(
                replace(
                    margin,
                    breaks=lifeless[body] == BROKEN and name == own,
                    timed=timed and not no_life,
                    lifeless=no_life,
                    guessed=is_guessed(ds, name, materials[body].name),
                )
            )
    return with_lines(out, {body: material.as_dict() for body, material in materials.items()})


def with_lines(
    listed: Sequence[Margin], materials: Mapping[str, Mapping[str, Any]]
) -> list[Margin]:
    """Return limits of single bodies with the tests that their lives follow from; a range reaches
    to the life by other tests of the same end.

    Parameters
    ----------
    listed : sequence of Margin
        The limits of each body.
    materials : mapping
        Values of the material of each body by name.
    """
    out = []
    for margin in listed:
        line = line_of(margin.name, materials[margin.body])
        margin = replace(margin, lines=(line, line), alone=bool(line) and not margin.beside)
        for other in listed:
            if other.body == margin.body and _is_evidence(other, margin):
                margin = _reaching_to(margin, other, line_of(other.name, materials[other.body]))
        out.append(margin)
    return out


def _is_evidence(other: Margin, margin: Margin) -> bool:
    """Return whether a limit knows the life to the end of another one by other tests."""
    known = not math.isnan(margin.hours) and not math.isnan(other.hours)
    return known and LIMITS[other.name].evidence_of == margin.name


def _reaching_to(margin: Margin, other: Margin, line: str) -> Margin:
    """Return a limit whose range reaches to the life by other tests of the same end."""
    low, high = margin.lines
    if other.low < margin.low:
        low = line
    if other.high > margin.high:
        high = line
    return replace(
        margin,
        low=min(margin.low, other.low),
        high=max(margin.high, other.high),
        lines=(low, high),
        alone=False,
        guessed=margin.guessed or (other.guessed and line in (low, high)),
    )


def _of_fatigue_alone(
    ds: xr.Dataset,
    inputs: Mapping[str, Any],
    materials: Mapping[str, Material],
    lifeless: Mapping[str, str],
) -> list[Margin]:
    """Return the margins of fatigue, and of a body that breaks, of a result with lives and without
    limits.
    """
    if "pair_life_hours" not in ds:
        return []
    limit = LIMITS["fatigue"]
    tested, _ = fits_of_case(ds)
    out = []
    for body, material in materials.items():
        hours = float(ds[f"{body}_life_hours"])
        breaks = lifeless[body] == BROKEN
        margin = Margin(
            limit.name,
            limit.word,
            limit.title,
            body,
            hours=hours,
            low=hours,
            high=hours,
            timed=True,
        )
        state = "kept"
        if breaks:
            state = "exceeded"
        elif math.isnan(hours):
            state = "unknown"
        margin = replace(margin, state=state)
        if lifeless[body]:
            margin = replace(margin, timed=False, breaks=breaks, lifeless=not breaks)
        elif body in tested and math.isfinite(hours):
            margin = _by_tests(ds, margin, tested[body], overrollings(inputs, body))
        else:
            cycles = float(ds["life_cycles"].sel(body=body).min())
            margin = replace(
                margin, beyond=bool(past_data(cycles, material.cycles_at_fatigue_limit))
            )
        out.append(margin)
    return with_lines(out, {body: material.as_dict() for body, material in materials.items()})


def _of_body(
    ds: xr.Dataset,
    limit: Limit,
    body: str,
    places: Mapping[str, list[Any]],
    inputs: Mapping[str, Any],
) -> Margin:
    """Return the numbers of a limit for a body."""
    here = {"limit": limit.name, "body": body}
    used = float(_at(ds, "utilisation", places, **here))
    hours, low, high = (float(_at(ds, f"life_hours_by_limit{end}", places, **here)) for end in ENDS)
    variable = next((one for one in limit.compares[0].split() if one in ds), "utilisation")
    values = np.asarray(_at(ds, variable, places, **here), dtype=float)
    value = math.nan
    if np.isfinite(values).any():
        value = float(np.nanmax(values))
    permitted = math.nan
    if used > 0:
        permitted = value / used
    units = ds.variables[variable].attrs["units"]
    bound = limit.compares[1]
    if math.isnan(used):
        permitted, units, bound = _given_bound(limit, inputs)
        value = math.nan
    cycles = hours * overrollings(inputs, body)
    beyond = limit.distribution == SN_SCATTER and (used < 1.0 or bool(past_data(cycles)))
    uses = _ends_of_use(limit, used, hours, low, high)
    state = STATES[int(_at(ds, "limit_state", places, **here))]
    return Margin(
        limit.name,
        limit.word,
        limit.title,
        body,
        value,
        permitted,
        units,
        bound,
        used=used,
        used_low=uses[0],
        used_high=uses[1],
        hours=hours,
        low=low,
        high=high,
        state=state,
        beside=limit.beside,
        beyond=beyond,
    )


def _ends_of_use(
    limit: Limit, used: float, hours: float, low: float, high: float
) -> tuple[float, float]:
    """Return the ends of the range of a use [1]; a use of wear is a required travel over the life,
    any other is one.
    """
    if limit.name != "wear" or not (math.isfinite(used * hours) and low > 0):
        return used, used
    return used * hours / high, used * hours / low


def _given_bound(limit: Limit, inputs: Mapping[str, Any]) -> tuple[float, str, str]:
    """Return the given value that a limit with a life needs, such as the permissible wear depth,
    its unit and words.
    """
    for parameter in limit.parameters:
        value = inputs.get(parameter.name)
        if parameter.name in limit.requires and value is not None and not math.isnan(float(value)):
            return float(value), parameter.unit, parameter.long_name
    return math.nan, "1", ""


def _by_tests(ds: xr.Dataset, margin: Margin, fit: StoredFit, rate: float) -> Margin:
    """Return a margin of fatigue with the band of its tests."""
    stress, median = worst_contact(ds, margin.body, fit)
    low, high = (end / rate for end in fit.cycles(stress, float(ds.attrs["failure_probability"])))
    return replace(margin, beyond=bool(fit.extrapolates(stress, median)), low=low, high=high)


def is_guessed(ds: xr.Dataset, limit: str, material: str) -> bool:
    """Return whether a limit of a body rests on placeholders; both bodies share the heat of a
    contact.
    """
    of = [one.material for one in placeholders_of(ds) if one.limit == limit]
    if limit == heat.LIMIT.name:
        return bool(of)
    return material in of


def _at(ds: xr.Dataset, name: str, places: Mapping[str, list[Any]], **labels: str) -> np.ndarray:
    """Return the values of a variable at labels; xarray's own selection takes fifty times as
    long.
    """
    variable = ds.variables[name]
    at: list[Any] = [slice(None)] * variable.ndim
    for i, dim in enumerate(variable.dims):
        if dim in labels:
            at[i] = places[dim].index(labels[dim])
    values: np.ndarray = variable.values[tuple(at)]
    return values


def _of_pressure(ds: xr.Dataset, materials: Mapping[str, Material]) -> list[Margin]:
    """Return the margins of the largest pressure to the pressure that the validity flag `yield`
    allows.
    """
    pressure = math.nan
    if "max_pressure" in ds:
        pressure = float(ds["max_pressure"].max())
    if math.isnan(pressure):
        return []
    out = []
    for body, material in materials.items():
        bound = YIELD * material.tensile_strength
        words = f"{YIELD:g} R_m; R_m stands for the yield strength"
        title = "pressure limit (yield below the surface)"
        margin = Margin("pressure", "pressure", title, body, pressure, bound, "MPa", words)
        out.append(_with_use(margin, pressure / bound))
    return out


def _with_use(margin: Margin, used: float) -> Margin:
    """Return a margin without placeholders with its use and its state."""
    state = "exceeded"
    if math.isnan(used):
        state = "unknown"
    elif used < 1.0:
        state = "kept"
    return replace(margin, used=used, used_low=used, used_high=used, state=state)


def _of_loads(ranges: Limits, inputs: Mapping[str, Any]) -> list[Margin]:
    """Return the margins of the pair to lift-off, full slip and self-locking."""
    return [*_of_forces(ranges, inputs), *_of_friction(ranges, inputs)]


def _of_forces(ranges: Limits, inputs: Mapping[str, Any]) -> Iterator[Margin]:
    """Yield the margins of the axial and the motor force to the forces at which a contact ends."""
    for name, word, title, field, (low, high) in (
        (
            "lift_off",
            "lift-off",
            "lift-off of a contact by the axial force",
            "axial_force",
            ranges.axial_force,
        ),
        (
            "full_slip",
            "full slip",
            "full slip by the motor force",
            "motor_force",
            ranges.motor_force,
        ),
    ):
        if math.isnan(low + high):
            continue
        value = float(inputs[field])
        bound = low
        if value >= 0:
            bound = high
        used = math.inf
        if bound:
            used = value / bound
        words = f"{PARAMETERS[field].long_name} between {low:.4g} and {high:.4g} N"
        margin = Margin(name, word, title, "pair", value, bound, "N", words, least=min(low, high))
        if math.isinf(bound):
            used = math.nan
        yield _with_use(margin, used)


def _of_friction(ranges: Limits, inputs: Mapping[str, Any]) -> Iterator[Margin]:
    """Yield the margins of the friction to that of self-locking and that of a lift-off."""
    now = float(inputs["friction_coefficient"])
    for name, word, title, bound in (
        ("self_locking", "self-locking", "self-locking by friction", ranges.self_locking_friction),
        (
            "lift_off_friction",
            "lift-off by friction",
            "lift-off of a contact by friction",
            ranges.lift_off_friction,
        ),
    ):
        if math.isnan(bound):
            continue
        used = math.inf
        if bound:
            used = now / bound
        words = PARAMETERS["friction_coefficient"].long_name
        margin = Margin(name, word, title, "pair", now, bound, "1", words)
        if math.isfinite(bound):
            margin = _with_use(margin, used)
        else:
            margin = replace(margin, state="kept", bound=f"{words}: none up to 2")
        yield margin


@dataclass(frozen=True)
class First:
    """What ends a life first: the limits that may come first within their ranges, and the life with
    its range.

    Attributes
    ----------
    margins : tuple of Margin
        The limits that may come first, the one that does with the values themselves at the head.
    low, high : float
        Ends of the life [h].
    lines : tuple of str
        Tests that both ends follow from where the life is a range between different tests; '' where
        another limit than fatigue gives the end.
    """

    margins: tuple[Margin, ...]
    low: float
    high: float
    lines: tuple[str, str] = ("", "")

    @classmethod
    def of(cls, listed: Iterable[Margin]) -> First | None:
        """Return what comes first of some limits; None where no life is known."""
        ending = sorted(
            (margin for margin in listed if margin.ends), key=lambda margin: margin.reached
        )
        if not ending:
            return None
        at_low = min(ending, key=lambda margin: margin.soonest)
        at_high = min(ending, key=lambda margin: margin.latest)
        high = at_high.latest
        first = tuple(m for m in ending if m is ending[0] or m.low <= high * (1.0 + TIED))
        lines = ("", "")
        if not (at_low.alone and at_high.alone):
            lines = (at_low.lines[0], at_high.lines[1])
        return cls(first, at_low.soonest, high, lines)

    @property
    def breaks(self) -> bool:
        """Return whether the body breaks at once."""
        return self.margins[0].breaks

    @property
    def words(self) -> tuple[str, ...]:
        """Return the words of the limits, each one once."""
        return tuple(dict.fromkeys(margin.word for margin in self.margins))

    @property
    def body(self) -> str:
        """Return the body that ends, or `pair` where that is not one body."""
        bodies = {margin.body for margin in self.margins}
        if len(bodies) == 1 and BOTH not in bodies:
            return bodies.pop()
        return "pair"

    @property
    def beyond(self) -> bool:
        """Return whether one of the lives lies beyond the S-N data."""
        return any(margin.beyond for margin in self.margins)
