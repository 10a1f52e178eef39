"""The record of a load spectrum: its first limit with its life, every limit of both bodies, and the
blocks.

Keys of `Answer.headline`: `low`, `high` [h], `km_low`, `km_high` [km], `ends` (words of the limits
that may come first), `body`, `line_low` and `line_high` (tests that both ends of a life by fatigue
follow from), `extrapolated`, `guessed`, `block` (with the largest part of the
damage of the first limit), `share` (this part [1]), `unknown` (bodies whose life is not known),
`broken` and `exceeded` (lists of {limit, body, use [1], hours, blocks}), `open` (list of {limit,
body}), `not_judged` and `why` (reasons), `states` (of each requirement, the travel first: `met`,
`open` or `missed`).
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from trackroller.damage import LIMITS
from trackroller.damage.first_limit import STATES
from trackroller.numerics.numbers import number_or_nan
from trackroller.parameters import BODIES, PARAMETERS, REGIME_LABELS, REGIMES
from trackroller.parameters.carriage_fields import long_name_of
from trackroller.parameters.example import drive_question, is_absent
from trackroller.results.answer import Answer, Caution, Column, FurtherTable, Required, yes_or_blank
from trackroller.results.fatigue_lines import lines_text
from trackroller.results.friction import friction_cautions
from trackroller.results.life_columns import FIRST_LIMIT, past_data
from trackroller.results.margins import First, Margin, is_guessed, with_lines
from trackroller.results.placeholders import guess_cautions, placeholders_part
from trackroller.results.roller_answer import (
    CODES,
    OF_ANY_LIMIT,
    checks_left_out,
    facts_of_data,
    material_name,
    state_of_life,
)
from trackroller.results.subgroups import level_text
from trackroller.results.validity_flags import flags_of, not_judged
from trackroller.roller.dataset import validity_bit
from trackroller.roller.duty import strokes_words
from trackroller.roller.limit_notes import notes_of
from trackroller.roller.requirement import requirement_of
from trackroller.roller.stored_inputs import NOT_GIVEN, doubts_of
from trackroller.roller.temperature import HEAD as OF_TEMPERATURE
from trackroller.study.spectrum.file import LOAD_FIELDS

HOUR = "hour"  # period of blocks by share of the time, which have no shifts
COLUMNS = (
    Column("limit", "Limit", "", "limit of the roller or of the guide", "text", role="name"),
    Column("body", "Body", "", "body that the limit concerns", "text", role="name"),
    Column(
        "state",
        "Verdict",
        "",
        "kept: below 100 % in every block; exceeded: above it in a block; not known: a block has "
        "no result",
        "state",
    ),
    Column("used_low", "Used", "1", "use of the worst block", "share", "used_high", "use"),
    Column(
        "low",
        "Life",
        "h",
        "hours of travel to the limit, at both ends of the placeholders",
        "life",
        "high",
        "bar",
    ),
    Column("km_low", "Travel", "km", "the same life as travel", until="km_high"),
    Column("shifts_low", "Shifts", "1", "the same life in shifts", until="shifts_high"),
    Column(
        "block",
        "Block",
        "",
        "block with the largest part of the damage, or with the largest use",
        "text",
    ),
    Column(
        "share", "Its part", "1", "part of the damage that this block does", "share", role="file"
    ),
    Column("contact", "Contact", "", "contact whose track takes most damage by fatigue", "count"),
    *OF_ANY_LIMIT,
    Column("blocks", "Exceeded in", "", "blocks in which the limit is exceeded or open", "text"),
    Column("name", "Name", "", "name of the limit in data sets", "text", role="file"),
)
OF_LIVES = (
    Column("body", "Body", "", "body that the life is of", "text", role="name"),
    Column("probability", "Failed by then", "1", "share of like rollers that have failed", "share"),
    Column("hours", "Life", "h", "hours of travel by fatigue", "life"),
    Column("km", "Travel", "km", "the same life as travel"),
    Column("shifts", "Shifts", "1", "the same life in shifts"),
    Column(
        "at_most",
        "At most",
        "h",
        "bound by the blocks whose damage is known, where that of others is not",
    ),
    Column("contact", "Contact", "", "contact whose track fails first", "count"),
    Column("why", "Remark", "", "why a life is not known", "text"),
)


def answer_of_spectrum(ds: xr.Dataset) -> Answer:
    """Return the record of a load spectrum.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `trackroller.study.spectrum.solve.solve_spectrum`.
    """
    own = _margins(ds)
    lives = _lives(ds)
    first = First.of(own)
    columns = tuple(one for one in COLUMNS if one.name != "shifts_low" or not _by_share(ds))
    return Answer(
        question="spectrum",
        kind=_kind(own, first, lives),
        headline=_headline(ds, own, first, lives),
        output=(FIRST_LIMIT[0], "life to the limit", "h"),
        table=_table(ds, own),
        columns=columns,
        required=_required(ds),
        parts=tuple(_parts(ds, lives)),
        not_checked=_not_checked(ds),
        not_given=not_given_values(ds),
        warnings=tuple(_warnings(ds)),
        facts=facts_of_data(
            ds,
            name=str(ds.attrs["title"]),
            description=str(ds.attrs.get("description", "")),
            cases=ds.sizes["block"],
            counted="blocks",
            probability=float(ds.attrs.get("failure_probability", 0.5)),
        ),
    )


def _required(ds: xr.Dataset) -> tuple[Required, ...]:
    """Return the travel and the lives that the roller of a spectrum has to last."""
    travel = number_or_nan(json.loads(str(ds.attrs["roller"])).get("required_travel"))
    required = []
    if travel > 0:
        required.append(Required("travel", "travel", "km", least=travel))
    for name, own in requirement_of(ds).items():
        required.append(Required(name, FIRST_LIMIT[1], "h", least=own.least))
    return tuple(required)


def _states(first: First | None, rate: float, required: tuple[Required, ...]) -> list[str]:
    """Return whether each required travel or life is reached before the first limit.

    Parameters
    ----------
    first : the first limit, None if it is not known
    rate : travel in an hour [km]
    required : what is required
    """
    states = []
    for one in required:
        pace = 1.0
        if one.units == "km":
            pace = rate
        state = "open"
        if first is not None:
            state = state_of_life(first.low * pace, first.high * pace, one.least)
        states.append(state)
    return states


def known_damage(ds: xr.Dataset, body: str) -> tuple[int, np.ndarray]:
    """Return the contact whose track takes more damage in the blocks with known damage, and the
    damage of each block.

    The damage has the shape (blocks,), NaN where it is not known.
    """
    damage = ds["damage"].sel(body=body).transpose("block", "contact").values
    most = int(np.argmax(np.nansum(damage, axis=0)))
    return int(ds["contact"].values[most]), damage[:, most]


def _by_share(ds: xr.Dataset) -> bool:
    """Return whether the blocks are given by their share of the time."""
    return bool(ds.attrs.get("period") == HOUR)


def _margins(ds: xr.Dataset) -> list[Margin]:
    """Return the limits of both bodies in the order in which they are reached; without limits
    fatigue alone.
    """
    stored = json.loads(str(ds.attrs.get("materials", "{}")))
    materials = {body: stored.get(f"{body}_material", {}) for body in BODIES}
    listed = [*with_lines(list(_of_limits(ds)), materials), *_of_pressure(ds)]
    return sorted(
        listed,
        key=lambda one: (
            one.state != "exceeded",
            one.reached,
            one.beside,
            -np.nan_to_num(one.used),
        ),
    )


def _of_limits(ds: xr.Dataset) -> Iterator[Margin]:
    """Yield the limits of both bodies that were checked."""
    if "life_shifts_by_limit" not in ds:
        yield from (_by_fatigue_alone(ds, body) for body in BODIES)
        return
    for name in ds["limit"].values.tolist():
        limit = LIMITS[name]
        timed = bool(ds["life_shifts_by_limit"].sel(limit=name).notnull().any())
        for body in limit.bodies:
            own = ds.sel(limit=name, body=body)
            state = STATES[int(own["limit_state"])]
            if state == "unknown":
                continue
            unsolved = (own["limit_state_of_block"].values == STATES.index("unknown")) & (
                ds["distance"].values > 0
            )
            if state == "kept" and unsolved.any():
                state = "unknown"
            used = float(own["utilisation"])
            low, high = (float(own[f"life_hours_by_limit{end}"]) for end in ("_low", "_high"))
            shifts = float(own["life_shifts_by_limit"])
            hours = shifts * float(ds["duration"].sum())
            yield Margin(
                name,
                limit.word,
                limit.title,
                body,
                used=used,
                used_low=used,
                used_high=used,
                hours=hours,
                low=low,
                high=high,
                state=state,
                breaks=name == "static" and state == "exceeded",
                timed=timed,
                beside=limit.beside,
                beyond=name == "fatigue" and _beyond(ds, body, shifts),
                guessed=is_guessed(ds, name, material_name(ds, body)),
            )


def _by_fatigue_alone(ds: xr.Dataset, body: str) -> Margin:
    """Return the limit of fatigue of a spectrum that was solved without limits."""
    hours = float(ds[f"{body}_life_hours"])
    limit = LIMITS["fatigue"]
    beyond = _beyond(ds, body, float(ds[f"{body}_life_shifts"]))
    state = "kept"
    if math.isnan(hours):
        state = "unknown"
    margin = Margin(
        "fatigue", limit.word, limit.title, body, state=state, timed=True, beyond=beyond
    )
    return replace(margin, hours=hours, low=hours, high=hours)


def _of_pressure(ds: xr.Dataset) -> Iterator[Margin]:
    """Yield the pressure limit of the bodies that exceed it in a block."""
    for body in BODIES:
        if _yields(ds, body).any():
            title = "pressure limit (yield below the surface)"
            yield Margin("pressure", "pressure", title, body, state="exceeded")


def _yields(ds: xr.Dataset, body: str) -> np.ndarray:
    """Return the blocks in which a body exceeds the pressure limit, shape (blocks,) bool."""
    if "validity_body" not in ds:
        return np.zeros(ds.sizes["block"], dtype=bool)
    flags = ds["validity_body"].sel(body=body).values.astype(int)
    return np.asarray((ds["distance"].values > 0) & ((flags & validity_bit("yield")) != 0))


def _beyond(ds: xr.Dataset, body: str, shifts: float) -> bool:
    """Return whether a body lasts more overrollings than its fatigue limit or the S-N data
    reach.
    """
    material = json.loads(str(ds.attrs.get("materials", "{}"))).get(f"{body}_material", {})
    cycles = shifts * float(ds["overrollings"].sel(body=body).sum())
    return bool(past_data(cycles, float(material.get("cycles_at_fatigue_limit", np.inf))))


def _kind(own: list[Margin], first: First | None, lives: pd.DataFrame) -> str:
    """Return the answer in one word."""
    if any(margin.breaks for margin in own):
        return "breaks"
    if first is None:
        return "unknown"
    if math.isinf(first.low):
        return "unlimited"
    return "lasts"


def _headline(
    ds: xr.Dataset, own: list[Margin], first: First | None, lives: pd.DataFrame
) -> dict[str, Any]:
    """Return the numbers and names of the headline."""
    over = [one for one in own if one.state == "exceeded" and not one.breaks]
    reasons = _reasons(ds)
    head: dict[str, Any] = {
        "low": math.nan,
        "high": math.nan,
        "km_low": math.nan,
        "km_high": math.nan,
        "ends": [],
        "body": "",
        "line_low": "",
        "line_high": "",
        "extrapolated": False,
        "guessed": False,
        "block": "",
        "share": math.nan,
        "unknown": [
            body for body in BODIES if not any(one.ends and one.body == body for one in own)
        ],
        "broken": [_use(ds, one) for one in own if one.breaks],
        "exceeded": [_use(ds, one) for one in over],
        "open": [
            {"limit": one.word, "body": one.body}
            for one in own
            if one.state == "open" and not one.beside
        ],
        "not_judged": list(reasons),
        "why": [f"{row['body']}: {row['why']}" for row in lives.to_dict("records") if row["why"]],
        "states": _states(first, _km_an_hour(ds), _required(ds)),
    }
    if first is None:
        return head
    rate = _km_an_hour(ds)
    head |= {
        "low": first.low,
        "high": first.high,
        "km_low": first.low * rate,
        "km_high": first.high * rate,
    }
    head |= {"ends": list(first.words), "body": first.body, "extrapolated": first.beyond}
    head |= dict(zip(("line_low", "line_high"), first.lines, strict=True))
    head["guessed"] = any(margin.guessed for margin in first.margins) and first.low < first.high
    block, share = _worst_block(ds, first.margins[0])
    return head | {"block": block, "share": share}


def _use(ds: xr.Dataset, margin: Margin) -> dict[str, Any]:
    words = {"limit": margin.word, "body": margin.body, "use": margin.used, "hours": margin.hours}
    return words | {"blocks": _blocks_of(ds, margin)}


def _km_an_hour(ds: xr.Dataset) -> float:
    return float(ds["distance"].sum() / ds["duration"].sum()) / 1e3


def _blocks_of(ds: xr.Dataset, margin: Margin) -> list[str]:
    """Return the blocks in which a limit has its state, where that is exceeded or open."""
    if margin.state not in ("exceeded", "open"):
        return []
    if margin.name == "pressure":
        here = _yields(ds, margin.body)
    else:
        states = ds["limit_state_of_block"].sel(limit=margin.name, body=margin.body).values
        here = states == STATES.index(margin.state)
    return [str(name) for name in ds["block"].values[here]]


def _worst_block(ds: xr.Dataset, margin: Margin) -> tuple[str, float]:
    """Return the block that does the largest part of the damage by a limit, and this part [1]; ''
    if not known.
    """
    if "damage_by_limit" in ds and margin.name in ds["limit"].values.tolist():
        damage = ds["damage_by_limit"].sel(limit=margin.name, body=margin.body).values
    elif margin.name == "fatigue":
        damage = known_damage(ds, margin.body)[1]
    else:
        return "", math.nan
    if not np.isfinite(damage).any() or not np.nansum(damage) > 0:
        return "", math.nan
    worst = int(np.nanargmax(damage))
    return str(ds["block"].values[worst]), float(damage[worst] / np.nansum(damage))


def _table(ds: xr.Dataset, own: list[Margin]) -> pd.DataFrame:
    """Return one row a limit and body."""
    rows = [_row(ds, margin) for margin in own]
    return pd.DataFrame(
        rows, columns=[name for one in COLUMNS for name in (one.name, one.until) if name]
    )


def _row(ds: xr.Dataset, margin: Margin) -> dict[str, Any]:
    """Return the row of a limit."""
    low = margin.soonest
    high = margin.latest
    state = margin.state
    if state == "kept" and margin.used > 1.0:
        state = "finite"
    model = ""
    if margin.beside:
        model = "second"
    shift = float(ds["duration"].sum())
    block, share = _worst_block(ds, margin)
    block_words = ""
    if block:
        block_words = f"{block}, {100 * share:.0f} %"
    contact = math.nan
    if margin.name == "fatigue" and block:
        contact = known_damage(ds, margin.body)[0]
    return {
        "limit": margin.word,
        "body": margin.body,
        "state": state,
        "used_low": margin.used_low,
        "used_high": margin.used_high,
        "low": low,
        "high": high,
        "km_low": low * _km_an_hour(ds),
        "km_high": high * _km_an_hour(ds),
        "shifts_low": low / shift,
        "shifts_high": high / shift,
        "block": block_words,
        "share": share,
        "contact": contact,
        "extrapolated": yes_or_blank(margin.beyond),
        "guessed": yes_or_blank(margin.guessed),
        "model": model,
        "line": lines_text(*margin.lines, margin.alone),
        "blocks": ", ".join(_blocks_of(ds, margin)),
        "name": margin.name,
    }


def _lives(ds: xr.Dataset) -> pd.DataFrame:
    """Return the life of each body by fatigue, at each failure probability if its material
    scatters.
    """
    shift = float(ds["duration"].sum())
    km = float(ds["distance"].sum()) / 1e3
    rows = []
    for body in BODIES:
        why, at_most = _why_unknown(ds, body)
        contact = known_damage(ds, body)[0]
        lives = {0.5: float(ds[f"{body}_life_shifts"])}
        if "life_shifts_at_probability" in ds:
            at = ds["life_shifts_at_probability"].sel(body=body)
            if not bool(at.isnull().all()):
                lives = {
                    float(p): float(at.sel(probability=p).min(skipna=False))
                    for p in ds["probability"].values
                }
        for probability, shifts in lives.items():
            lengths = {"hours": shifts * shift, "km": shifts * km, "shifts": shifts}
            row = {
                "body": body,
                "probability": probability,
                "at_most": at_most,
                "contact": contact,
                "why": why,
            }
            rows.append(row | lengths)
    return pd.DataFrame(rows, columns=[one.name for one in OF_LIVES])


def _why_unknown(ds: xr.Dataset, body: str) -> tuple[str, float]:
    """Return why the life of a body is not known, and the longest life that the other blocks allow
    [h].

    The life is NaN where these blocks set no bound.
    """
    if not math.isnan(float(ds[f"{body}_life_shifts"])):
        return "", math.nan
    damage = known_damage(ds, body)[1]
    unknown = ds["damage"].sel(body=body).isnull().any("contact").values
    names = ds["block"].values.astype(str)[unknown]
    regimes = ds["regime"].values.astype(int)[unknown]
    skids = regimes == REGIMES.index("full_slip")
    breaks = np.zeros(len(names), dtype=bool)
    if "validity_body" in ds:
        breaks = (ds["validity_body"].sel(body=body).values[unknown] & validity_bit("static")) != 0
    unsolved = np.isnan(
        ds["peak_stress"].sel(body=body).transpose("block", "contact").values[unknown]
    ).any(axis=1)
    reasons = [
        f"no stress in {n} ({REGIME_LABELS[r]})"
        for n, r in zip(names[unsolved], regimes[unsolved], strict=True)
    ]
    reasons += [f"its peak stress exceeds its tensile strength in {n}" for n in names[breaks]]
    reasons += [f"the roller skids in {n}" for n in names[skids & ~breaks]]
    if not reasons:
        reasons = ["give guide_overrollings_per_hour, or guide_overrollings of each block"]
    known = float(np.nansum(damage))
    bound = math.nan
    if known > 0:
        bound = ds.attrs["critical_damage"] / known * float(ds["duration"].sum())
    return "; ".join(reasons), bound


def _parts(ds: xr.Dataset, lives: pd.DataFrame) -> Iterable[FurtherTable]:
    """Yield the further tables of a spectrum: its blocks, the lives by fatigue, and
    placeholders.
    """
    yield _blocks(ds)
    columns = tuple(one for one in OF_LIVES if one.name != "shifts" or not _by_share(ds))
    yield FurtherTable(
        "lives", "Life by fatigue", lives, columns, f"{ds.attrs['life_conventions']}."
    )
    guesses = placeholders_part(ds)
    if not guesses.table.empty:
        yield guesses


def _blocks(ds: xr.Dataset) -> FurtherTable:
    """Return the blocks with their loads, the regime, and stress and damage of both bodies, and
    their sum.
    """
    known = [name for name in LOAD_FIELDS if np.isfinite(ds[name].values).any()]
    loads = [name for name in known if not is_absent(name, ds[name].values)]
    columns = [
        Column("block", "Block", "", "name of the block", "text", role="name"),
        Column("distance", "Distance", "m", "travel of the block", "whole"),
        Column("duration", "Duration", "h", "hours of travel", "whole"),
        *(Column(n, long_name_of(n), PARAMETERS[n].units, "", "whole") for n in loads),
        Column("regime", "Regime", "", "", "text"),
    ]
    if _by_share(ds):
        columns[2] = Column("duration", "Share of the time", "1", "", "share")
    table = pd.DataFrame({"block": ds["block"].values.astype(str)})
    for name in ("distance", "duration", *loads):
        table[name] = ds[name].values.astype(float)
    table["regime"] = [REGIME_LABELS[int(code)] for code in ds["regime"].values]
    notes = []
    for body in BODIES:
        contact, damage = known_damage(ds, body)
        whole = float(np.nansum(damage))
        table[f"peak_{body}"] = ds["peak_stress"].sel(body=body, contact=contact).values
        table[f"damage_{body}"] = damage
        table[f"share_{body}"] = np.nan
        if whole > 0:
            table[f"share_{body}"] = damage / whole
        columns += [
            Column(
                f"peak_{body}",
                f"{body} peak",
                "MPa",
                "peak stress of the track that fails first",
                "whole",
            ),
            Column(f"damage_{body}", f"{body} damage", "1", "damage of the block by fatigue"),
            Column(f"share_{body}", f"{body} share", "1", "part of the known damage", "share"),
        ]
        least = ""
        if np.isnan(damage).any():
            least = "at least "
        notes.append(f"{body}: contact {contact}, damage sum {least}{whole:.4g}")
    sums = f"{float(ds['distance'].sum()):,.6g} m and {float(ds['duration'].sum()):.4g} h"
    title = "Blocks of a shift"
    if _by_share(ds):
        title = "Blocks of an hour of travel"
    note = f"Together {sums}; {'; '.join(notes)}. {strokes_words(ds)}".strip()
    return FurtherTable("blocks", title, table, tuple(columns), note)


def _not_checked(ds: xr.Dataset) -> Mapping[str, tuple[str, ...]]:
    """Return the limits that were checked for no block."""
    if "limit_state" not in ds:
        return {}
    return checks_left_out(ds)


def not_given_values(ds: xr.Dataset) -> dict[str, str]:
    """Return the values that nobody gave, with their units, of a spectrum or a carriage."""
    given = json.loads(ds.attrs.get(NOT_GIVEN, "{}"))
    return {
        name: level_text(name, value)
        for name, value in given.items()
        if value is not None and value == value
    }


def _reasons(ds: xr.Dataset) -> dict[str, list[str]]:
    """Return why the model does not judge blocks with travel, and these blocks."""
    reasons: dict[str, list[str]] = {}
    for place, name in enumerate(ds["block"].values):
        if float(ds["distance"][place]) > 0:
            for reason in not_judged(ds.isel(block=place)):
                reasons.setdefault(reason, []).append(str(name))
    return reasons


def _flagged_blocks(ds: xr.Dataset) -> dict[tuple[str, str], list[str]]:
    """Return the blocks in which a flag is set, by the code and the words of the flag."""
    if "validity" not in ds:
        return {}
    flagged: dict[tuple[str, str], list[str]] = {}
    for place, name in enumerate(ds["block"].values):
        for flag in flags_of(ds.isel(block=place)):
            code = CODES.get(flag.name, "flagged")
            flagged.setdefault((code, f"{flag.sentence} {flag.remedy}"), []).append(str(name))
    return flagged


def _warnings(ds: xr.Dataset) -> Iterator[Caution]:
    """Yield the warnings of a spectrum, flags with their blocks."""
    total = ds.sizes["block"]
    for reason, names in _reasons(ds).items():
        yield Caution("not_judged", len(names), total, f"{reason}: {', '.join(names)}", "blocks")
    for (code, text), names in _flagged_blocks(ds).items():
        yield Caution(code, len(names), total, f"{', '.join(names)}: {text}", "blocks")
    yield from guess_cautions(placeholders_part(ds))
    yield from friction_cautions(ds.attrs)
    for note in notes_of(ds):
        if note.startswith(OF_TEMPERATURE):
            yield Caution("flagged", total, total, note, "blocks")
    for text in doubts_of(ds):
        yield Caution("doubtful", 1, 1, text, "")
    given = json.loads(ds.attrs.get(NOT_GIVEN, "{}"))
    question = drive_question(given, set(PARAMETERS) - set(given))
    if question:
        yield Caution("not_given", 1, 1, question, "")
    words = not_given_values(ds)
    if words:
        values_given = ", ".join(f"{long_name_of(name)} {value}" for name, value in words.items())
        yield Caution("not_given", 1, 1, values_given, "")
