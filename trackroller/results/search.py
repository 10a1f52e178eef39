"""Search for the best candidates of a study, `method: optimise`.

The search draws a generation of candidates, solves each of them at all its conditions, judges it by
the goals and draws the next generation. Every generation is a design of the study whose cases go
through plan and chunks, so a search that was stopped repeats its generations from the stored cases.

A ladder of models saves time: the search uses the table of Kalker's tractions where the options
allow it. The model of the study then decides among the candidates on the best fronts, the
recommended one is polished with it, and every reported optimum is solved again with the accuracy
`reference`.
"""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from trackroller.errors import InputError
from trackroller.files import sha256
from trackroller.methods.factor import Factor
from trackroller.methods.optimise import (
    first_generation,
    genes_of,
    next_generation,
    nondominated_ranks,
    survivors,
)
from trackroller.parameters import PARAMETERS
from trackroller.results.search_fitness import OPTIMUM, Judged, best_in, judge, recommended, spread
from trackroller.results.stored_study import solved_results
from trackroller.study.file.load import parse_study
from trackroller.study.file.study import Study
from trackroller.study.run import Runner
from trackroller.study.store.fingerprint import StudyCases
from trackroller.study.store.folder import StudyFolder, Tell, unheard
from trackroller.study.store.gather import gather
from trackroller.study.store.ledger import Ledger
from trackroller.study.store.put import put_text

TABLE = "kalker_table"
ELEMENTS = "kalker"
REPORTED = 10  # optima that are solved again at reference, spread along the front
DECIDED = 2  # candidates of the best fronts that the study's model decides among, in populations
TOLERANCE = 0.05  # mm; a choice without the unit mm is changed by 1 % of its range
POLISH_STEPS = (0.04, 0.02, 0.01, 0.005)  # shares of the range of a real choice
REPEATED = 3  # times that each of these steps is taken
CORNER_REPEATED = 8  # times that each step is taken on the way to a corner
MOST_CATEGORIES = 12  # of a choice without an order whose levels are all tried at a corner


@dataclass
class _CandidateSearch:
    """Solve candidates of a study and judge them; solved cases are found in the store."""

    study: Study
    folder: StudyFolder
    runner: Runner

    def of(self, study: Study, genes: np.ndarray) -> Study:
        """Return a study with these candidates, which stand in `designs.csv`."""
        path = self.folder.root / "designs.csv"
        choices = study.drawn.meta["outer"]
        lines = [",".join(choices), *(",".join(repr(float(gene)) for gene in row) for row in genes)]
        put_text(path, "\n".join(lines) + "\n")
        config = study.config.model_copy(update={"table": path.name})
        inputs = study.inputs | {path: ("table", sha256(path))}
        return dataclasses.replace(study, config=config, path=path, inputs=inputs)

    def ledger(self, study: Study) -> Ledger:
        """Return the ledger of a study of candidates."""
        return Ledger(StudyCases(study), self.folder)

    def judged(self, study: Study, genes: np.ndarray) -> Judged:
        """Solve candidates, as far as they are not solved yet, and judge them."""
        one = self.of(study, genes)
        ledger = self.ledger(one)
        if (ledger.state_number < 0).any():
            with self.runner.solved(one) as ledger:
                pass
        else:
            self.runner.progress(len(ledger.state_number), 0)
        return judge(solved_results(ledger), genes)


def cheaper(study: Study) -> Study:
    """Return the study with the table of Kalker's tractions where its options allow that, otherwise
    the study.
    """
    if study.config.contact_model != ELEMENTS:
        return study
    try:
        return _with(study, contact_model=TABLE)
    except InputError:
        return study


def _with(study: Study, **values: str) -> Study:
    """Return the study with other options."""
    other = parse_study(study.as_dict() | values, study.path, study.database, planned=True)
    return dataclasses.replace(other, inputs=study.inputs)


def search_candidates(study: Study, results: Path | str = "results", **how: Any) -> Ledger:
    """Search for the best candidates of a study and gather the candidates among which its model
    decided.

    Parameters
    ----------
    study : Study
        The checked study, with `method: optimise`.
    results : path
        Parent of the study's folder.
    **how
        Other fields of `trackroller.study.run.Runner`.

    Returns
    -------
    Ledger
        The ledger of the gathered candidates. The attribute `optimum` of `study.nc` holds the
        optima (JSON).

    Raises
    ------
    InputError
        If the study is wrong.
    WorkError
        If the work cannot be completed; every finished chunk is kept.
    """
    with Runner(results, **how) as runner, runner.deciding(study) as folder:
        tell = runner.tell
        runner.started(study.config.budget.designs * study.drawn.meta["inner_samples"], 0)
        search = _CandidateSearch(
            study, folder, dataclasses.replace(runner, tell=unheard, started=unheard)
        )
        known, facts = _evolve(search, cheaper(study), tell)
        if cheaper(study) is study:
            decided = known
        else:
            best = survivors(known.costs, known.missed, DECIDED * study.config.budget.generation)
            decided = search.judged(study, known.genes[best])
            tell(f"decided among {len(best)} designs with {study.config.contact_model}")
        return _reported(search, decided, facts | {"reasons": known.reasons}, tell)


def _evolve(search: _CandidateSearch, study: Study, tell: Tell) -> tuple[Judged, dict[str, Any]]:
    """Return all candidates of the search and facts about it; stop at the budget or when no
    candidate is left.
    """
    budget = study.config.budget
    choices = _choices(study)
    genes = genes_of(choices)
    known = None
    number = 0
    why = "every design is solved"
    drawn = first_generation(genes, min(budget.generation, budget.designs), study.config.seed)
    while len(drawn):
        if known is not None and budget.hours is not None:
            ledger = search.ledger(search.of(study, drawn))
            if ledger.hours >= budget.hours and (ledger.state_number < 0).any():
                why = f"the {budget.hours:g} hours are spent"
                break
        new = search.judged(study, drawn)
        if known is None:
            known = new
        else:
            known = known + new
        first = nondominated_ranks(known.costs, known.missed) == 0
        number += 1
        valid = int((known.violation == 0).sum())
        tell(
            f"generation {number}: {len(known.genes)} designs, {valid} valid in all conditions, "
            f"{first.sum()} best"
        )
        if len(known.genes) >= budget.designs:
            why = f"the budget of {budget.designs} designs is spent"
            if budget.designs == 1:
                why = "the budget of 1 design is spent"
            break
        many = min(budget.generation, budget.designs - len(known.genes))
        drawn = next_generation(
            genes, known.genes, known.costs, known.missed, many, (study.config.seed, number)
        )
    assert known is not None
    return known, {"model": study.config.contact_model, "designs": len(known.genes), "stopped": why}


def _choices(study: Study) -> dict[str, Factor]:
    return {name: study.drawn.factors[name] for name in study.drawn.meta["outer"]}


def _reported(
    search: _CandidateSearch, decided: Judged, facts: dict[str, Any], tell: Tell
) -> Ledger:
    """Polish the recommended candidate, solve the optima at reference, and gather all."""
    study = search.study
    choices = _choices(study)
    usable = decided.violation.min() < 1  # a candidate that is never valid is no optimum
    candidates = decided
    reached: dict[str, bool] = {}
    if usable:
        candidates, reached = _with_corners(search, decided, choices)
    front = np.flatnonzero(nondominated_ranks(candidates.costs, candidates.missed) == 0)
    best = candidates.take(front)
    chosen = recommended(best)
    corners = [best_in(best, goal) for goal in range(best.costs.shape[1])]
    optima: list[dict[str, Any]] = []
    neighbours: list[dict[str, Any]] = []
    if usable:
        shown = np.union1d(spread(best.costs, REPORTED), [chosen, *corners])
        optima = _optima(search, best.take(shown), front[shown])
        neighbours = _neighbours_of(search, choices, best.genes[chosen])
        polished = len(candidates.genes) - len(decided.genes)
        beside = f"{polished} polished designs, {len(neighbours)} neighbours"
        tell(f"solved beside the budget: {beside}, {len(optima)} optima at reference")
    else:
        tell("no design is valid, so there is no optimum to check")
    record = facts | {
        "goals": dict(candidates.goals),
        "front": len(front),
        "recommended": int(front[chosen]),
        "polished": reached.get("", False),
        "corners": [
            {"goal": name, "design": int(front[row]), "solved": reached.get(name, False)}
            for name, row in zip(candidates.goals, corners, strict=True)
        ],
        "optima": optima,
        "neighbours": neighbours,
    }
    with search.runner.solved(search.of(study, candidates.genes)) as ledger:
        gather(ledger, tell, {OPTIMUM: json.dumps(record)})
    return ledger


def _optima(
    search: _CandidateSearch, candidates: Judged, numbers: np.ndarray
) -> list[dict[str, Any]]:
    """Solve candidates at `reference`, and return the record of each; `numbers` are theirs among
    all gathered candidates.
    """
    exact = {"accuracy": "reference"}
    if search.study.config.contact_model == TABLE:
        exact["contact_model"] = ELEMENTS
    checked = search.judged(_with(search.study, **exact), candidates.genes)
    return [
        {"design": int(number)} | _optimum(candidates.take(row), checked.take(row))
        for number, row in zip(numbers, np.arange(len(numbers))[:, None], strict=True)
    ]


def _neighbours_of(
    search: _CandidateSearch, choices: Mapping[str, Factor], genes: np.ndarray
) -> list[dict[str, Any]]:
    """Solve the candidates that a tolerance makes of one, and return the record of each."""
    around = _neighbours(choices, genes)
    if not around:
        return []
    moved = search.judged(search.study, np.array([own for *_, own in around]))
    return [
        {"choice": name, "step": step} | _neighbour(moved.take(np.array([i])))
        for i, (name, step, _) in enumerate(around)
    ]


def _optimum(of_search: Judged, checked: Judged) -> dict[str, Any]:
    """Return the record of one candidate as the search solved it, and at `reference`."""
    ends = (of_search, checked)
    return {
        "values": of_search.values[0].tolist(),
        "reference": checked.values[0].tolist(),
        "violation": [float(one.violation[0]) for one in ends],
        "short": [float(one.short[0]) for one in ends],
        "share": [float(one.share[0]) for one in ends],
        "required": [one.required[0].tolist() for one in ends],
    }


def _neighbour(candidate: Judged) -> dict[str, Any]:
    """Return the record of one candidate beside the recommended one."""
    return {
        "values": candidate.values[0].tolist(),
        "violation": float(candidate.violation[0]),
        "short": float(candidate.short[0]),
        "life": float(candidate.life[0]),
    }


def _with_corners(
    search: _CandidateSearch, decided: Judged, choices: Mapping[str, Factor]
) -> tuple[Judged, dict[str, bool]]:
    """Add candidates about the recommended one, then about the best one in each of several goals.

    Returns
    -------
    All candidates, and whether no step improves the candidate any more: by goal, and `""` for the
    recommended one.
    """
    reached = {}
    decided, reached[""] = _polished(search, decided, choices, None)
    goals = list(decided.goals)
    if len(goals) == 1:
        return decided, reached | {goals[0]: reached[""]}
    for number, goal in enumerate(goals):
        if _is_spent(search, decided):
            reached[goal] = False
        else:
            decided, reached[goal] = _polished(search, decided, choices, number)
    return decided, reached


def _is_spent(search: _CandidateSearch, decided: Judged) -> bool:
    """Return whether the hours of the budget are spent."""
    hours = search.study.config.budget.hours
    return (
        hours is not None and search.ledger(search.of(search.study, decided.genes)).hours >= hours
    )


def _polished(
    search: _CandidateSearch, decided: Judged, choices: Mapping[str, Factor], goal: int | None
) -> tuple[Judged, bool]:
    """Add candidates about the best one in a goal, or about the recommended one, from the best one
    found so far.

    The ends of each range come first, then steps that fall. A step is taken again from the
    candidate that it has found, some times at most.

    Returns
    -------
    All candidates, and whether neither an end nor the smallest step improves the last one.
    """
    repeated = CORNER_REPEATED
    if goal is None:
        repeated = REPEATED
    rounds = [None, *POLISH_STEPS, None]
    for step in (step for step in rounds for _ in range(repeated)):
        middle = _leader(decided, goal)
        if step is None:
            beside = _ends(choices, middle)
        else:
            beside = _steps(choices, middle, step)
        known = {row.tobytes() for row in decided.genes}
        tried = [genes for genes in beside if genes.tobytes() not in known]
        if tried:
            decided += search.judged(search.study, np.array(tried))
    middle = _leader(decided, goal)
    around = [*_ends(choices, middle), *_steps(choices, middle, POLISH_STEPS[-1])]
    known = {row.tobytes() for row in decided.genes}
    return decided, all(genes.tobytes() in known for genes in around)


def _leader(candidates: Judged, goal: int | None) -> np.ndarray:
    """Return the genes of the best candidate in a goal, or of the recommended one."""
    ranks = nondominated_ranks(candidates.costs, candidates.missed)
    front = candidates.take(np.flatnonzero(ranks == 0))
    if goal is None:
        row = recommended(front)
    else:
        row = best_in(front, goal)
    return np.asarray(front.genes[row])


def _top(factor: Factor) -> float:
    """Return the largest value of the gene of a choice."""
    if factor.discrete:
        return len(factor.levels) - 1
    return 1.0


def _ends(choices: Mapping[str, Factor], middle: np.ndarray) -> list[np.ndarray]:
    """Return the candidates that one choice takes to an end of its range, or to another
    category.
    """
    ends = []
    for j, factor in enumerate(choices.values()):
        places = [0.0, _top(factor)]
        if not factor.ordered:
            places = []
            if len(factor.levels) <= MOST_CATEGORIES:
                places = list(np.arange(len(factor.levels), dtype=float))
        ends += [_moved(middle, j, place) for place in places]
    return ends


def _steps(choices: Mapping[str, Factor], middle: np.ndarray, step: float) -> list[np.ndarray]:
    """Return the candidates a step beside one in each ordered choice; a listed choice moves to its
    next level.
    """
    steps = []
    for j, factor in enumerate(choices.values()):
        size = step
        if factor.discrete:
            size = 1.0
        if factor.ordered:
            steps += [
                _moved(middle, j, float(np.clip(middle[j] + way, 0, _top(factor))))
                for way in (-size, size)
            ]
    return steps


def _moved(genes: np.ndarray, place: int, value: float) -> np.ndarray:
    """Return the genes of a candidate with another value of one of them."""
    other = genes.copy()
    other[place] = value
    return other


def _neighbours(
    choices: Mapping[str, Factor], genes: np.ndarray
) -> list[tuple[str, str, np.ndarray]]:
    """Return the candidates that a tolerance makes of one: choice, change in words and genes."""
    out = []
    for j, (name, factor) in enumerate(choices.items()):
        if factor.discrete:
            continue
        low, high = factor.numbers
        if name in PARAMETERS and PARAMETERS[name].unit == "mm":
            size = TOLERANCE
        else:
            size = abs(high - low) / 100
        value = float(factor.from_unit(genes[j : j + 1])[0])
        for side in (-1, 1):
            to = np.clip(value + side * size, min(low, high), max(low, high))
            moved = genes.copy()
            if factor.kind == "uniform":
                moved[j] = (to - low) / (high - low)
            else:
                moved[j] = np.log(to / low) / np.log(high / low)
            if moved[j] != genes[j]:
                out.append((name, f"{to - value:+.3g}", moved))
    return out
