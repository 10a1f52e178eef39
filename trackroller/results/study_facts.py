"""Parts of the answers to all questions: title line, warnings, and what was not checked, not given
and not used.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import pandas as pd

from trackroller.damage import LIMITS, first_limit, limit_word
from trackroller.parameters import BODIES
from trackroller.parameters.carriage_fields import long_name_of
from trackroller.parameters.example import is_absent
from trackroller.results.answer import Caution
from trackroller.results.candidates import slip_margin
from trackroller.results.case_columns import codes
from trackroller.results.case_ranges import CaseRanges
from trackroller.results.comparison import LOADS, UNEQUAL, Comparison
from trackroller.results.friction import friction_cautions
from trackroller.results.life_columns import OF_PAIR, body_lives
from trackroller.results.solved_cases import SolvedCases
from trackroller.results.subgroups import labels_in_place, level_text, places_of, places_text
from trackroller.roller.limit_notes import given_in_vain
from trackroller.roller.output_names import body_of, is_life
from trackroller.roller.stored_inputs import names_not_given
from trackroller.study.outputs import flat
from trackroller.study.store.provenance import DATE

# input that brings a condition out of reach
CAUSES = {"lifts off": "axial_force", "skids": "motor_force"}
# share of the cases lost by an input that was not given, from which on the input is asked for
MANY = 0.5
NAMED_LEVELS = 4  # values that a warning lists


def facts_of(results: SolvedCases, own: Comparison | None = None) -> dict[str, Any]:
    """Return the facts of the title line of a study.

    Parameters
    ----------
    results : the solved study
    own : its comparison, with the numbers of its candidates and conditions
    """
    models = [results.config.contact_model]
    if "contact_model" in results.table:
        models = list(results.table["contact_model"].unique())
    facts: dict[str, Any] = {
        "name": results.config.name,
        "description": results.config.description,
        "date": str(results.data.attrs.get(DATE, ""))[:10],
        "cases": len(results.table),
        "method": results.config.method.name,
        "models": [str(one) for one in models],
        "accuracy": str(results.config.accuracy),
        "duty": results.config.duty,
        "strokes": None,
        "candidates": None,
        "conditions": None,
        "drawn": False,
    }
    if own is not None:
        sizes = np.bincount(own.pairs[0], minlength=own.count)
        conditions = sorted({int(size) for size in sizes})
        facts |= {
            "candidates": own.count,
            "drawn": own.drawn,
            "conditions": [conditions[0], conditions[-1]],
        }
    return facts


def checks_left_out(results: SolvedCases) -> dict[str, tuple[str, ...]]:
    """Return the limits that were not checked for each body, in words.

    A limit is checked for a body if its life, or of a limit without lives its use, is known in
    every valid row. A limit that is known in some of the rows is listed with their number.
    """
    checks: dict[str, list[str]] = {body: [] for body in BODIES}
    rows = results.of_one_model(results.inside)
    if not rows.any():
        rows = results.of_one_model()
    known = _known(results)
    for name, limit in LIMITS.items():
        if limit.use is None:
            continue
        for place, body in enumerate(BODIES):
            if body not in limit.bodies:
                continue
            hit = known.get(name, np.zeros((len(rows), len(BODIES)), dtype=bool))[rows, place]
            if not hit.any():
                checks[body].append(limit.word)
            elif not hit.all():
                checks[body].append(f"{limit.word} ({int((~hit).sum()):,} of {len(hit):,} cases)")
    return {body: tuple(names) for body, names in checks.items()}


def _known(results: SolvedCases) -> dict[str, np.ndarray]:
    """Return where each limit is known, (n, body) bool by its name."""
    data = results.data
    if "limit" not in data.dims:
        return _without_limits(results)
    lives = flat(data, "life_hours_by_limit", results.dims)
    uses = flat(data, "utilisation", results.dims)
    if first_limit.AT_MOST in data:
        uses = np.fmax(uses, flat(data, first_limit.AT_MOST, results.dims))
    out = {}
    for place, name in enumerate(str(one) for one in data["limit"].values):
        timed = ~np.isnan(lives[:, place])
        if timed.any():
            out[name] = timed
        else:
            out[name] = ~np.isnan(uses[:, place])
    return out


def _without_limits(results: SolvedCases) -> dict[str, np.ndarray]:
    """Return which of static strength and fatigue are known in a study without the group of the
    limits.
    """
    stress = np.stack([results.column(f"peak_stress_{body}") for body in BODIES], axis=1)
    lives = np.stack([results.column(f"{body}_life_hours") for body in BODIES], axis=1)
    return {"static": ~np.isnan(stress), "fatigue": ~np.isnan(lives)}


def unchecked_names(results: SolvedCases) -> list[str]:
    """Return the names of the limits that were checked for no body."""
    known = _known(results)
    judged = [name for name, limit in LIMITS.items() if limit.use is not None]
    return [name for name in judged if name not in known or not known[name].any()]


def given_for_nothing(results: SolvedCases) -> dict[str, str]:
    """Return the values under `base` that serve only limits of which nothing was computed, with
    these limits in words.
    """
    unknown = names_not_given(results.data.attrs)
    unused = [
        name
        for name in unchecked_names(results)
        if not any(own.name in results.data for own in LIMITS[name].results)
    ]
    idle = given_in_vain(results.config.base, unused)
    return {
        name: "needed by " + " and ".join(limit_word(one) for one in limits)
        for name, limits in idle.items()
        if name not in unknown
    }


def not_given_words(results: SolvedCases) -> dict[str, str]:
    """Return the values that nobody gave, with their units."""
    words = {}
    for name in names_not_given(results.data.attrs):
        if name in results.factors or name in results.derived:
            continue
        value = results.base.get(name)
        unknown = value is None or (isinstance(value, float) and np.isnan(value))
        if not unknown and not is_absent(name, value):
            words[name] = level_text(name, value)
    return words


def lost_by_missing_input(own: Comparison) -> str:
    """Return the load that was not given and by which conditions are lost; '' without one.

    With a requirement each condition that no candidate holds counts, otherwise at least half of the
    cases.
    """
    results = own.results
    skids = slip_margin(results) < 0
    unknown = [name for name in names_not_given(results.data.attrs) if name not in results.factors]
    for cause, name in CAUSES.items():
        if name not in unknown:
            continue
        lost = own.own & (own.ranges.reason == cause)
        if name != "motor_force":
            # more axial force is no remedy for a drive that friction cannot transmit
            lost &= ~skids
        hopeless = lost & own.unreachable
        if not own.ranges.holds.any():
            hopeless = lost
        is_open = bool(own.required) and hopeless.any()
        if is_open or lost.sum() >= MANY * own.own.sum():
            return name
    return ""


def where_text(results: SolvedCases, hit: np.ndarray, among: np.ndarray) -> str:
    """Return the levels of factors that hold some rows and no others; '' if no levels do."""
    names = labels_in_place(results.table, results.factors, results.labels, hit & among)
    places = places_of(results.table, names, hit, among)
    if places:
        return places_text([place for place in places if len(place) <= 3], results.table)
    return ""


def cautions(own: Comparison, shown: pd.DataFrame, named: int = 1) -> tuple[Caution, ...]:
    """Return the warnings of an answer with candidates.

    Parameters
    ----------
    own : the comparison of a study
    shown : table of the answer, the leader first
    named : number of the first rows that the headline names; 0 for none
    """
    listed = [*case_cautions(own.results, own.ranges, own.own)]
    if "second_state" in shown and own.required:
        turned = (shown["second_state"] != "") & (shown["second_state"] != shown["state"])
        if turned.iloc[1:].any():
            words = ", ".join(dict.fromkeys(shown["second"][turned]))
            listed.append(
                Caution("second_model", int(turned.sum()), len(shown), words, "candidates")
            )
    edges = shown.iloc[:named]
    edges = edges[edges["edge"] != ""]
    if len(edges):
        words = _edge_text(own, edges.iloc[0])
        listed.append(Caution("at_end", len(edges), named, words, "candidates"))
    return (*listed, *_unlike(own, shown))


def _edge_text(own: Comparison, candidate: pd.Series) -> str:
    """Return the choices of a candidate at the ends of their levels, with these levels."""
    parts = []
    for name in own.choices:
        if long_name_of(name) in candidate["edge"].split(", "):
            levels = own.results.levels(name)
            value = candidate[name]
            side = "largest"
            if value == levels[0]:
                side = "smallest"
            ends = f"{level_text(name, levels[0])} to {level_text(name, levels[-1])}"
            parts.append(f"{long_name_of(name)} {level_text(name, value)}: {side} of {ends}")
    return "; ".join(parts)


def _reasons_of(ranges: CaseRanges, rows: np.ndarray) -> str:
    """Return why cases are not held or not judged, each reason with its number of cases."""
    reasons = pd.Series(ranges.reason[rows]).map(
        lambda word: limit_word(str(word).removeprefix("limit "))
    )
    return ", ".join(f"{word} {count:,}" for word, count in reasons.value_counts().items())


def case_cautions(results: SolvedCases, ranges: CaseRanges, rows: np.ndarray) -> list[Caution]:
    """Return the warnings that count cases.

    Parameters
    ----------
    results : the solved study
    ranges : the output that the answer is about
    rows : the cases of the answer, shape (n,) bool
    """
    listed = []
    total = int(rows.sum())
    lost = rows & ~ranges.holds & ranges.judged
    unknown = rows & ~ranges.judged
    for code, hit in (("not_held", lost), ("not_judged", unknown)):
        if hit.any():
            counts = _reasons_of(ranges, hit)
            where = where_text(results, hit, rows)
            if where:
                counts = f"{counts}: {where}"
            listed.append(Caution(code, int(hit.sum()), total, counts))
    beyond = ranges.beyond & rows
    if is_life(ranges.output[0]) and beyond.any():
        listed.append(
            Caution(
                "extrapolated", int(beyond.sum()), total, "life beyond the data of its S-N line"
            )
        )
    beyond_table = results.flagged("wear_extrapolated") & rows & ranges.holds
    if beyond_table.any():
        where = "wear beyond the table of its energy law"
        listed.append(Caution("extrapolated", int(beyond_table.sum()), total, where))
    worn = _outlives_groove(results, ranges.output[0]) & rows & ranges.holds
    if worn.any():
        listed.append(Caution("worn", int(worn.sum()), total, "the groove changes within the life"))
    words = not_given_words(results)
    if words:
        listed.append(
            Caution(
                "not_given",
                total,
                total,
                _listed(f"{long_name_of(n)} {v}" for n, v in words.items()),
            )
        )
    return [*listed, *friction_cautions(results.data.attrs)]


def _outlives_groove(results: SolvedCases, output: str) -> np.ndarray:
    """Return the cases in which an output lasts beyond the run-in of the groove, shape (n,) bool.

    The life of a body counts for this body only. That of the pair ends with the first body whose
    life is known. All other outputs are those of a new groove, which either body may outlive.
    """
    body = body_of(output)
    if is_life(output) and body:
        return results.flagged("worn", body)
    if output not in OF_PAIR or not results.by_body:
        return results.flagged("worn")
    beyond = {body: results.flagged("worn", body) for body in BODIES}
    unknown = {body: np.isnan(results.column(name)) for body, name in body_lives(output).items()}
    ends = np.logical_and.reduce([beyond[body] | unknown[body] for body in BODIES])
    return np.asarray(ends & (beyond["roller"] | beyond["guide"]))


def _listed(texts: Iterable[str]) -> str:
    return ", ".join(texts)


def _unlike(own: Comparison, shown: pd.DataFrame) -> list[Caution]:
    """Return the warnings that candidates differ in their loads, their samples or their scatter."""
    listed = []
    if own.drawn and shown["n"].nunique() > 1:
        sizes = ", ".join(str(size) for size in shown["n"].head(NAMED_LEVELS))
        listed.append(
            Caution(
                "unlike", len(shown), len(shown), f"sample sizes: {sizes} conditions", "candidates"
            )
        )
    loads = _unequal_loads(own)
    if loads:
        words = _listed(
            f"{long_name_of(name)} by up to {100 * share:.2g} %" for name, share in loads.items()
        )
        listed.append(
            Caution(
                "unlike",
                own.count,
                own.count,
                f"loads differ in the same condition: {words}",
                "candidates",
            )
        )
    if own.unpaired:
        words = _listed(long_name_of(name) for name in own.unpaired)
        where = f"values that differ in conditions of one name: {words}"
        listed.append(Caution("unlike", own.count, own.count, where, "candidates"))
    if own.count > 1 and not own.matched and not own.drawn and own.conditions:
        where = f"candidates have other conditions: {_listed(_conditions_apart(own))}"
        listed.append(Caution("unlike", own.count, own.count, where, "candidates"))
    return listed


def _conditions_apart(own: Comparison) -> list[str]:
    """Return the conditions whose levels differ between candidates, in words, with all of their
    levels.
    """
    table = own.results.table[own.own]
    candidate = own.candidate[own.own]
    apart = []
    for name in own.conditions:
        levels = own.results.levels(name)
        pairs = pd.DataFrame({"candidate": candidate, "level": table[name].to_numpy()})
        everywhere = pairs.drop_duplicates().groupby("level").size() == own.count
        if not everywhere.all():
            ends = " to ".join(level_text(name, level) for level in (levels[0], levels[-1]))
            apart.append(f"{long_name_of(name)} ({ends})")
    return apart


def _unequal_loads(own: Comparison) -> Mapping[str, float]:
    """Return the loads that differ between candidates in the same condition by more than a
    hundredth.
    """
    ratios: dict[str, float] = {}
    if not own.matched or own.count < 2:
        return ratios
    for name in LOADS:
        if name in own.results.factors or name not in own.results.table:
            continue
        if own.results.behind(name) and not {*own.results.behind(name)} & {*own.choices}:
            continue
        size = np.abs(own.results.table[name].to_numpy(dtype=float))
        group = codes(own.results.table, own.conditions)
        most, least = np.zeros(group.max() + 1), np.full(group.max() + 1, np.inf)
        np.maximum.at(most, group[own.own], size[own.own])
        np.minimum.at(least, group[own.own], size[own.own])
        known = (most > 0) & np.isfinite(least)
        apart = float((1.0 - least[known] / most[known]).max(initial=0.0))
        if apart > UNEQUAL:
            ratios[name] = apart
    return ratios
