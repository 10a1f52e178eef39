"""The record of a carriage: its worst roller with the life, every roller, the loads, and the
margins of the load cases.

Keys of `Answer.headline`: `roller` (the worst one, or the one with the largest radial force),
`case` (that does most of its damage, or has that force), `part` (of the damage by that case [1]),
`low`, `high` [h], `line_low` and `line_high` (tests that both ends of a life by fatigue follow
from), `km` [km], `at_most` (bound of its life where the damage of some cases is not known [h]),
`not_on_both` (cases in which it does not roll on both contacts, with the regime),
`body` (`roller` or `guide`) and `limit` (in words) that end it,
`force` (largest radial force [N]), `unknown` (rollers whose life is not known), `unknown_in` (load
cases in which these do not roll on both contacts), `unsettled` (load cases without forces),
`margins` (list of {of, end, times, case, tipping}: the first end of the
payload and of all loads), `exceeded` (list of {limit, body, roller, use [1], hours, km}, the worst
one first), `not_judged` (reasons why the model does not judge the worst roller), `state` (of the
required life: `met`, `open`, `missed`, or '' without one) and `of` (rollers that have this state,
where others have another one).
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from trackroller.damage import LIMITS, catalogue, checked_limits, limit_word, wear
from trackroller.damage.first_limit import STATES
from trackroller.parameters import BODIES, MATERIAL_FIELDS, REGIME_LABELS, REGIMES
from trackroller.parameters.carriage_fields import long_name_of
from trackroller.parameters.validity import VALIDITY
from trackroller.results.answer import Answer, Caution, Column, FurtherTable, Required
from trackroller.results.fatigue_lines import line_of
from trackroller.results.friction import friction_cautions
from trackroller.results.life_columns import EVIDENCE, FIRST_LIMIT
from trackroller.results.placeholders import guess_cautions, placeholders_part
from trackroller.results.roller_answer import (
    CODES,
    checks_left_out,
    facts_of_data,
    rounded_text,
    state_of_life,
)
from trackroller.results.spectrum_answer import not_given_values
from trackroller.results.validity_flags import OUTSIDE
from trackroller.roller.dataset import validity_bit
from trackroller.roller.duty import strokes_words
from trackroller.roller.stored_inputs import MATERIALS, doubts_of

LOADS = {"payload": "payload", "loads": "all loads"}  # parts of the loads that a margin multiplies
ENDS = {"one_contact": "one contact", "lift_off": "lift-off", "tipping": "tipping"}
ROLLING = REGIMES.index("rolling")
COLUMNS = (
    Column("roller", "Roller", "", "roller of the carriage", "text", role="name"),
    Column(
        "state",
        "Verdict",
        "",
        "whether the life reaches what the file of the roller requires",
        "state",
    ),
    Column(
        "low",
        "Life",
        "h",
        "hours of travel to the first limit of the roller or its rail",
        "life",
        "high",
        "bar",
    ),
    Column(
        "required",
        "Required",
        "h",
        "life that the file of the roller requires",
        "life",
        role="file",
    ),
    Column(
        "hours",
        "Life at the values",
        "h",
        "the same at the values of the placeholders",
        "life",
        role="file",
    ),
    Column(
        "at_most",
        "At most",
        "h",
        "bound by the load cases whose damage is known, where that of others is not",
    ),
    Column("km_low", "Travel", "km", "the same life as travel of the carriage", until="km_high"),
    Column(
        "years_low",
        "Years",
        "",
        "the same life in years of the duty, from one year on",
        "years",
        "years_high",
    ),
    Column("km", "Travel at the values", "km", "at the values of the placeholders", role="file"),
    Column("years", "Years at the values", "", "of the same travel", "years", role="file"),
    Column(
        "ends",
        "Ended by",
        "",
        "the limit that is reached first, and the body that reaches it",
        "text",
    ),
    Column(
        "case",
        "Load case",
        "",
        "load case with the largest part of the damage, or the largest force",
        "text",
    ),
    Column("part", "Its part", "1", "part of the damage that this load case does", "share"),
    Column("force", "Largest radial force", "N", "that presses the roller on its rail", "whole"),
    Column("lifted", "Lifted in", "", "load cases in which the roller carries no load", "text"),
    Column(
        "lifted_share", "of the travel", "1", "share of the travel of these load cases", "share"
    ),
    Column(
        "one_contact",
        "Not on both contacts in",
        "",
        "load cases in which a contact carries no load",
        "text",
    ),
    Column("factor", "Load factor", "1", "largest load factor of the maker's catalogue"),
    Column("catalogue_km", "By the catalogue", "km", "life by the maker's catalogue"),
    Column(
        "exceeded",
        "Exceeded",
        "",
        "limits that the roller or its rail exceeds, with the largest use",
        "text",
    ),
)
OF_LOADS = (
    Column("case", "Load case", "", "", "text", role="name"),
    Column("roller", "Roller", "", "", "text", role="name"),
    Column("radial", "Radial force", "N", "below 0 it presses the roller on its rail", "whole"),
    Column("axial", "Axial force", "N", "acts on the roller along its own axis x_R", "whole"),
    Column("regime", "Regime", "", "", "text"),
    Column("hours", "Life under it alone", "h", "life if this load case lasted", "life"),
    Column("factor", "Load factor", "1", "of the maker's catalogue", "whole"),
)
OF_CASES = (
    Column("case", "Load case", "", "", "text", role="name"),
    Column("share", "Share", "1", "share of the travel", "share"),
    Column("drive", "Drive", "N", "force of the drive along the track", "whole"),
    *(
        Column(
            f"{part}_{end}",
            f"{words} to {ends}",
            "1",
            f"multiplier of {words} that leads to {ends}",
            "whole",
        )
        for part, words in LOADS.items()
        for end, ends in ENDS.items()
    ),
    Column(
        "settled", "Settled", "", "whether a state of the rollers fulfils all conditions", "text"
    ),
)
MASSES = (
    Column("name", "Mass", "", "", "text", role="name"),
    Column("mass", "Mass", "kg", "", "whole"),
    *(Column(axis, axis, "mm", "place", "whole") for axis in "xyz"),
)
PLACES = (
    Column("roller", "Roller", "", "", "text", role="name"),
    *(Column(f"at_{axis}", f"at {axis}", "mm", "place", "whole") for axis in "xyz"),
    *(
        Column(
            f"pushes_{axis}", f"pushes {axis}", "1", "direction of its load on the rail", "whole"
        )
        for axis in "xyz"
    ),
    *(Column(f"axis_{axis}", f"x_R {axis}", "1", "axis of the roller", "whole") for axis in "xyz"),
    Column("locating", "Locating", "", "whether it carries axial load", "text"),
)
OF_MARGINS = (
    "A margin is a multiplier of the payload, or of all loads, with the same preload; ∞ is not up "
    "to 1000. One contact: the axial force lifts the other contact of a roller; friction may do so "
    "earlier. The model ends there: later margins are not stated (–)."
)


def answer_of_carriage(ds: xr.Dataset) -> Answer:
    """Return the record of a carriage.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `trackroller.carriage`.
    """
    table = _table(ds)
    guesses = placeholders_part(ds)
    known = [one for one in COLUMNS if one.name == "roller" or not _is_empty(table[one.name])]
    parts = list(_parts(ds))
    if not guesses.table.empty:
        parts.append(guesses)
    return Answer(
        question="carriage",
        kind=_kind(ds),
        headline=_headline(ds, table),
        output=(FIRST_LIMIT[0], "life to the first limit", "h"),
        table=table,
        columns=tuple(known),
        required=_required(table),
        parts=tuple(parts),
        not_checked=_not_checked(ds),
        not_given=not_given_values(ds),
        warnings=(*_warnings(ds), *guess_cautions(guesses), *_not_given(ds)),
        facts=facts_of_data(
            ds,
            name=str(ds.attrs["title"]),
            description=str(ds.attrs.get("description", "")),
            cases=ds.sizes["load_case"],
            counted="load cases",
            models=[],
            accuracy="",
            probability=float(ds.attrs.get("failure_probability", math.nan)),
        ),
    )


def worst_place(ds: xr.Dataset) -> tuple[str, str]:
    """Return the worst roller and the load case with most of its damage, or those of the largest
    radial force.
    """
    worst = ds.attrs.get("worst_roller")
    if worst:
        damage = ds["damage_per_km"].sel(roller=worst).values
        return str(worst), str(ds["load_case"].values[int(np.nanargmax(damage))])
    pressed = np.nan_to_num(ds["radial_force"].values, nan=0.0)
    i, j = np.unravel_index(int(np.argmin(pressed)), pressed.shape)
    return str(ds["roller"].values[j]), str(ds["load_case"].values[i])


def _is_empty(column: pd.Series) -> bool:
    return bool((column.isna() | (column == "")).all())


def _kind(ds: xr.Dataset) -> str:
    """Return the answer in one word."""
    if not ds["converged"].values.all():
        return "unsettled"
    if "life_km" not in ds:
        return "forces"
    if ds.attrs.get("worst_roller"):
        return "lasts"
    unloaded = bool((ds["radial_force"] == 0).all())
    if unloaded or not np.isnan(ds["life_km"].values).any():
        return "unlimited"
    return "no_life"


def _headline(ds: xr.Dataset, table: pd.DataFrame) -> dict[str, Any]:
    """Return the numbers and names of the headline."""
    roller, case = worst_place(ds)
    unknown = _rollers_without_life(ds)
    head: dict[str, Any] = {
        "roller": roller,
        "case": case,
        "part": math.nan,
        "low": math.nan,
        "high": math.nan,
        "at_most": math.nan,
        "not_on_both": "",
        "km": math.nan,
        "km_low": math.nan,
        "km_high": math.nan,
        "body": "",
        "limit": "",
        "line_low": "",
        "line_high": "",
        "force": _largest_force(ds),
        "unknown": unknown,
        "unknown_in": _lost_in(ds, unknown),
        "without_file": [name for name in ds.attrs.get("without_case", "").split(", ") if name],
        "unsettled": ds["load_case"].values[~ds["converged"].values].tolist(),
        "margins": list(_first_margins(ds)),
        "exceeded": sorted(_exceeded(ds), key=lambda one: -one["use"]),
        "not_judged": [],
    }
    head |= _judged(table)
    if ds.attrs.get("worst_roller"):
        head |= _life_of_worst(ds, roller, case)
        first = table[table["roller"] == roller].iloc[0]
        head |= {key: float(first[key]) for key in ("km", "km_low", "km_high")}
    return head


def _largest_force(ds: xr.Dataset) -> float:
    """Return the largest radial force that presses a roller on its rail [N], NaN if none is
    known.
    """
    forces = ds["radial_force"].values
    if np.isfinite(forces).any():
        return -float(np.nanmin(forces))
    return math.nan


def _rollers_without_life(ds: xr.Dataset) -> list[str]:
    """Return the rollers whose life is not known; none without lives."""
    names: list[str] = []
    if "life_km" in ds:
        names = ds["roller"].values[np.isnan(ds["life_km"].values)].tolist()
    return names


def _life_of_worst(ds: xr.Dataset, roller: str, case: str) -> dict[str, Any]:
    """Return the life of the worst roller with its range and what ends it, and the part of the
    damage that its worst load case does.
    """
    own = ds.sel(roller=roller)
    bound = _bound(own)
    part = math.nan
    if math.isnan(bound):
        damage = own["damage_per_km"]
        part = float(damage.sel(load_case=case) / damage.sum())
    line_low, line_high = _lines_of(ds, own)
    flags = int(np.bitwise_or.reduce(own["roller_validity"].values.astype(int)))
    return {
        "part": part,
        "low": float(own["life_hours_low"]),
        "high": float(own["life_hours_high"]),
        "at_most": bound,
        "not_on_both": _beside_rolling(own),
        "body": str(own["first_body"].item()),
        "limit": limit_word(str(own["first_limit"].item())),
        "line_low": line_low,
        "line_high": line_high,
        "not_judged": [words for name, words in OUTSIDE.items() if flags & validity_bit(name)],
    }


def _lost_in(ds: xr.Dataset, rollers: Sequence[str]) -> str:
    """Return the load cases in which some rollers do not roll on both contacts, with the regime."""
    texts = [_beside_rolling(ds.sel(roller=roller)) for roller in rollers]
    return "; ".join(dict.fromkeys(filter(None, texts)))


def _bound(own: xr.Dataset) -> float:
    """Return the largest life of a roller whose life is not known [h]; NaN of one that is known,
    and without a bound.
    """
    if "life_hours_at_most" not in own or math.isinf(own["life_hours_at_most"]):
        return math.nan
    return float(own["life_hours_at_most"])


def _lines_of(ds: xr.Dataset, own: xr.Dataset) -> tuple[str, str]:
    """Return the tests that both ends of the life of a roller follow from; '' where its first limit
    is not fatigue, or no other tests of the material bound it.
    """
    body = str(own["first_body"].item())
    name = str(own["first_limit"].item())
    others = [limit for limit in EVIDENCE if LIMITS[limit].evidence_of == name]
    if "life_hours_by_limit_low" not in own or not others or not body:
        return "", ""
    hours = own.sel(body=body)
    if np.isnan(hours["life_hours_by_limit"].sel(limit=others).values).all():
        return "", ""
    stored = json.loads(str(ds.attrs.get(MATERIALS, "{}"))).values()
    label = str(own[f"{body}_material"].item())
    material: dict[str, Any] = next((one for one in stored if one.get("name") == label), {})
    lines = []
    for end, nearest in (("low", np.nanargmin), ("high", np.nanargmax)):
        lives = hours[f"life_hours_by_limit_{end}"].sel(limit=[name, *others]).values
        lines.append(line_of([name, *others][int(nearest(lives))], material))
    return lines[0], lines[1]


def _first_margins(ds: xr.Dataset) -> Iterator[dict[str, Any]]:
    """Yield the smallest multiplier of the payload, and of all loads, up to which all rollers roll
    on both contacts.
    """
    for part, words in LOADS.items():
        if f"{part}_to_lift_off" not in ds:  # the forces alone
            continue
        contact = ds[f"{part}_to_one_contact"].values
        lift_off = ds[f"{part}_to_lift_off"].values
        before = contact < lift_off  # beyond one contact the model has ended
        first = np.where(before, contact, lift_off)
        if not np.isfinite(first).any():
            continue
        place = int(np.nanargmin(first))
        end = "lift-off"
        if before[place]:
            end = "one contact"
            tipping = math.nan
        else:
            tipping = float(ds[f"{part}_to_tipping"].values[place])
        yield {
            "of": words,
            "end": end,
            "times": float(first[place]),
            "case": str(ds["load_case"].values[place]),
            "tipping": tipping,
        }


def _required(table: pd.DataFrame) -> tuple[Required, ...]:
    """Return the life that is required of the rollers with the worst state; () without a
    requirement.
    """
    required = table["required"][table["state"] == _judged(table)["state"]]
    if required.isna().all():
        return ()
    return (Required(*FIRST_LIMIT, least=float(required.max())),)


def _judged(table: pd.DataFrame) -> dict[str, Any]:
    """Return the worst state of the rollers, and which rollers have it where others have another
    one.
    """
    states = table["state"]
    worst = next((state for state in ("missed", "open", "met") if (states == state).any()), "")
    alike = (states == worst).all() or not worst
    if alike:
        worst_rollers = []
    else:
        worst_rollers = table["roller"][states == worst].tolist()
    return {"state": worst, "of": worst_rollers}


def _exceeded(ds: xr.Dataset) -> Iterator[dict[str, Any]]:
    """Yield each limit that a roller or its rail exceeds; the first limit of a roller that breaks
    is its end.
    """
    for roller in map(str, ds["roller"].values):
        own = ds.sel(roller=roller)
        for name, body, used, hours in _limits_of(own, "exceeded"):
            if name != wear.LIMIT.name and not (
                own["life_hours"] == 0 and own["first_limit"] == name
            ):
                yield _use(roller, name, body, used, hours, math.nan)
        factor, km = _by_catalogue(own)
        if factor > 1:
            yield _use(roller, catalogue.LIMIT.name, "roller", factor, math.nan, km)


def _use(roller: str, name: str, body: str, used: float, hours: float, km: float) -> dict[str, Any]:
    return {
        "limit": limit_word(name),
        "body": body,
        "roller": roller,
        "use": used,
        "hours": hours,
        "km": km,
    }


def _limits_of(own: xr.Dataset, state: str = "") -> Iterator[tuple[str, str, float, float]]:
    """Yield name, body, use and hours of the limits of a roller, or of those with a state alone."""
    if "limit_state" not in own:
        return
    for limit in checked_limits():
        for body in limit.bodies:
            at = own.sel(limit=limit.name, body=body)
            if not state or int(at["limit_state"]) == STATES.index(state):
                yield limit.name, body, float(at["utilisation"]), float(at["life_hours_by_limit"])


def _by_catalogue(own: xr.Dataset) -> tuple[float, float]:
    """Return the largest load factor of a roller by its maker's catalogue, and its life [km]; NaN
    without them.
    """
    if "load_factor" not in own or own["load_factor"].isnull().all():
        return math.nan, math.nan
    return float(own["load_factor"].max()), float(own["catalogue_life_km"])


def _not_checked(ds: xr.Dataset) -> dict[str, tuple[str, ...]]:
    """Return the limits that were not checked by body; where only some of the loaded rollers lack
    one, with these.
    """
    loaded = [
        str(one) for one in ds["roller"].values if (ds["radial_force"].sel(roller=one) < 0).any()
    ]
    if "limit_state" not in ds or not loaded:
        return {}
    lacking: dict[str, dict[str, list[str]]] = {body: {} for body in BODIES}
    for roller in loaded:
        own = ds.sel(roller=roller).rename(roller_regime="regime")
        names = {field: {"name": str(own[field].item())} for field in MATERIAL_FIELDS}
        known = []
        if not math.isnan(_by_catalogue(own)[0]):
            known = [catalogue.LIMIT.name]  # the limit by the catalogue is that of the carriage
        own = own.assign_attrs({MATERIALS: json.dumps(names)})
        for body, limits in checks_left_out(own, known).items():
            for words in limits:
                lacking[body].setdefault(words, []).append(roller)
    not_checked: dict[str, tuple[str, ...]] = {}
    for body, rollers_by_limit in lacking.items():
        texts = []
        for words, rollers in rollers_by_limit.items():
            if rollers != loaded:
                words = f"{', '.join(rollers)}: {words}"
            texts.append(words)
        not_checked[body] = tuple(texts)
    return not_checked


def _not_given(ds: xr.Dataset) -> Iterator[Caution]:
    """Yield the values of the rollers that nobody gave."""
    words = not_given_values(ds)
    if words:
        text = ", ".join(f"{long_name_of(name)} {value}" for name, value in words.items())
        yield Caution("not_given", 1, 1, text, "")


def _table(ds: xr.Dataset) -> pd.DataFrame:
    """Return one row a roller in the order in which they fail, those of unknown life last."""
    rows = [_row(ds, str(name)) for name in ds["roller"].values]
    worst = worst_place(ds)[0]
    rows.sort(key=lambda row: (row["roller"] != worst, _life_or_never(row)))
    return pd.DataFrame(
        rows, columns=[name for one in COLUMNS for name in (one.name, one.until) if name]
    )


def _life_or_never(row: Mapping[str, Any]) -> float:
    """Return the low end of the life of a roller [h]; infinity where it is not known."""
    low = float(row["low"])
    if math.isnan(low):
        return math.inf
    return low


def _row(ds: xr.Dataset, roller: str) -> dict[str, Any]:
    """Return the row of a roller."""
    own = ds.sel(roller=roller)
    forces = own["radial_force"].values
    cases = ds["load_case"].values
    lifted = forces == 0
    case, part = _worst_case(ds, roller)
    row: dict[str, Any] = {
        "roller": roller,
        "case": case,
        "part": part,
        "lifted": ", ".join(cases[lifted]),
    }
    row["force"] = math.nan
    if np.isfinite(forces).any():
        row["force"] = -float(np.nanmin(forces))
    row["lifted_share"] = math.nan
    if lifted.any():
        row["lifted_share"] = float(ds["share"].values[lifted].sum())
    row["one_contact"] = _beside_rolling(own)
    numbers = {
        "low": "life_hours_low",
        "high": "life_hours_high",
        "hours": "life_hours",
        "km": "life_km",
    }
    numbers |= {"years": "life_years", "catalogue_km": "catalogue_life_km"}
    row |= {key: float(own[name]) if name in own else math.nan for key, name in numbers.items()}
    row |= _ends_of_travel(row)
    row["at_most"] = _bound(own)
    row["ends"] = _end_of(own)
    row["factor"] = _by_catalogue(own)[0]
    row["required"] = math.nan
    if "required_hours" in own:
        row["required"] = float(own["required_hours"])
    if math.isnan(row["required"]):
        row["state"] = ""
    else:
        row["state"] = state_of_life(
            row["low"], np.fmin(row["high"], row["at_most"]), row["required"]
        )
    over = [
        f"{limit_word(name)} of the {body} ({100 * used:.3g} %)"
        for name, body, used, _ in _limits_of(own, "exceeded")
    ]
    row["exceeded"] = ", ".join(over)
    return row


def _ends_of_travel(life: Mapping[str, Any]) -> dict[str, float]:
    """Return both ends of a life as travel [km] and in years of the duty.

    Travel and years go with the hours. Where the hours at the values are not finite, neither of
    their ratios is known, and an end is that of the values.
    """
    ends = {}
    for key in ("km", "years"):
        for end in ("low", "high"):
            ends[f"{key}_{end}"] = life[key]
            if math.isfinite(life["hours"]) and life["hours"] > 0:
                ends[f"{key}_{end}"] = life[key] * (life[end] / life["hours"])
    return ends


def _end_of(own: xr.Dataset) -> str:
    """Return the limit that a roller or its rail reaches first, and the body; '' where it is not
    known.
    """
    if "first_limit" not in own or not str(own["first_limit"].item()):
        return ""
    return f"{limit_word(str(own['first_limit'].item()))} of the {own['first_body'].item()}"


def _worst_case(ds: xr.Dataset, roller: str) -> tuple[str, float]:
    """Return the load case with most of the damage of a roller, and this part; or that with its
    largest force.
    """
    own = ds.sel(roller=roller)
    if "damage_per_km" in own and float(np.nansum(own["damage_per_km"].values)) > 0:
        damage = np.nan_to_num(own["damage_per_km"].values, posinf=math.inf)
        place = int(np.argmax(damage))
        part = math.nan
        if math.isfinite(damage[place]):
            part = float(damage[place] / damage.sum())
        return str(ds["load_case"].values[place]), part
    forces = np.nan_to_num(own["radial_force"].values)
    place = int(np.argmin(forces))
    worst_case = ""
    if forces[place] < 0:
        worst_case = str(ds["load_case"].values[place])
    return worst_case, math.nan


def _beside_rolling(own: xr.Dataset) -> str:
    """Return the load cases in which a roller does not roll on both contacts, with the regime."""
    if "roller_regime" not in own:
        return ""
    names: dict[str, list[str]] = {}
    for code, case in zip(
        own["roller_regime"].values.tolist(), own["load_case"].values, strict=True
    ):
        if code not in (-1, ROLLING):
            names.setdefault(REGIME_LABELS[code], []).append(str(case))
    return "; ".join(f"{', '.join(cases)} ({regime})" for regime, cases in names.items())


def _parts(ds: xr.Dataset) -> Iterator[FurtherTable]:
    """Yield the further tables of a carriage: loads, load cases with their margins, masses, and
    places.
    """
    loads = pd.DataFrame(list(_loads(ds)), columns=[one.name for one in OF_LOADS])
    columns = tuple(one for one in OF_LOADS if not _is_empty(loads[one.name]) or one.role)
    yield FurtherTable("loads", "Loads of the rollers", loads, columns, strokes_words(ds))
    cases = pd.DataFrame(list(_cases(ds)), columns=[one.name for one in OF_CASES])
    shown = tuple(one for one in OF_CASES if "_to_" not in one.name or f"{one.name}" in ds)
    yield FurtherTable("cases", "Load cases and margins", cases, shown, OF_MARGINS)
    masses = [
        [str(name), float(value), *map(float, at)]
        for name, value, at in zip(
            ds["mass_name"].values, ds["mass"].values, ds["mass_at"].values, strict=True
        )
    ]
    yield FurtherTable(
        "masses", "Masses", pd.DataFrame(masses, columns=[one.name for one in MASSES]), MASSES
    )
    places = [
        [str(name), *np.round(np.concatenate(own), 9).tolist(), "yes" if locates else "no"]
        for name, locates, *own in zip(
            ds["roller"].values,
            ds["locating"].values,
            *(ds[f"roller_{key}"].values for key in ("at", "pushes", "axis")),
            strict=True,
        )
    ]
    yield FurtherTable(
        "places",
        "Places and directions",
        pd.DataFrame(places, columns=[one.name for one in PLACES]),
        PLACES,
    )


def _loads(ds: xr.Dataset) -> Iterator[dict[str, Any]]:
    """Yield the forces of each roller in each load case."""
    for case in ds["load_case"].values:
        for roller in ds["roller"].values:
            own = ds.sel(load_case=case, roller=roller)
            lifted = float(own["radial_force"]) == 0
            regime = ""
            if "roller_regime" in own:
                if lifted:
                    regime = "lifted"
                else:
                    regime = REGIME_LABELS[int(own["roller_regime"])]
            row = {
                "case": str(case),
                "roller": str(roller),
                "regime": regime,
                "radial": float(own["radial_force"]),
            }
            row["axial"] = float(own["axial_force"])
            row["hours"] = math.nan
            if "case_life_hours" in own and not lifted:
                row["hours"] = float(own["case_life_hours"])
            row["factor"] = math.nan
            if "load_factor" in own:
                row["factor"] = float(own["load_factor"])
            yield row


def _cases(ds: xr.Dataset) -> Iterator[dict[str, Any]]:
    """Yield share, drive and margins of each load case; margins later than one contact are not
    stated.
    """
    for case in ds["load_case"].values:
        own = ds.sel(load_case=case)
        row = {"case": str(case), "share": float(own["share"]), "drive": float(own["drive_force"])}
        row["settled"] = "no"
        if bool(own["converged"]):
            row["settled"] = "yes"
        for part in LOADS:
            row |= _margins_of(own, part)
        yield row


def _margins_of(own: xr.Dataset, part: str) -> dict[str, float]:
    """Return the multipliers of a part of the loads in one load case."""
    if f"{part}_to_lift_off" not in own:
        return {f"{part}_{end}": math.nan for end in ENDS}
    margins = {end: float(own[f"{part}_to_{end}"]) for end in ENDS}
    if margins["one_contact"] < margins["lift_off"]:
        margins |= {"lift_off": math.nan, "tipping": math.nan}
    return {f"{part}_{end}": value for end, value in margins.items()}


def _warnings(ds: xr.Dataset) -> Iterator[Caution]:
    """Yield what a user has to know of forces, rollers without load, contacts, flags and unusual
    values.
    """
    rollers = ds["roller"].values
    cases = ds["load_case"].values[~ds["converged"].values].tolist()
    if cases:
        text = (
            "no state of the rollers fulfils all conditions (balance, no pull on a rail, no "
            "axial force on a lifted "
        )
        text += f"roller), so that no life is known: {', '.join(cases)}. More preload helps."
        yield Caution("not_judged", len(cases), ds.sizes["load_case"], text, "load cases")
    without = [name for name in ds.attrs.get("without_case", "").split(", ") if name]
    if without:
        text = f"the file of {', '.join(without)}: lives are not computed. Add roller: FILE."
        yield Caution("not_given", len(without), len(rollers), text, "rollers")
    yield from _swinging(ds)
    yield from _unloaded(ds)
    yield from _one_contact(ds)
    yield from _second_models(ds)
    yield from _flags(ds)
    yield from friction_cautions(ds.attrs)
    for text in doubts_of(ds):
        yield Caution("doubtful", 1, 1, text, "")


def _swinging(ds: xr.Dataset) -> Iterator[Caution]:
    """Yield that a carriage on rollers in one line is a pendulum, with its largest angle."""
    if "swing" not in ds:
        return
    angles = ds["swing"].values
    place = int(np.argmax(np.abs(angles)))
    text = (
        "a pendulum: the rollers stand in one line, about which the carriage is free to roll and "
        f"stable; it swings by {angles[place]:.3g}° in {ds['load_case'].values[place]}, the "
        "largest angle, and the forces stand in the axes of the swung carriage"
    )
    if np.isnan(ds.get("payload_to_tipping", ds["swing"])).any():
        text += "; another payload swings it further, so that margins of the payload are not known"
    swinging = int((np.abs(angles) > 0).sum())
    yield Caution("flagged", swinging, ds.sizes["load_case"], text, "load cases")


def _unloaded(ds: xr.Dataset) -> Iterator[Caution]:
    """Yield the rollers that are lifted in some load cases, or carry no load in any, with the
    cause.
    """
    settled = ds["converged"].values
    play = ds.attrs.get("with_play", "").split(", ")
    never: dict[bool, list[str]] = {}
    lifted: list[str] = []
    for roller in map(str, ds["roller"].values):
        up = (ds["radial_force"].sel(roller=roller) == 0).values
        gap = max(0.0, -float(ds["approach"].sel(roller=roller).max()))
        if up.any() and up[settled].all():
            words = roller
            if roller in play:
                words = f"{roller} ({gap:.3g} mm away from its rail at least)"
            never.setdefault(roller in play, []).append(words)
        elif up.any():
            share = 100 * float(ds["share"].values[up].sum())
            lifted.append(
                f"{roller} in {', '.join(ds['load_case'].values[up])} ({share:.3g} % of the travel)"
            )
    total = ds.sizes["roller"]
    if lifted:
        yield Caution("not_held", len(lifted), total, f"lifted: {'; '.join(lifted)}", "rollers")
    for has_play, names in never.items():
        why = "a preload presses them on"
        if has_play:
            why = "the play is larger than the deflection: less play or a preload"
        yield Caution(
            "not_held",
            len(names),
            total,
            f"without load in any case: {', '.join(names)}; {why}",
            "rollers",
        )


def _one_contact(ds: xr.Dataset) -> Iterator[Caution]:
    """Yield the rollers that do not roll on both contacts in some load cases."""
    if "roller_regime" not in ds:
        return
    alike: dict[str, list[str]] = {}
    for roller in map(str, ds["roller"].values):
        words = _beside_rolling(ds.sel(roller=roller))
        if words:
            alike.setdefault(words, []).append(roller)
    for words, names in alike.items():
        text = f"not on both contacts: {', '.join(names)} in {words}; more preload helps"
        yield Caution("not_held", len(names), ds.sizes["roller"], text, "rollers")


def _second_models(ds: xr.Dataset) -> Iterator[Caution]:
    """Yield the second models that rollers exceed, or that end them before their first limit."""
    lives: dict[str, list[str]] = {}
    for roller in map(str, ds["roller"].values):
        own = ds.sel(roller=roller)
        life = {
            name: float(own[name]) if name in own else math.nan
            for name in ("life_hours", "life_km")
        }
        for name, body, used, hours in _limits_of(own):
            if (
                LIMITS[name].rivals
                and (used > 1 or not hours >= life["life_hours"])
                and not math.isnan(hours)
            ):
                text = f"{roller} {100 * used:.3g} % used, {rounded_text(hours)} h"
                lives.setdefault(f"{limit_word(name)} of the {body}", []).append(text)
        factor, km = _by_catalogue(own)
        if factor > 1 or km < life["life_km"]:
            text = f"{roller} {100 * factor:.3g} % used, {rounded_text(km)} km"
            lives.setdefault(f"{limit_word(catalogue.LIMIT.name)} of the roller", []).append(text)
    for words, rollers in lives.items():
        yield Caution(
            "second_model",
            len(rollers),
            ds.sizes["roller"],
            f"{words}: {'; '.join(rollers)}",
            "rollers",
        )


def _flags(ds: xr.Dataset) -> Iterator[Caution]:
    """Yield each validity flag with its remedy, the rollers and their load cases."""
    if "roller_validity" not in ds:
        return
    for name, flag in VALIDITY.items():
        here = (ds["roller_validity"].values & validity_bit(name)) != 0
        if not here.any():
            continue
        rollers: Sequence[str] = ds["roller"].values[here.any(axis=0)].tolist()
        cases = ds["load_case"].values[here.any(axis=1)].tolist()
        words = (
            f"{flag.words[:1].upper()}{flag.words[1:]} for {', '.join(rollers)} in "
            f"{', '.join(cases)}. {flag.remedy}"
        )
        yield Caution(
            CODES.get(name, "flagged"), len(rollers), ds.sizes["roller"], words, "rollers"
        )
