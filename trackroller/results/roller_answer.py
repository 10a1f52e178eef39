"""The record of one solved roller: its first limit with its life, every limit with both ends, and
what was not checked.

Keys of `Answer.headline`: `low`, `high` (life to the first limit [h]), `ends` (words of the limits
that may come first), `body`, `line_low` and `line_high` (tests that both ends of a life by fatigue
follow from, '' where no other tests of the material bound it), `extrapolated`, `guessed`, `unknown`
(body whose hours are not known), `exceeded` and `broken` (lists of {limit, body, use [1], hours},
the worst one first), `open` (list of {limit, body}), `axial_low`, `axial_high`, `motor_low`,
`motor_high` (forces between which the roller rolls [N]), `not_judged` (reasons), `states` (of each
requirement: `met`, `open` or `missed`), `state` (of all of them; '' without a requirement).
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from trackroller.damage import LIMITS, checked_limits, limit_word, wear
from trackroller.damage.first_limit import STATES
from trackroller.damage.limit import OF_GUIDE
from trackroller.damage.wear import KM_PER_HOUR
from trackroller.errors import listing
from trackroller.fit.stored import StoredFit, fits_of_case
from trackroller.materials import Material
from trackroller.parameters import BODIES, PARAMETERS, REGIMES
from trackroller.parameters.carriage_fields import long_name_of
from trackroller.parameters.example import drive_question
from trackroller.results.answer import Answer, Caution, Column, FurtherTable, Required, yes_or_blank
from trackroller.results.case_columns import at_surface
from trackroller.results.fatigue_lines import lines_text
from trackroller.results.friction import friction_cautions
from trackroller.results.life_columns import FIRST_LIMIT, OF_PAIR
from trackroller.results.margins import First, Margin, lifeless_bodies, margins, worst_contact
from trackroller.results.placeholders import guess_cautions, placeholders_part
from trackroller.results.roller_lives import lives_part
from trackroller.results.subgroups import level_text
from trackroller.results.validity_flags import flags_of, not_judged
from trackroller.roller import stored_inputs as record
from trackroller.roller.dataset import VARIABLES, shown, solved_by
from trackroller.roller.duty import duty_of, strokes_of, years
from trackroller.roller.limit_notes import given_in_vain, lacks_of, notes_of
from trackroller.roller.output_names import PARTS, body_of
from trackroller.roller.regime_limits import Limits, limits
from trackroller.roller.requirement import requirement_of
from trackroller.roller.temperature import HEAD as OF_TEMPERATURE
from trackroller.roller.temperature import temperatures_of

# N, mm, MPa, 1: results below are rounding errors of a zero, as the drive torque of a free roller
ROUNDING = 1e-9
CODES = {  # code of the warning of a validity flag; of the others `flagged`
    "half_space": "not_judged",
    "conformal": "not_judged",
    "steep_friction": "not_judged",
    "yield": "not_held",
    "static": "not_held",
    "overheated": "not_held",
    "deep_life": "extrapolated",
    "worn": "worn",
}
# why a limit is not known
STOPPED = {"full_slip": "the roller skids", "lift_off": "a contact lifts off"}
# columns of doubt on each limit, of one load and of a spectrum
OF_ANY_LIMIT = (
    Column(
        "extrapolated",
        "Extrapolated",
        "",
        "whether the life lies beyond the data of its rule",
        "text",
    ),
    Column(
        "guessed",
        "Placeholder",
        "",
        "whether the limit rests on values that nobody has measured",
        "text",
    ),
    Column("model", "Model", "", "second model of an end that another limit has", "text"),
    Column(
        "line",
        "Tests",
        "",
        "tests that a life by fatigue follows from, at the low and at the high end; alone: the "
        "material has no others that count",
        "text",
    ),
)
COLUMNS = (
    Column(
        "limit",
        "Limit",
        "",
        "limit of the roller, of the guide or of the pair",
        "text",
        role="name",
    ),
    Column("body", "Body", "", "body that the limit concerns", "text", role="name"),
    Column(
        "state",
        "Verdict",
        "",
        "kept: below 100 % at both ends of the range; finite: a fatigue strength is exceeded, so "
        "that the life ends; exceeded: above 100 % at both ends; open: at one end; missed: the "
        "life is shorter than required",
        "state",
    ),
    Column(
        "value",
        "Now of at most",
        "",
        "value in this case, and the value that is permitted",
        "bounded",
        "permitted",
    ),
    Column(
        "used_low",
        "Used",
        "1",
        "value over the permitted value, at both ends of the placeholders",
        "share",
    ),
    Column(
        "low",
        "Life",
        "h",
        "hours until the limit is reached, at both ends of the placeholders",
        "life",
    ),
    Column(
        "hours",
        "Life at the values",
        "h",
        "hours until the limit is reached, at the values of the placeholders",
        "life",
    ),
    *OF_ANY_LIMIT,
    Column("bound", "What is permitted", "", "what the permitted value is", "text"),
    Column(
        "units", "Unit", "", "unit of the value and of the permitted value", "text", role="file"
    ),
    Column("least", "At least", "", "smallest permitted value", role="file"),
    Column("name", "Name", "", "name of the limit in data sets", "text", role="file"),
)
# upper end and role of these columns
RANGES = {"used_low": ("used_high", "use"), "low": ("high", "bar")}
YEARS = Column(
    "years_low",
    "Life in years",
    "years",
    "the same in years of the duty",
    until="years_high",
    role="file",
)


def answer_of_roller(ds: xr.Dataset, ranges: Limits | None = None) -> Answer:
    """Return the record of a solved case.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `trackroller.solve` for one case.
    ranges : Limits, optional
        Ranges of forces and friction in which the roller rolls; searched if not given.

    Raises
    ------
    InputError
        If `ds` is not the result of one case.
    """
    inputs = record.inputs_of(ds)
    ranges = ranges or limits(record.case_of_result(ds), str(ds.attrs["contact_model"]))
    materials = materials_of_case(ds, inputs)
    own = margins(ds, ranges, inputs, materials)
    required = _required(ds, inputs)
    first = First.of(own)
    return Answer(
        question="roller",
        kind=_kind(ds, own, first),
        headline=_headline(ds, own, first, ranges) | _states(ds, first, required),
        output=(FIRST_LIMIT[0], "life to the limit", "h"),
        table=_table(ds, own, required),
        columns=_columns(ds, own),
        required=required,
        parts=tuple(_parts(ds, inputs, materials)),
        not_checked=checks_left_out(ds),
        not_used=_not_used(ds),
        not_given=not_given_words(ds),
        warnings=tuple(warnings_of(ds, own, first)),
        facts=_facts(ds),
    )


def materials_of_case(ds: xr.Dataset, inputs: Mapping[str, Any]) -> dict[str, Material]:
    """Return the material of each body of a solved case, at its temperature."""
    stored = record.materials_of(ds)
    warm = temperatures_of(ds, inputs["ambient_temperature"])
    return {
        body: record.as_material(stored[f"{body}_material"]).at(at)
        for body, at in zip(BODIES, warm, strict=True)
    }


def facts_of_data(ds: xr.Dataset, **own: Any) -> dict[str, Any]:
    """Return the facts of the title line of a result that belongs to no study.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of a roller, a roller that wears, a spectrum or a carriage.
    **own
        Facts in place of the usual ones, and further ones.
    """
    return {
        "name": "",
        "description": "",
        "date": "",
        "cases": 1,
        "candidates": None,
        "conditions": None,
        "drawn": False,
        "models": [str(ds.attrs.get("contact_model", ""))],
        "accuracy": str(ds.attrs.get("accuracy", "")),
        "duty": duty_of(ds),
        "strokes": strokes_of(ds),
    } | own


def _facts(ds: xr.Dataset) -> dict[str, Any]:
    """Return the facts of the title line of one roller."""
    if "contact_model_used" in ds:
        used = str(solved_by(ds).item())
    else:
        used = str(ds.attrs["contact_model"])
    converged = True
    if "converged" in ds:
        converged = bool(int(ds["converged"]))
    reason = ""
    if "reason" in ds:
        reason = str(ds["reason"].item())
    return facts_of_data(
        ds,
        solved_by=used,
        probability=float(ds.attrs["failure_probability"]),
        regime=REGIMES[int(ds["regime"])],
        converged=converged,
        reason=reason,
    )


def _kind(ds: xr.Dataset, own: Sequence[Margin], first: First | None) -> str:
    """Return the answer in one word."""
    regime = REGIMES[int(ds["regime"])]
    if regime in ("lift_off", "failed"):
        return {"lift_off": "lifts_off"}.get(regime, regime)
    if any(margin.breaks for margin in own):
        return "breaks"
    if regime == "full_slip":
        return "skids"
    if first is None:
        return "no_life"
    return "lasts"


def _headline(
    ds: xr.Dataset, own: Sequence[Margin], first: First | None, ranges: Limits
) -> dict[str, Any]:
    """Return the numbers and names of the headline."""
    regime = REGIMES[int(ds["regime"])]
    skipped = {"full_slip": ("full_slip",), "lift_off": ("lift_off", "lift_off_friction")}.get(
        regime, ()
    )
    # the use of wear is a required travel over its life, which is a requirement
    checks = [one for one in own if one.name not in (*skipped, wear.LIMIT.name) and not one.breaks]
    over = [one for one in checks if one.state == "exceeded"]
    over.sort(key=lambda one: -np.nan_to_num(one.used, posinf=math.inf))
    unknown = any(
        m.timed and not m.beside and math.isnan(m.hours) and m.body == "guide" for m in own
    )
    unknown_body = ""
    if unknown:
        unknown_body = "guide"
    head: dict[str, Any] = {
        "low": math.nan,
        "high": math.nan,
        "ends": [],
        "body": "",
        "line_low": "",
        "line_high": "",
        "extrapolated": False,
        "guessed": False,
        "unknown": unknown_body,
        "broken": [_use(one) for one in own if one.breaks],
        "exceeded": [_use(one) for one in over],
        "open": [
            {"limit": one.word, "body": one.body}
            for one in checks
            if one.state == "open" and not one.beside
        ],
        "axial_low": ranges.axial_force[0],
        "axial_high": ranges.axial_force[1],
        "motor_low": ranges.motor_force[0],
        "motor_high": ranges.motor_force[1],
        "not_judged": not_judged(ds),
    }
    if first is None:
        return head
    head |= {"low": first.low, "high": first.high, "ends": list(first.words), "body": first.body}
    head |= dict(zip(("line_low", "line_high"), first.lines, strict=True))
    return head | {
        "extrapolated": first.beyond,
        "guessed": any(margin.guessed for margin in first.margins),
    }


def _states(ds: xr.Dataset, first: First | None, required: Sequence[Required]) -> dict[str, Any]:
    """Return whether each requirement is met, and whether all are."""
    states = [_state_of(ds, first, one) for one in required]
    worst = [state for state in ("missed", "open", "met") if state in states]
    state = ""
    if worst:
        state = worst[0]
    return {"states": states, "state": state}


def _state_of(ds: xr.Dataset, first: First | None, required: Required) -> str:
    """Return whether a requirement is met; that of the pair counts its life to the first limit."""
    if required.output not in OF_PAIR:
        state = str(_required_row(ds, required)["state"])
        return {"kept": "met", "exceeded": "missed"}.get(state, "open")
    if first is None:
        return "open"
    state = state_of_life(first.low, first.high, required.least)
    if math.isfinite(required.most) and state != "missed":
        shorter = state_of_life(-first.high, -first.low, -required.most)
        if state == "met":
            state = shorter
        else:
            state = {"missed": "missed"}.get(shorter, "open")
    return state


def state_of_life(low: float, high: float, least: float) -> str:
    """Return whether a life within a range reaches what is required."""
    if low >= least:
        return "met"
    if high < least:
        return "missed"
    return "open"


def _use(margin: Margin) -> dict[str, Any]:
    return {"limit": margin.word, "body": margin.body, "use": margin.used, "hours": margin.hours}


def _required(ds: xr.Dataset, inputs: Mapping[str, Any]) -> tuple[Required, ...]:
    """Return what is required of the roller: the key `requirement`, and the travel that wear has to
    allow. Of a required life and a travel the longer one counts, as in a study.
    """
    required = []
    for name, own in requirement_of(ds).items():
        if name in OF_PAIR:
            words, units = FIRST_LIMIT[1], "h"
        else:
            words, units = (PARTS[name].words, PARTS[name].variable.units)
        required.append(
            Required(name, words, units, own.least, own.most, own.probability, own.years)
        )
    travel = inputs.get("required_travel")
    if travel is not None and not math.isnan(float(travel)):
        hours = float(travel) / (KM_PER_HOUR * float(inputs["velocity"]))
        lives = [one for one in required if one.output in OF_PAIR and math.isfinite(one.least)]
        if all(one.least < hours for one in lives):
            required = [one for one in required if one not in lives]
            most = min((one.most for one in lives), default=math.inf)
            required.append(Required(*FIRST_LIMIT, least=hours, most=most))
    return tuple(required)


def _columns(ds: xr.Dataset, own: Sequence[Margin]) -> tuple[Column, ...]:
    """Return the columns of the table of limits; lives have years where the duty is known.

    The lives at the values of the placeholders are shown where they differ from the ends of their
    ranges.
    """
    apart = any(margin.low < margin.high for margin in own)
    columns = []
    for one in COLUMNS:
        until, role = RANGES.get(one.name, (one.until, one.role))
        if one.name == "hours" and not apart:
            role = "file"
        columns.append(Column(one.name, one.title, one.units, one.meaning, one.kind, until, role))
    if duty_of(ds):
        columns.append(YEARS)
    return tuple(columns)


def _table(ds: xr.Dataset, own: Sequence[Margin], required: Sequence[Required]) -> pd.DataFrame:
    """Return one row a limit, and one for each required output that is no life of the pair."""
    least = max([one.least for one in required if one.output in OF_PAIR], default=-math.inf)
    rows = [_row(margin, least) for margin in own]
    of_outputs = [_required_row(ds, one) for one in required if one.output not in OF_PAIR]
    rows = sorted([*rows, *of_outputs], key=lambda row: row["state"] != "exceeded")
    table = pd.DataFrame(
        rows, columns=[name for one in _columns(ds, own) for name in (one.name, one.until) if name]
    )
    duty = duty_of(ds)
    if duty:
        for name in ("low", "high"):
            table[f"years_{name}"] = [float(years(hours, duty)) for hours in table[name]]
    return table


def _row(margin: Margin, least: float) -> dict[str, Any]:
    """Return the row of a limit."""
    hours = margin.hours
    if margin.breaks:
        hours = 0.0
    model = ""
    if margin.beside:
        model = "second"
    elif margin.lifeless:
        model = "no fatigue life"
    state = margin.state
    if margin.ends and state != "exceeded" and math.isfinite(least):
        state_by_life = state_of_life(margin.soonest, margin.latest, least)
        if state_by_life != "met":
            state = state_by_life
    if margin.lifeless:
        state = "none"
    elif state == "kept" and margin.used > 1.0:
        state = "finite"
    return {
        "limit": margin.word,
        "body": margin.body,
        "state": state,
        "value": margin.value,
        "permitted": margin.permitted,
        "used_low": margin.used_low,
        "used_high": margin.used_high,
        "low": margin.soonest,
        "high": margin.latest,
        "hours": hours,
        "extrapolated": yes_or_blank(margin.beyond and not math.isnan(margin.hours)),
        "guessed": yes_or_blank(margin.guessed),
        "model": model,
        "line": lines_text(*margin.lines, margin.alone),
        "bound": margin.bound,
        "units": margin.units,
        "least": margin.least,
        "name": margin.name,
    }


def _required_row(ds: xr.Dataset, required: Required) -> dict[str, Any]:
    """Return the row of a required output; how much of it is used counts towards the nearer end."""
    value = math.nan
    if PARTS[required.output].variable.name in ds:
        value = float(PARTS[required.output].values(ds).item())
    used = _used_of(value, required)
    if math.isnan(value):
        state = "unknown"
    elif required.least <= value <= required.most:
        state = "kept"
    else:
        state = "exceeded"
    meaning = "required: at least"
    if math.isfinite(required.most):
        bound = required.most
        meaning = "required: at most"
    else:
        bound = required.least
    margin = Margin(
        required.output,
        required.words,
        "requirement",
        body_of(required.output) or "pair",
        value,
        bound,
        required.units,
        meaning,
        least=required.least,
        used=used,
        used_low=used,
        used_high=used,
        state=state,
    )
    return _row(margin, -math.inf)


def _used_of(value: float, required: Required) -> float:
    """Return the largest share that a value uses of a requirement's bounds [1]."""
    if math.isnan(value):
        return math.nan
    uses = []
    if math.isfinite(required.most):
        uses.append(_ratio(value, required.most))
    if math.isfinite(required.least):
        uses.append(_ratio(required.least, value))
    return max(uses, default=math.nan)


def _ratio(value: float, bound: float) -> float:
    if bound == 0:
        return math.inf
    return value / bound


QUANTITY = Column("quantity", "Quantity", "", "", "text", role="name")
UNIT = Column("units", "Unit", "", "", "text")
OF_CONTACTS = (
    QUANTITY,
    Column("contact_1", "Contact 1", "", "", "whole"),
    Column("contact_2", "Contact 2", "", "", "whole"),
    UNIT,
)
OF_ROLLER = (QUANTITY, Column("value", "Value", "", "", "whole"), UNIT)


def _parts(
    ds: xr.Dataset, inputs: Mapping[str, Any], materials: Mapping[str, Material]
) -> Iterable[FurtherTable]:
    """Yield the further tables of one roller: both contacts, the whole roller, and the lives by
    fatigue.
    """
    contacts = _contacts(ds)
    if not contacts.empty:
        yield FurtherTable("contacts", "Contacts", contacts, OF_CONTACTS)
    whole = quantities(ds, shown())
    if not whole.empty:
        yield FurtherTable("whole", "Slip, and loads on the bearing", whole, OF_ROLLER)
    lives = lives_part(ds, inputs, materials, lifeless_bodies(ds, materials))
    if lives is not None:
        yield lives
    guesses = placeholders_part(ds)
    if not guesses.table.empty:
        yield guesses


def _contacts(ds: xr.Dataset) -> pd.DataFrame:
    """Return one row a quantity of the contacts; none if a contact has lifted off."""
    names = ["quantity", "contact_1", "contact_2", "units"]
    if "normal_force" in ds and np.isnan(ds.variables["normal_force"].values).any():
        return pd.DataFrame(columns=names)
    lines = [
        (quantity_words(n), ds.variables[n].values, VARIABLES[n].units)
        for n in shown("contact")
        if n in ds
    ]
    if {"peak_stress", "peak_z"} <= set(ds):
        stated = ds[
            [
                "peak_stress",
                "peak_z",
                *(n for n in ("semi_axis_lateral", "semi_axis_rolling") if n in ds),
            ]
        ]
        # the place of a peak at the surface is rounding
        depth = stated["peak_z"].where(at_surface(stated) != 1, 0.0)
        for body in BODIES:
            peak = stated["peak_stress"].sel(body=body).values
            lines.append((f"peak stress of the {body} (von Mises)", peak, "MPa"))
            lines.append((f"depth of the peak in the {body}", depth.sel(body=body).values, "mm"))
    if "wear_depth_per_km" in ds:
        for body in BODIES:
            worn = 1e3 * ds["wear_depth_per_km"].sel(body=body).values
            lines.append((f"wear depth of the new {body} by travel", worn, "µm/km"))
    rows = [[words, *map(_without_rounding, values), units] for words, values, units in lines]
    return pd.DataFrame([row for row in rows if np.isfinite(row[1:3]).all()], columns=names)


def quantities(ds: xr.Dataset, names: Iterable[str]) -> pd.DataFrame:
    """Return one row for each finite one of some results, with its value and unit."""
    entries = [
        (n, _without_rounding(ds.variables[n].values), VARIABLES[n].units) for n in names if n in ds
    ]
    rows = [
        [quantity_words(name), value, units]
        for name, value, units in entries
        if math.isfinite(value)
    ]
    return pd.DataFrame(rows, columns=["quantity", "value", "units"])


def _without_rounding(value: Any) -> float:
    number = float(value)
    if abs(number) <= ROUNDING:
        return 0.0
    return number


def quantity_words(name: str) -> str:
    """Return the name of a result without remarks, and its symbol if that is no formula."""
    words = str(VARIABLES[name].long_name).partition(",")[0]
    symbol = VARIABLES[name].symbol
    if symbol.replace("_", "").isalnum():
        return f"{words} {symbol}"
    return words


def checks_left_out(ds: xr.Dataset, known: Collection[str] = ()) -> dict[str, tuple[str, ...]]:
    """Return the limits that were not checked for each body, each with what it lacks in brackets.

    Limits in `known` are checked by other values than those of the result.
    """
    if ds["regime"].ndim == 0 and REGIMES[int(ds["regime"])] == "failed":
        return {}
    checks: dict[str, list[str]] = {body: [] for body in BODIES}
    for limit in (one for one in checked_limits() if one.name not in known):
        for body in limit.bodies:
            why = ", ".join(_missing(ds, limit.name, body))
            if not _is_known(ds, limit.name, body):
                if why:
                    words = f"{limit.word} ({why})"
                else:
                    words = limit.word
                checks[body].append(words)
            elif why and _lacks_hours(ds, limit.name, body):
                checks[body].append(f"hours of {limit.word} ({why})")
    return {body: tuple(words) for body, words in checks.items()}


def _is_known(ds: xr.Dataset, name: str, body: str) -> bool:
    """Return whether a limit is checked for a body of one case, or of each block of a spectrum."""
    if "limit_state" in ds:
        if name not in ds["limit"].values.tolist():
            return False
        return bool(ds["limit_state"].sel(limit=name, body=body) != STATES.index("unknown"))
    values = {"static": "peak_stress", "fatigue": f"{body}_life_hours"}.get(name, "")
    if values not in ds:
        return False
    if "body" in ds[values].dims:
        own = ds[values].sel(body=body)
    else:
        own = ds[values]
    return bool(own.notnull().any())


def _lacks_hours(ds: xr.Dataset, name: str, body: str) -> bool:
    """Return whether a limit that has hours has a use alone."""
    lives = any(variable.units in ("h", "km") for variable in LIMITS[name].results)
    return (
        lives
        and "life_hours_by_limit" in ds
        and bool(ds["life_hours_by_limit"].sel(limit=name, body=body).isnull())
    )


def _missing(ds: xr.Dataset, name: str, body: str) -> list[str]:
    """Return what a limit lacks for a body."""
    limits = str(ds.attrs.get("limits", "")).split()
    if "limit_state" in ds and limits and name not in limits:
        return ["left out"]
    material = material_name(ds, body)
    regime = ""
    if ds["regime"].ndim == 0:
        regime = REGIMES[int(ds["regime"])]
    words_of_lacks = []
    for lack in (lack for lack in lacks_of(ds) if lack.limit == name):
        of_guide = not lack.material and lack.name in OF_GUIDE
        if of_guide and (body != "guide" or regime in STOPPED):
            continue
        if lack.material and material and lack.material != material:
            continue
        if lack.material:
            words = lack.words
        else:
            words = f"give {lack.name}"
        words_of_lacks.append(words)
    if not words_of_lacks and regime in STOPPED:
        return [STOPPED[regime]]
    return words_of_lacks


def material_name(ds: xr.Dataset, body: str) -> str:
    """Return the name of the material of a body; '' if the result does not store it."""
    if record.MATERIALS not in ds.attrs:
        return ""
    return str(record.materials_of(ds).get(f"{body}_material", {}).get("name", ""))


def unchecked(ds: xr.Dataset) -> list[str]:
    """Return the names of the limits that were checked for neither body."""
    return [
        limit.name
        for limit in checked_limits()
        if not any(_is_known(ds, limit.name, body) for body in limit.bodies)
    ]


def _not_used(ds: xr.Dataset) -> dict[str, str]:
    """Return the values that were given for limits which were not checked, and for nothing else."""
    if record.CASE not in ds.attrs or "limit_state" not in ds:
        return {}
    idle = given_in_vain(record.inputs_of(ds), unchecked(ds))
    unknown = record.names_not_given(ds.attrs)
    return {
        name: f"needed by {listing([limit_word(one) for one in users])}"
        for name, users in idle.items()
        if name not in unknown
    }


def not_given_words(ds: xr.Dataset) -> dict[str, str]:
    """Return the values that nobody gave, with their units."""
    given = record.not_given_of(ds)
    known = {name: value for name, value in given.items() if value is not None and value == value}
    return {name: level_text(name, value) for name, value in known.items()}


def warnings_of(ds: xr.Dataset, own: Sequence[Margin], first: First | None) -> Iterable[Caution]:
    """Yield the warnings of one roller: second models, flags with their remedies, guesses, doubts,
    values not given.
    """
    yield from _second_models(own, first)
    for flag in flags_of(ds):
        yield _caution(CODES.get(flag.name, "flagged"), f"{flag.sentence} {flag.remedy}")
    yield from (_caution("extrapolated", text) for text in beyond_tests(ds))
    yield from guess_cautions(placeholders_part(ds))
    yield from friction_cautions(ds.attrs)
    yield from (
        _caution("flagged", note) for note in notes_of(ds) if note.startswith(OF_TEMPERATURE)
    )
    given = record.not_given_of(ds)
    yield from (_caution("doubtful", text) for text in record.doubts_of(ds))
    question = drive_question(given, set(PARAMETERS) - set(given))
    if question:
        yield _caution("not_given", question)
    words = not_given_words(ds)
    if words:
        yield _caution(
            "not_given", ", ".join(f"{long_name_of(name)} {value}" for name, value in words.items())
        )


def _caution(code: str, where: str) -> Caution:
    return Caution(code, 1, 1, where, what="")


def _second_models(own: Sequence[Margin], first: First | None) -> Iterable[Caution]:
    """Yield the second models that are exceeded, or reached before the first limit."""
    for margin in own:
        sooner = not math.isnan(margin.hours) and (first is None or margin.high < first.low)
        if margin.beside and (margin.state == "exceeded" or sooner):
            used = f"{margin.word} of the {margin.body}: {100 * margin.used:.3g} % used"
            yield _caution("second_model", f"{used}{_hours_text(margin)}")


def _hours_text(margin: Margin) -> str:
    """Return the hours to a limit with both ends of their range; an empty text where they are not
    known.
    """
    if math.isnan(margin.hours):
        return ""
    ends = dict.fromkeys((rounded_text(margin.low), rounded_text(margin.high)))
    return f", {' to '.join(ends)} h"


def rounded_text(value: float) -> str:
    """Return a number with three figures, as a warning states it."""
    return f"{float(f'{value:.3g}'):,g}"


def beyond_tests(ds: xr.Dataset) -> list[str]:
    """Return what tests do not tell of the lives by fatigue of a solved case; [] for materials that
    were not fitted.
    """
    fits, others = fits_of_case(ds)
    texts = [
        f"The values of {name} hold for {options} alone: solve with it, or fit the tests anew."
        for name, options in others.items()
    ]
    return [*texts, *filter(None, (_beyond(ds, body, fit) for body, fit in fits.items()))]


def _beyond(ds: xr.Dataset, body: str, fit: StoredFit) -> str:
    """Say that the life of a body lies beyond the tests; '' where it does not."""
    stress, cycles = worst_contact(ds, body, fit)
    if not (stress > 0 and fit.extrapolates(stress, cycles)):
        return ""
    low, high, longest = fit.tested
    tests = f"tests from {low:.3g} to {high:.3g} MPa and up to {longest:.2g} cycles"
    return f"life of the {body}: {stress:.3g} MPa and {cycles:.2g} cycles, {tests}"
