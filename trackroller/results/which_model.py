"""Whether the contact model changes a decision: the answer to a study whose only choice is the
model.
"""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pandas as pd

from trackroller.errors import listing
from trackroller.parameters import EXACTNESS
from trackroller.parameters.carriage_fields import long_name_of
from trackroller.results.answer import Answer, Caution, Column
from trackroller.results.candidate_table import candidate_table, names_of
from trackroller.results.candidates import Candidates
from trackroller.results.case_columns import codes
from trackroller.results.case_ranges import CaseRanges
from trackroller.results.comparison import Comparison, compared_output
from trackroller.results.decide import Decider
from trackroller.results.effect_curves import Effects
from trackroller.results.ends_by_factor import ends_by_factor
from trackroller.results.requirement import required_of
from trackroller.results.solved_cases import SolvedCases
from trackroller.results.study_facts import (
    case_cautions,
    checks_left_out,
    facts_of,
    given_for_nothing,
    not_given_words,
)
from trackroller.results.subgroups import level_text, plain
from trackroller.study.outputs import flat

MODEL = "contact_model"


def models_of(results: SolvedCases) -> list[str]:
    """Return the contact models of a study, the most exact one first."""
    if MODEL in results.table:
        known = set(results.table[MODEL])
    else:
        known = set()
    return [model for model in EXACTNESS if model in known]


def of_model(results: SolvedCases, model: str) -> SolvedCases:
    """Return the results of one contact model alone, as those of a study that was solved with
    it.
    """
    rows = np.flatnonzero((results.table[MODEL] == model).to_numpy())
    data = results.data
    if MODEL in data.dims:
        data = data.sel({MODEL: model})
    else:
        data = data.isel(case=rows)
    columns = {name: own[rows] for name, own in results.design.columns.items()}
    design = dataclasses.replace(results.design, columns=columns, unit=results.design.unit[rows])
    return dataclasses.replace(results, data=data, design=design, known_indices=None)


def answer_which_model(results: SolvedCases) -> Answer:
    """Return whether the requirement or the order of the candidates changes with the contact model.

    Parameters
    ----------
    results : SolvedCases
        A solved study with the factor `contact_model`.

    Notes
    -----
    `kind` is `same` or `changes`. Outputs are compared over the cases that both models hold.
    """
    models = models_of(results)
    required = required_of(results)
    compared = compared_output(results, required)
    assert compared is not None
    ranges = CaseRanges(results, *compared)
    rows = [_of_model(results, ranges, model, models[0]) for model in models]
    table = pd.DataFrame(rows)
    several = len(set(table["leader"])) > 1 or table["leader"].iloc[0] != ""
    head = _headline(rows, table, models[0])
    every = np.ones(len(results.table), dtype=bool)
    by_others = bool(((table["solved_by"] != "") & (table["solved_by"] != table["model"])).any())
    kind = "same"
    if head["changes"]:
        kind = "changes"
    return Answer(
        question="which model",
        kind=kind,
        headline=head,
        output=ranges.output,
        table=table.drop(columns=["names", "leader_key"]),
        columns=_columns(ranges, bool(required), several, by_others),
        required=required,
        curves=Effects.of(ranges).curves(),
        ends=ends_by_factor(results, ranges),
        picture=_like_against_like(results, ranges, models),
        not_checked=checks_left_out(results),
        not_used=given_for_nothing(results),
        not_given=not_given_words(results),
        warnings=(*_alike(table), *case_cautions(results, ranges, every)),
        facts=facts_of(results),
    )


def _headline(rows: list[dict[str, Any]], table: pd.DataFrame, base: str) -> dict[str, Any]:
    """Return what changes with the contact model, the decision of each model, and the range of
    their ratios to the most exact one, `base`.
    """
    changed = []
    for word, column in (("verdict", "verdict"), ("order", "leader_key")):
        if len({str(row[column]) for row in rows}) > 1:
            changed.append(word)
    models = []
    for row in rows:
        facts = {name: plain(value) for name, value in row.items() if name in TOLD}
        models.append({**facts, "leader": row["names"]})
    head = {
        "changes": " and ".join(changed),
        "base": base,
        "models": models,
        "smallest": float(table["ratio_low"].min()),
        "largest": float(table["ratio_high"].max()),
    }
    solved_by = rows[0]["solved_by"]
    if solved_by not in ("", base):
        head["base_by"] = solved_by
    return head


TOLD = ("model", "verdict", "low", "high", "error", "meets", "of", "holds")


def _of_model(results: SolvedCases, ranges: CaseRanges, model: str, base: str) -> dict[str, Any]:
    """Return the row of one contact model: its own decision, and its ratios to the most exact one
    on like cases.
    """
    own_results = of_model(results, model)
    required = required_of(own_results)
    own = Comparison(
        own_results,
        CaseRanges(own_results, ranges.output, ranges.rises),
        required,
        Candidates.grouped(own_results, ranges.output),
    )
    table = candidate_table(own)
    decided = Decider(own, table).decided()
    leader = table.iloc[decided.order[0]]
    names = names_of(own, decided.order[:1])[0]
    ratios = _ratios(results, ranges, model, base)
    sure = own.met()[0]
    ratio_low = np.nan
    ratio_high = np.nan
    if ratios.size:
        ratio_low = float(np.min(ratios))
        ratio_high = float(np.max(ratios))
    if required:
        meets = int(sure[own.own].sum())
    else:
        meets = int(own.ranges.holds[own.own].sum())
    return {
        "model": model,
        "verdict": plain(leader["state"]) or decided.kind,
        "solved_by": _solvers(own_results, own.own),
        "leader": ", ".join(
            f"{long_name_of(name)} {level_text(name, level)}" for name, level in names.items()
        ),
        "names": names,
        "leader_key": str(sorted(names.items())),
        "low": float(leader["low"]),
        "high": float(leader["high"]),
        "error": float(leader["error"]),
        "ratio_low": ratio_low,
        "ratio_high": ratio_high,
        "like": int(ratios.size),
        "meets": meets,
        "holds": int(own.ranges.holds[own.own].sum()),
        "of": int(own.own.sum()),
        "skids": int((own.ranges.reason[own.own] == "skids").sum()),
    }


def _solvers(results: SolvedCases, rows: np.ndarray) -> str:
    """Return the contact models that solved some cases, in words; '' where that is not stored."""
    if "contact_model_used" not in results.data:
        return ""
    names = str(results.data["contact_model_used"].attrs["flag_meanings"]).split()
    used = flat(results.data, "contact_model_used", results.dims)[rows].astype(int)
    return listing([names[number] for number in np.unique(used)])


def _alike(table: pd.DataFrame) -> list[Caution]:
    """Return the warning that one contact model solved the cases of several ones, which then say
    nothing of each other.
    """
    alike = table[table["solved_by"].duplicated(keep=False) & (table["solved_by"] != "")]
    if alike.empty:
        return []
    where = f"{listing(alike['model'].tolist())}: all solved by {alike['solved_by'].iloc[0]}"
    return [Caution("unlike", len(alike), len(table), f"{where}; take accuracy standard", "models")]


def _like(results: SolvedCases, model: str, base: str) -> tuple[np.ndarray, np.ndarray]:
    """Return the cases of two models that agree in all other factors, shape (k,) each."""
    others = [name for name in results.factors if name != MODEL]
    key = codes(results.table, others)
    pairs = []
    for name in (model, base):
        rows = np.flatnonzero((results.table[MODEL] == name).to_numpy())
        first = np.unique(key[rows], return_index=True)
        pairs.append((first[0], rows[first[1]]))
    both = np.intersect1d(pairs[0][0], pairs[1][0], assume_unique=True)
    return tuple(rows[np.searchsorted(keys, both)] for keys, rows in pairs)  # type: ignore[return-value]


def _ratios(results: SolvedCases, ranges: CaseRanges, model: str, base: str) -> np.ndarray:
    """Return the output by a model over that by the most exact one, over the cases that both hold,
    shape (k,).
    """
    one, other = _like(results, model, base)
    both = ranges.holds[one] & ranges.holds[other]
    mine, theirs = ranges.value[one[both]], ranges.value[other[both]]
    with np.errstate(divide="ignore", invalid="ignore"):
        ratios = np.where(mine == theirs, 1.0, mine / theirs)
    return np.asarray(ratios[np.isfinite(ratios)])


def _like_against_like(
    results: SolvedCases, ranges: CaseRanges, models: list[str]
) -> dict[str, Any]:
    """Return the output by each model against that by the most exact one, on the cases that both
    hold.
    """
    points = {}
    for model in models[1:]:
        one, other = _like(results, model, models[0])
        both = ranges.holds[one] & ranges.holds[other]
        points[model] = {"y": ranges.value[one[both]], "x": ranges.value[other[both]]}
    return {"base": models[0], "points": points}


def _columns(
    ranges: CaseRanges, required: bool, several: bool, by_others: bool
) -> tuple[Column, ...]:
    _, words, units = ranges.output
    columns = [
        Column("model", "Contact model", "", "contact model of these cases", "text", role="name")
    ]
    if by_others:
        meaning = "contact models that solved these cases; at preview kalker takes its table"
        columns.append(Column("solved_by", "Solved by", "", meaning, "text"))
    if required:
        columns.append(
            Column("verdict", "Verdict", "", "requirement of the leader by this model", "state")
        )
    if several:
        columns.append(
            Column("leader", "Leader", "", "candidate that this model names first", "text")
        )
    columns += [
        Column(
            "low",
            "Worst",
            units,
            f"{words} of the leader at its worst condition",
            until="high",
            role="bar",
        ),
        Column(
            "ratio_low",
            "To the first model",
            "1",
            "ratio to the first model on like cases, smallest to largest",
            "ratio",
            "ratio_high",
        ),
        Column("like", "Like cases", "", "cases that both models hold", "count"),
    ]
    if required:
        columns.append(
            Column(
                "meets", "Meets", "", "cases that meet the requirement within the error", "count"
            )
        )
    columns += [
        Column("holds", "Holds", "", "cases in which the roller rolls inside all limits", "count"),
        Column("skids", "Skids", "", "cases that skid", "count"),
        Column("of", "Of", "", "cases of this model", "count"),
        Column("error", "Error", "1", "told 95 % error at the worst condition", "error"),
    ]
    return tuple(columns)
