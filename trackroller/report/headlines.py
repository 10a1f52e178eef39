"""The headline of an answer: one template a question, at most 40 words, from the record alone.

What does not fit a template stands in the table. A text that the record holds (`where`, `binds`) is
said if it has at most eight words. Lives are written with their years if `Answer.facts` holds
`duty` (hours a day and days a year).

Keys of `Answer.headline`; a key that is missing, None, NaN or empty is left out of the words:

`decide`, by `Answer.kind` (`build`, `a_or_b`, `none`, `measure`, `give`, `solve_finer`,
`cannot_tell`)

=================  =================================================================================
`names`            list of dict: name of a column of role `name` -> level of the named candidates;
                   only choices that differ between them and the rest; the first one is the leader
                   (of `none` empty)
`goals`            list of {words, units, value}: goals that are no choices, of the leader
`shared`           of `a_or_b`: choices that the named candidates have in common, and others lack
`low`, `high`      of the leader's required output at its worst condition [unit of `Answer.output`]
`worst`            levels of that condition in words (stands in the table)
`ends`, `ends_high`  limit that ends it, in words that follow "then": "fatigue", "wear"
`body`             `roller`, `guide` or ''
`line_low`, `line_high`  tests that both ends of its life by fatigue follow from: "bending line",
                   "rolling-contact line"; '' where its material has no others
`error`            told error of the leader's output [1]
`extrapolated`     whether the leader's life lies beyond its data
`not_held`         {count, of, where}: conditions in which the model judges all candidates and none
                   holds, out of the judged ones; `where` as "all 12 driven at friction 0.05"
`why`              of `cannot_tell`: a key of `CAUSES`
`not_judged`       {count, of, where}: conditions that no candidate surely holds, and in which the
                   model cannot judge some candidate
`elsewhere`        whether the leader holds all other conditions, so that the headline says
                   "elsewhere"
`exceeded`         {limit, body, use [1], hours}: the worst check of the leader above 100 %
`second`           {limit, verdict, low, high}: second model ("rating") that turns the leader's
                   verdict; a state of `STATES`; its life at the worst condition [h]
`earlier`          {limit, body, low, high}: first limit of the leader, where a life by fatigue is
                   required and this limit comes before it; its life at the worst condition [h]
`measure`          {what, of, on, turn, units, low, high}: placeholder, its material, the other one,
                   where the leader turns, and its range
`give`             {what}: load that was not given, in words: "the motor force"
`nearest`          {name (as one of `names`), holds, judged, of, meets, perhaps, low, fails,
                   fails_counted}:
                   `meets` and `perhaps` count the conditions that surely meet it and that may;
                   `judged` those that the model judges; `fails` says where it surely fails, in
                   words, or counts the causes (`fails_counted`); `cause` why it holds nowhere
                   ("skids"), '' otherwise
`up_to`, `from_on`  levels of the single numeric choice between which all conditions meet the
                   requirement
`share`, `share_low`, `share_high`  share of the drawn conditions that meets it, Wilson's interval
                   [1]
`share_short`, `share_long`  the same share by both ends of each life, with its error [1]; said
                   where the ends follow from different tests
`wanted`, `n`, `judged`  share that is wanted [1]; drawn conditions; those that the model judges
=================  =================================================================================

`how sure`, by `Answer.kind` (`share`, `count`, `cannot_tell` with `why`): `share`, `share_low`,
`share_high`, `wanted`, `n` of drawn conditions, or `meets`, `of` of listed loads, and `judged` of
both; and `low`, `high`, `ends`, `ends_high`, `body`, `line_low`, `line_high`, `error`,
`extrapolated`, `exceeded`, `second`, `not_held` as above.

`what matters`: `factors`, a list of at most two dicts, the largest first: `title`, `units`,
`index`, `index_low`, `index_high` [1] (NaN without indices), `height` (as a factor), `from`, `to`
(levels at the smallest and the largest end of the curve), `at_from`, `at_to` [unit of the output],
`by_ratio` (whether `height` is a factor, otherwise it is a difference [unit of the output]),
`largest` (of a group of factors, the title of the one that the curve is of); `asked`: the same of a
factor that the study asks for; with a requirement `meets`, `perhaps`, `of`: cases that surely meet
it, cases that may, all cases.

`which model`: `changes`: ``, `verdict`, `order` or `verdict and order`; `models`: list of dict
`model`, `verdict`, `low`, `high`, `error`, `leader` (a dict as one of `names`); `smallest`,
`largest` ratio on like rows to the model `base`; `base_by`: models that solved its cases, where
they are others.

`best`, by `Answer.kind` (`one`, `front`, `front_required`; `solve_finer`, `open`, `none` with
`nearest`, of `open` also `measure` as above): `designs`, a list of dict: `name` (as one of
`names`), `at` (`corner`, `knee` or ''), `goals` and `required` (lists of {words, units, value};
`required` holds outputs of requirements that are no goals; a goal with `is_choice` stands in the
name), `stopped` (search stopped before this end); `binds` (requirement, limit or end of a range in
words), `accuracy` (of these numbers), `extrapolated`, `exceeded`, `second`, and of drawn conditions
`share`, `share_low`, `share_high`, `wanted`, `n` as above.

`roller`, `spectrum`, `wear`, `carriage`: see `roller_answer`, `spectrum_answer`, `wear_answer` and
`carriage_answer` in `trackroller.results`.

`how it behaves`: `smallest`, `largest` [unit of the output], `at_smallest`, `at_largest` (levels in
words), `ends` (list of {limit, body, count}), `of` (cases), `lost` (cases without the output),
`ends_low`."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from trackroller.errors import listing
from trackroller.parameters.carriage_fields import parameter_of
from trackroller.report.bounds import bounds_of_output
from trackroller.report.numbers import (
    NOT_HELD,
    as_required,
    capital,
    carried,
    carried_range,
    grouped,
    level_text,
    long_name,
    lowered,
    may_be_lost,
    on_duty,
    percent,
    plain,
    unit_text,
    years_of,
)
from trackroller.results.answer import Answer, Caution, Column, Required
from trackroller.results.life_columns import OF_PAIR
from trackroller.roller.output_names import body_of
from trackroller.study.design.levels import NAMED

MOST_WORDS = 40
MOST_NAMES = 3  # candidates, or models, that a headline names
NAME_WORDS = 10  # of the choices of a candidate; the others stand in the table
SHORT = 8  # words of a text from the record that a headline repeats


@dataclass(frozen=True)
class Headline:
    """A headline: the answer itself, and what follows it."""

    lead: str
    ending: str = ""

    @property
    def text(self) -> str:
        """Return the whole headline."""
        return self.lead + self.ending


def headline_of(answer: Answer) -> Headline:
    """Return the headline of an answer.

    Parameters
    ----------
    answer : Answer
        The record; the keys of its `headline` stand at the top of this module.

    Raises
    ------
    KeyError
        If this room has no template for the question or the kind of the answer.
    """
    with on_duty(answer.facts.get("duty")):
        return TEMPLATES[answer.question](answer)


def decide(answer: Answer) -> Headline:
    """Say which candidate to build, or why the study cannot say so."""
    head = answer.headline
    lead = DECISIONS[answer.kind](answer)
    lost = _lost(head)
    if lost and head.get("elsewhere") and answer.kind in ELSEWHERE:
        lead = capital(f"{listing(lost)}; elsewhere {ELSEWHERE[answer.kind](answer)}")
        value = f"{_value_said(answer)}{_lines(head)}"
        clauses = [value, *_goal_clauses(head), *_other_rules(head)]
        return Headline(lead, f": {'; '.join(clauses)}.")
    shares = _known(head, "share") and bool(answer.required)
    if shares and answer.kind != "none":
        clauses = _shares(answer)
    else:
        clauses = _lasts(answer)
    return _joined(lead, [*_up_to(answer), *clauses, *_nearest(answer)])


def _lost(head: Mapping[str, Any]) -> list[str]:
    """Return in how many judged conditions no candidate holds, and how many are not judged."""
    failed = head.get("not_held")
    unknown = head.get("not_judged")
    texts = []
    if failed:
        what = "conditions"
        if unknown:
            what = "judged conditions"
        texts.append(f"none holds in {_part(failed, what)}")
    if unknown:
        verb = "are"
        if unknown["count"] == 1:
            verb = "is"
        texts.append(f"{_part(unknown, 'conditions')} {verb} not judged")
    return texts


def _build(answer: Answer) -> str:
    return f"Build {_leader(answer)}"


def _leader(answer: Answer) -> str:
    """Return the name of the leader; one candidate has none."""
    return _name(answer, _first(answer.headline.get("names"))) or "it"


def _a_or_b(answer: Answer) -> str:
    return capital(_either(answer))


def _either(answer: Answer) -> str:
    """Return the candidates of which none beats the other."""
    names = list(answer.headline["names"])
    spoken = _alternatives(answer, names[:MOST_NAMES])
    left = len(names) - MOST_NAMES
    if left > 0:
        spoken += f" or {left} more"
    shared = answer.headline.get("shared")
    return f"{spoken}, {_name(answer, shared)}" if shared else spoken


def _none(answer: Answer) -> str:
    verb = _verb_of_requirement(answer.required)
    lead = "None holds every condition"
    if verb:
        lead = f"None {verb}"
    nearest = answer.headline.get("nearest")
    if nearest:
        return f"{lead}; nearest {_name(answer, nearest['name'])}"
    return lead


def _measure(answer: Answer) -> str:
    measure = answer.headline.get("measure")
    if not measure:
        return f"Open whether {_leader(answer)} meets it"
    return f"Measure the {ranged_value(measure)}"


def ranged_value(measure: Mapping[str, Any]) -> str:
    """Return a value that is known within a range: its name, material and range."""
    of = ""
    if measure.get("of"):
        of = f" of {measure['of']}"
    if measure["what"] == "tests":
        return f"S-N line{of} (band of its tests)"
    on = ""
    if measure.get("on"):
        on = f" on {measure['on']}"
    ends = []
    if _known(measure, "low") and _known(measure, "high"):
        ends = [f"{grouped(measure['low'], 2)} to {_with_unit(measure['high'], measure)}"]
    return _noted(f"{plain(measure['what'])}{of}{on}", ends)


def _with_unit(value: float, measure: Mapping[str, Any]) -> str:
    """Return a value of a placeholder with its unit."""
    text = grouped(value, 2)
    if measure.get("units") in (None, "", "1", "-"):
        return text
    return f"{text} {unit_text(measure['units'])}"


def _give(answer: Answer) -> str:
    head = answer.headline
    lead = f"Give {head['give']['what']}"
    if head.get("not_held"):
        what = "conditions"
        if head.get("not_judged"):
            what = "judged conditions"
        lead += f": without it {_part(head['not_held'], what)} are lost"
    return lead


def _solve_finer(answer: Answer) -> str:
    return (
        f"Solve finer: only the error leaves {_name(answer, _first(answer.headline['names']))} open"
    )


def _cannot_tell(answer: Answer) -> str:
    head = answer.headline
    if head.get("not_judged"):
        return f"Cannot tell: the model does not judge {_part(head['not_judged'], 'conditions')}"
    if head.get("why") in CAUSES:
        return f"Cannot tell: {CAUSES[head['why']]}"
    return "Cannot tell"


CAUSES = {
    "model": "the model does not judge every condition of a candidate",
    "conditions": "candidates share no condition",
    "materials": "a material lacks the life that others have",
}


DECISIONS: dict[str, Callable[[Answer], str]] = {
    "build": _build,
    "a_or_b": _a_or_b,
    "none": _none,
    "measure": _measure,
    "give": _give,
    "solve_finer": _solve_finer,
    "cannot_tell": _cannot_tell,
}


# behind "elsewhere"
ELSEWHERE: dict[str, Callable[[Answer], str]] = {"build": _leader, "a_or_b": _either}


def _lasts(answer: Answer) -> list[str]:
    """Return what the leader lasts, what ends it, what other rules say of it, and what is
    required.
    """
    head = answer.headline
    clauses = []
    tenth = _tenth(answer)
    if tenth and answer.kind not in SILENT:
        clauses.append(f"{tenth} in nine of ten drawn conditions{_then(head)}")
    elif _known(head, "low") and answer.kind not in SILENT and _has_leader(answer):
        whose = ""
        if answer.kind in ("a_or_b", "measure", "give"):
            whose = f"{_leader(answer)} "
        place = " at its worst condition"
        if _one_condition(answer):
            place = ""
        clauses.append(f"{whose}{_at_worst(answer)}{place}{_then(head)}")
        if answer.kind in ELSEWHERE:
            clauses += _goal_clauses(head)
    clauses += _turn(head)
    if answer.kind == "cannot_tell":
        others = []
    else:
        others = _other_rules(head)
    return [*clauses, *others, *_required(answer)]


SILENT = ("none", "cannot_tell")  # kinds without a leader


def _has_leader(answer: Answer) -> bool:
    """Return whether a design can be spoken of: none can where a load is asked for and no design
    holds.
    """
    return answer.kind != "give" or bool(answer.headline.get("names"))


def _one_condition(answer: Answer) -> bool:
    conditions = answer.facts.get("conditions")
    return conditions in (1, [1, 1], (1, 1))


def _goal_clauses(head: Mapping[str, Any]) -> list[str]:
    """Return the goals that the leader follows beside the requirement."""
    goals = head.get("goals")
    if not goals:
        return []
    return [listing([_goal(one) for one in goals])]


def _tenth(answer: Answer) -> str:
    """Return what nine of ten drawn conditions of the leader reach; '' for listed conditions."""
    if not answer.facts.get("drawn") or "tenth" not in answer.table or answer.table.empty:
        return ""
    tenth = float(answer.table["tenth"].iloc[0])
    if math.isnan(tenth):
        return ""
    return _output(answer, tenth, None, _notes(answer.headline))


def _shares(answer: Answer) -> list[str]:
    """Return the share of the drawn conditions that meets the requirement."""
    head = answer.headline
    share = (
        f"{_share(head)} of {head['n']:,} drawn conditions {_reach(answer.required)}{_beyond(head)}"
    )
    notes = []
    if _known(head, "wanted"):
        notes = [f"{percent(head['wanted'])} are wanted"]
    return [share, *notes, *_not_judged_draws(head), *_other_rules(head)]


def _not_judged_draws(head: Mapping[str, Any]) -> list[str]:
    """Return how many drawn conditions the model does not judge; their lives count as missed."""
    if not _known(head, "judged") or head["judged"] == head["n"]:
        return []
    return [f"{head['n'] - head['judged']:,} of them not judged"]


def _up_to(answer: Answer) -> list[str]:
    """Return between which levels of a single choice all conditions meet the requirement."""
    head = answer.headline
    column = next((one for one in answer.columns if one.role == "name"), None)
    if column is None or not (_known(head, "up_to") or _known(head, "from_on")):
        return []
    title = lowered(column.title)
    ends = [_level(column, head[key]) for key in ("from_on", "up_to") if _known(head, key)]
    if len(ends) == 2:
        return [f"every condition meets it for {title} {' to '.join(ends)}"]
    word = "from"
    if _known(head, "up_to"):
        word = "up to"
    return [f"every condition meets it {word} {title} {ends[0]}"]


def _nearest(answer: Answer) -> list[str]:
    """Return what the nearest candidate holds and meets where none meets the requirement."""
    near = answer.headline.get("nearest")
    if answer.kind != "none" or not near:
        return []
    if answer.required:
        clauses = _reached(near)
    else:
        clauses = [f"holds {near['holds']} of {near['of']} conditions{_judged_of(near)}"]
    if _known(near, "low") and near["low"] > 0 and near["holds"] == near["of"]:
        clauses[0] += f", {_output(answer, near['low'])} at the worst"
    fails = _short(near.get("fails"))
    if near.get("cause"):
        return [*clauses, f"{near['cause']} everywhere"]
    if fails == "everywhere":
        return [*clauses, "fails everywhere"]
    if fails and near.get("fails_counted"):
        return [*clauses, fails]
    if fails:
        return [*clauses, f"fails at {fails}"]
    return clauses


def _reached(near: Mapping[str, Any]) -> list[str]:
    """Return in how many conditions the nearest design meets the requirement."""
    return [f"meets {_met_count(near)} of {near['of']} conditions{_judged_of(near)}"]


def _judged_of(head: Mapping[str, Any]) -> str:
    """Return how many conditions the model judges, behind a count of all of them; '' for all."""
    if not _known(head, "judged") or head["judged"] == head["of"]:
        return ""
    return f", {head['judged']:,} of them judged"


def _met_count(head: Mapping[str, Any]) -> str:
    """Return how many meet the requirement: '7', or '7 to 9' where a range leaves some open."""
    least = f"{head['meets']:,}"
    if _known(head, "perhaps") and head["perhaps"] > head["meets"]:
        return f"{least} to {head['perhaps']:,}"
    return least


def _turn(head: Mapping[str, Any]) -> list[str]:
    """Return where a placeholder turns the answer."""
    measure = head.get("measure")
    if not measure or not _known(measure, "turn"):
        return []
    return [f"the answer turns at {_with_unit(measure['turn'], measure)}"]


def how_sure(answer: Answer) -> Headline:
    """Say which share of the conditions, or how many of the listed loads, meet the requirement."""
    head = answer.headline
    if answer.kind == "cannot_tell":
        return Headline(_cannot_tell(answer), ".")
    if _known(head, "share"):
        lead = f"{_share(head)} of the {head['n']:,} drawn conditions {_reach(answer.required)}"
        notes = []
        if _known(head, "wanted"):
            notes = [f"{percent(head['wanted'])} are wanted"]
        clauses = [*notes, *_not_judged_draws(head), *_worst(answer), *_other_rules(head)]
        end = "."
        if clauses:
            end = f"; {'; '.join(clauses)}."
        return Headline(lead, end)
    named = _name(answer, _first(head.get("names")))
    count = f"{head['meets']:,} of {head['of']:,} loads{_judged_of(head)}"
    lead = capital(f"{named} meets {count}".strip())
    return _joined(lead, [*_worst(answer), *_other_rules(head), *_required(answer)])


def _worst(answer: Answer) -> list[str]:
    head = answer.headline
    if not _known(head, "low"):
        return []
    return [f"{_at_worst(answer)} at the worst{_then(head)}"]


def _at_worst(answer: Answer) -> str:
    """Return the value of the leader at its worst condition, or why it has none there: an output
    that is no life has no value where the roller does not roll.
    """
    head = answer.headline
    ends = [head["low"], head.get("high", head["low"])]
    if may_be_lost(answer.question, answer.output[2]) and any(map(math.isinf, ends)):
        return str(head.get("ends") or NOT_HELD)
    return _value_said(answer)


def what_matters(answer: Answer) -> Headline:
    """Say the two largest factors, and from what to what the larger one takes the output."""
    head = answer.headline
    words = lowered(answer.output[1])
    factors = list(head.get("factors", ()))
    if not factors:
        return Headline(f"No factor changes the {words}", ".")
    verb = "decide"
    if len(factors) == 1:
        verb = "decides"
    lead = capital(f"{listing([lowered(one['title']) for one in factors])} {verb} the {words}")
    if _known(factors[0], "index") and _in_shares(answer):
        sizes = f"index {listing([_index(one) for one in factors])}"
    else:
        sizes = listing([_height(answer, one) for one in factors])
    clauses = [sizes, _effect(answer, factors[0])]
    if head.get("asked"):
        clauses.append(f"{lowered(head['asked']['title'])}: {_effect(answer, head['asked'])}")
    if answer.required and _known(head, "meets"):
        clauses.append(f"{_met_count(head)} of {head['of']:,} {_reach(answer.required)}")
    return _joined(lead, [clause for clause in clauses if clause])


def _height(answer: Answer, factor: Mapping[str, Any]) -> str:
    """Return by how much a factor changes the output: '×42', or 'by 3 N' where it is no ratio."""
    if factor.get("by_ratio", True):
        return f"×{grouped(factor['height'], 2)}"
    return f"by {_measured(grouped(factor['height'], 2), answer.output[2])}"


def _in_shares(answer: Answer) -> bool:
    """Return whether the index of an answer is a share; an effect is said by the height of its
    curve.
    """
    return any(column.name == "index" and column.kind == "share" for column in answer.columns)


def _index(factor: Mapping[str, Any]) -> str:
    index = percent(min(1.0, max(0.0, factor["index"])))
    if not _known(factor, "index_low"):
        return index
    ends = [f"{100 * min(1.0, max(0.0, factor[key])):.0f}" for key in ("index_low", "index_high")]
    return f"{index} ({' to '.join(ends)})"


def _effect(answer: Answer, factor: Mapping[str, Any]) -> str:
    if not _known(factor, "at_from") or factor.get("largest"):
        return ""  # the table says which member of a group the curve is of
    units = unit_text(factor.get("units", "")).replace("–", "")
    levels = [_plain_level(factor.get(key)) for key in ("from", "to")]
    ends = [carried(factor[key]) for key in ("at_from", "at_to")]
    unit = unit_text(answer.output[2]).replace("–", "")
    return f"{' → '.join(levels)} {units}".rstrip() + f": {' → '.join(ends)} {unit}".rstrip()


def which_model(answer: Answer) -> Headline:
    """Say whether the requirement or the order changes with the contact model."""
    head = answer.headline
    models = list(head.get("models", ()))
    changes = head.get("changes") or ""
    lead = {
        "": "Neither verdict nor order changes with the contact model",
        "verdict": "The verdict changes with the contact model, the order does not",
        "order": "The order changes with the contact model, the verdict does not",
        "verdict and order": "Verdict and order change with the contact model",
    }[changes]
    if not answer.required:
        lead = "The order is the same by each contact model"
        if changes:
            lead = "The order changes with the contact model"
    if changes:
        return _joined(lead, [_by_models(answer, models)])
    clauses = []
    if _known(head, "smallest"):
        ratio = carried_range(head["smallest"], head["largest"])
        by = ""
        if head.get("base_by"):
            by = f" (solved by {head['base_by']})"
        clauses.append(f"{lowered(answer.output[1])} {ratio} times that of {head['base']}{by}")
    return _joined(lead, clauses)


def _by_models(answer: Answer, models: Sequence[Mapping[str, Any]]) -> str:
    """Return leader and verdict by each model; a leader of all models is named once."""
    shown = models[:MOST_NAMES]
    leaders = [_name(answer, one.get("leader") or {}) for one in shown]
    if len(set(leaders)) == 1:
        first = ""
        if leaders[0] and answer.required:
            first = f"{leaders[0]} is "
        return first + ", ".join(_by_model(answer, one, "") for one in shown)
    return ", ".join(
        _by_model(answer, one, leader) for one, leader in zip(shown, leaders, strict=True)
    )


def _by_model(answer: Answer, model: Mapping[str, Any], leader: str) -> str:
    value = carried_range(
        model["low"], model.get("high", model["low"]), model.get("error", math.nan)
    )
    state = ""
    if answer.required and model.get("verdict"):
        state = str(model["verdict"])
    what = " ".join(text for text in (leader, state) if text)
    return f"{what} by {model['model']} ({_measured(value, answer.output[2])})".strip()


def best(answer: Answer) -> Headline:
    """Say the best design and what binds it, or the corners and the knee of a front."""
    head = answer.headline
    designs = list(head.get("designs", ()))
    if not designs:
        return _without_design(answer)
    if answer.kind == "front":
        return _front(answer, designs)
    first = designs[0]
    values = [one for one in (*first["goals"], *first["required"]) if not one.get("is_choice")]
    accuracy = ""
    if head.get("accuracy"):
        accuracy = f" at {head['accuracy']}"
    clauses = []
    if values:
        clauses = [f"{listing([_goal(one) for one in values])}{_beyond(head)}{accuracy}"]
    binds = _short(head.get("binds"))
    if binds:
        clauses.append(f"bound by {binds}")
    if _known(head, "share"):
        clauses += _shares(answer)
    else:
        clauses += [*_other_rules(head), *_required(answer)]
    return _joined(f"Build {_name(answer, first['name'])}", clauses)


def _without_design(answer: Answer) -> Headline:
    """Say how near a search came where no design surely meets the requirement."""
    near = answer.headline.get("nearest")
    if answer.kind == "none" or not near:
        return _joined(_none(answer), _nearest(answer))
    only = "Solve finer: only the error leaves"
    if answer.kind == "open":
        only = f"The range of the {lowered(answer.required[0].words)} leaves"
        if answer.headline.get("measure"):
            only = f"{capital(ranged_value(answer.headline['measure']))} leaves"
    return _joined(
        f"{only} {_name(answer, near['name'])} open", [*_reached(near), *_required(answer)]
    )


def _front(answer: Answer, designs: Sequence[Mapping[str, Any]]) -> Headline:
    count = {1: "one design", 2: "two designs"}.get(len(designs), "three designs")
    texts = []
    for design in designs[:3]:
        knee = ""
        if design.get("at") == "knee":
            knee = " (knee)"
        goals = ", ".join(_goal(one, units_only=True) for one in design["goals"])
        texts.append(f"{goals}{knee}")
    stopped = [design for design in designs if design.get("stopped")]
    tail = {0: "", 1: "; the search stopped before one corner"}.get(
        len(stopped), "; the search stopped before both corners"
    )
    return Headline(f"No requirement, {count}", f": {'; '.join(texts)}{tail}.")


def _goal(goal: Mapping[str, Any], units_only: bool = False) -> str:
    """Return a goal with its value; the words of a life are left to its hours."""
    value = carried(goal["value"])
    if goal["units"] == "h":
        return _noted(f"{value} h", [years_of(goal["value"])])
    text = _measured(value, goal["units"])
    if units_only and text != value:
        return text
    return f"{lowered(goal['words'])} {text}"


def how_it_behaves(answer: Answer) -> Headline:
    """Say the range of the output and what ends the cases."""
    head = answer.headline
    if not _known(head, "smallest"):
        return Headline("No case has a result that can be shown", ".")
    one = head["smallest"] == head.get("largest", head["smallest"])
    value = _value(answer, head["smallest"], head.get("largest"))
    where = [_short(head.get(key)) for key in ("at_smallest", "at_largest")]
    clauses = []
    if all(where) and not one:
        clauses.append(f"smallest at {where[0]}, largest at {where[1]}")
    return _joined(f"{capital(answer.output[1])} {value}", [*clauses, *_ends(head)])


def _ends(head: Mapping[str, Any]) -> list[str]:
    ends = list(head.get("ends", ()))
    if not ends:
        return []
    of = int(head.get("of", 0))
    if len(ends) == 1 and ends[0]["count"] == of:
        whole = "it"
        if of > 1:
            whole = "every case"
        return [f"{_end(ends[0])} ends {whole}"]
    texts = [f"{_end(one)} ends {one['count']:,}" for one in ends[:3]]
    return [f"{', '.join(texts)} of {of:,} cases"]


def _end(end: Mapping[str, Any]) -> str:
    if end.get("body"):
        return f"{end['limit']} of the {end['body']}"
    return str(end["limit"])


def roller(answer: Answer) -> Headline:
    """Say what ends one roller and when, or why it does not last; an exceeded limit comes first."""
    head = answer.headline
    if answer.kind in STOPS:
        return STOPS[answer.kind](answer)
    unsure = _if_model_holds(head)
    clauses = [*_open_limits(head), *_unknown_hours(answer), *_required_states(answer)]
    if answer.kind == "no_life":
        lasts = "no limit with hours is known"
    else:
        lasts = f"{_roller_life(answer)}{_first_limits(head)}"
    if not head["exceeded"]:
        text = f"{unsure}{lasts}"
        return Headline(capital(text), "".join(f"; {clause}" for clause in clauses) + ".")
    worst = head["exceeded"][0]
    hours = math.inf if worst["hours"] is None else worst["hours"]
    after = ""
    if math.isfinite(hours) and not hours > head["high"]:  # a later end says nothing
        after = f", after {grouped(hours, 2)} h by its rule"
    lead = f"{_limit_of(worst)} exceeded ({percent(worst['use'])})"
    return Headline(
        capital(lead),
        f"{after}. {capital(unsure + 'otherwise ' + lasts)}{''.join(f'; {c}' for c in clauses)}.",
    )


def _roller_life(answer: Answer) -> str:
    """Return the life of one roller with its years and whether it is extrapolated."""
    head = answer.headline
    notes = [
        word
        for word, true in (
            ("extrapolated", head["extrapolated"]),
            ("placeholders", head["guessed"]),
        )
        if true
    ]
    return _value(answer, head["low"], head["high"], notes)


def _first_limits(head: Mapping[str, Any]) -> str:
    """Return the limits that may end one roller first, behind its life."""
    if math.isinf(head["low"]):
        return ""
    if head["body"] == "pair":
        body = ""
    else:
        body = f" of the {head['body']}"
    return f", then {' or '.join(head['ends'])}{body}{_lines(head)}"


def _lines(head: Mapping[str, Any]) -> str:
    """Return the tests that both ends of a life by fatigue follow from, in brackets; '' where these
    are the only ones.
    """
    low = head.get("line_low")
    high = head.get("line_high")
    if low and high and low != high:
        return f" ({low} to {high})"
    if low and high:
        return f" (by the {low})"
    if low:
        return f" (low end by the {low})"
    if high:
        return f" (high end by the {high})"
    return ""


def _limit_of(one: Mapping[str, Any]) -> str:
    """Return a limit with its body; the pair is not named."""
    if one["body"] == "pair":
        return one["limit"]
    return f"{one['limit']} of the {one['body']}"


def _bodies_of(listed: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return the bodies of some limits, the roller first."""
    return sorted({one["body"] for one in listed}, reverse=True)


def _open_limits(head: Mapping[str, Any]) -> list[str]:
    """Return the limits that are exceeded at one end of a placeholder alone."""
    listed = head["open"]
    if not listed:
        return []
    named = ", ".join(_limit_of(one) for one in listed[:2])
    further = ""
    if len(listed) > 2:
        further = f" and {len(listed) - 2} more"
    return [f"open by placeholders: {named}{further}"]


def _unknown_hours(answer: Answer) -> list[str]:
    """Say whose hours are not known; they count for nothing then."""
    head = answer.headline
    clauses = []
    if head["unknown"]:
        clauses = [f"the hours of the {head['unknown']} are not known"]
    return clauses


def _required_states(answer: Answer) -> list[str]:
    """Return what is required of one roller, parted by whether it is met."""
    clauses = []
    for state in ("missed", "open", "met"):
        states = zip(answer.required, answer.headline["states"], strict=True)
        bounds = [_bound(one, answer) for one, own in states if own == state]
        if bounds:
            clauses.append(f"required {listing(bounds)}: {state}")
    return clauses


def _failed(answer: Answer) -> Headline:
    return Headline("No solution", f": {str(answer.facts['reason']).rstrip('.')}.")


def _lifts_off(answer: Answer) -> Headline:
    """Say between which axial forces both contacts carry."""
    head = answer.headline
    if not math.isfinite(head["axial_low"] + head["axial_high"]):
        return Headline("A contact lifts off", ".")
    ends = f"{grouped(head['axial_low'], 3)} to {grouped(head['axial_high'], 3)} N"
    return Headline("A contact lifts off", f": both contacts carry at an axial force of {ends}.")


def _breaks(answer: Answer) -> Headline:
    """Say which body breaks at once, and by how much."""
    broken = answer.headline["broken"]
    use = max(one["use"] for one in broken)
    bodies = listing(_bodies_of(broken))
    verb = "breaks"
    if len(broken) > 1 or " and " in bodies:
        verb = "break"
    lead = f"The {bodies} {verb} at once"
    end = "."
    if not math.isnan(use):
        end = f": peak stress {percent(use)} of what the material bears."
    return Headline(lead, end)


def _skids(answer: Answer) -> Headline:
    """Say between which motor forces the roller rolls."""
    head = answer.headline
    others = [
        f"friction transmits {grouped(head['motor_low'], 3)} to {grouped(head['motor_high'], 3)} N"
    ]
    if not math.isfinite(head["motor_low"] + head["motor_high"]):
        others = ["the motor force exceeds what friction transmits"]
    if answer.kind == "skids" and math.isfinite(head["low"]):
        others.append(f"{_roller_life(answer)}{_first_limits(head)}")
    if head["exceeded"]:
        worst = head["exceeded"][0]
        others.append(f"{_limit_of(worst)} exceeded ({percent(worst['use'])})")
    return Headline("The roller skids", f": {'; '.join(others)}.")


def spectrum(answer: Answer) -> Headline:
    """Say what ends the roller or the guide of a spectrum and when, and which block does most of
    it.
    """
    head = answer.headline
    clauses = []
    if answer.kind != "unknown":
        clauses = [f"the life of the {body} is not known" for body in head["unknown"]]
    clauses = [*_exceeded_in_blocks(head["exceeded"]), *_open_limits(head), *clauses]
    if answer.kind == "breaks":
        broken = head["broken"]
        bodies = listing(_bodies_of(broken))
        verb = "breaks"
        if len(_bodies_of(broken)) > 1:
            verb = "break"
        blocks = listing(list(dict.fromkeys(name for one in broken for name in one["blocks"])))
        return _joined(f"The {bodies} {verb} at once in {blocks}", clauses)
    if answer.kind == "unknown":
        return _joined("The life is not known", [*head["why"][:2], *clauses])
    unsure = _if_model_holds(head)
    for required, state in zip(answer.required, head["states"], strict=True):
        clauses.append(f"required {_amount(required, required.least)}: {state}")
    if answer.kind == "unlimited":
        return _joined(capital(f"{unsure}no limit ends this spectrum"), clauses)
    if head["block"]:
        clauses.insert(0, f"{percent(head['share'])} of it by {head['block']}")
    km = carried_range(head["km_low"], head["km_high"])
    text = f"{unsure}{_roller_life(answer)}, {km} km{_first_limits(head)}"
    return Headline(capital(text), "".join(f"; {clause}" for clause in clauses) + ".")


def wear(answer: Answer) -> Headline:
    """Say how deep a roller and its guide have worn after which travel, what becomes of the
    pressure, and the end.
    """
    head = answer.headline
    depths = [f"{body} {grouped(depth, 3)} µm" for body, depth in head["depths"].items()]
    worn = "neither body has worn"
    if depths:
        worn = f"{listing(depths)} worn"
    lead = f"{worn} after {grouped(head['travel'], 3)} km ({_hours_said(head['hours'])})"
    notes = []
    if head["guessed"]:
        notes = ["placeholders"]
    pressures = f"{grouped(head['pressure_first'], 3)} → {grouped(head['pressure_last'], 3)} MPa"
    clauses = [f"pressure of contact {head['contact']} {pressures}"]
    most = head["pressure_most"]
    if most > PEAK * max(head["pressure_first"], head["pressure_last"]):
        clauses[0] += f", {grouped(most, 3)} MPa at {grouped(head['travel_most'], 3)} km"
    fatigue = head["fatigue"]
    if fatigue:
        clauses.insert(
            0, f"fatigue ends the {fatigue['body']} after {grouped(fatigue['travel'], 3)} km"
        )
    if head["state"]:
        clauses.append(
            f"required {_amount(answer.required[0], answer.required[0].least)}: {head['state']}"
        )
    return _joined(_noted(capital(lead), notes), [*clauses, f"the run ends there: {head['end']}"])


def carriage(answer: Answer) -> Headline:
    """Say which roller of a carriage ends first and when, and up to which loads all rollers
    roll.
    """
    head = answer.headline
    margins = [
        f"{one['of']} × {grouped(one['times'], 3)} to {one['end']} ({one['case']})"
        for one in head["margins"]
        if one["times"] > 0  # otherwise the loads lift a contact already
    ]
    if answer.kind == "unsettled":
        return _joined(
            f"The forces in {listing(head['unsettled'])} are not known", ["more preload helps"]
        )
    if answer.kind == "lasts":
        return _carriage_lasts(answer, margins)
    if answer.kind == "unlimited":
        return _joined("No roller reaches a limit under these loads", margins)
    lead = "No roller carries a load"
    if _known(head, "force"):
        lead = (
            f"Roller {head['roller']} carries most, {grouped(head['force'], 3)} N in {head['case']}"
        )
    clauses = []
    if answer.kind == "no_life":
        clauses = ["the life of no roller is known"]
    return _joined(lead, [*clauses, *margins])


def _carriage_lasts(answer: Answer, margins: Sequence[str]) -> Headline:
    """Say which roller ends first; a limit that is exceeded comes before it."""
    head = answer.headline
    clauses = []
    if _known(head, "at_most"):
        lasts = f"roller {head['roller']} lasts {_at_most(head)}"
        clauses.append(f"not on both contacts in {head['not_on_both']}")
    else:
        life = _life_to_end(head)
        lasts = f"roller {head['roller']} ends first: {life}, {grouped(head['km'], 3)} km"
    lasts = f"{_if_model_holds(head)}{lasts}"
    if head["limit"]:
        clauses.append(f"then {head['limit']} of the {head['body']}{_lines(head)}")
    if _known(head, "part"):
        clauses.append(f"{percent(head['part'])} of it by {head['case']}")
    clauses += _unknown_lives(head)
    if head["state"]:
        of = ""
        if head["of"]:
            of = f" of {listing(head['of'])}"
        clauses.append(f"required {_bound(answer.required[0], answer)}{of}: {head['state']}")
        margins = ()  # its table has them
    if not head["exceeded"]:
        return _joined(capital(lasts), [*clauses, *margins])
    worst = head["exceeded"][0]
    if _known(worst, "km"):
        amount = f"{grouped(worst['km'], 2)} km"
    else:
        amount = f"{grouped(worst['hours'], 2)} h"
    after = ""
    if _known(worst, "km") or _known(worst, "hours"):
        after = f", after {amount} by its rule"
    lead = f"{capital(_limit_of(worst))} {worst['roller']} exceeded ({percent(worst['use'])})"
    return Headline(lead, f"{after}. {'; '.join([capital('otherwise ' + lasts), *clauses])}.")


def _unknown_lives(head: Mapping[str, Any]) -> list[str]:
    """Return the rollers of a carriage whose life is not known, and why, as at most one clause."""
    if not head["unknown"]:
        return []
    why = ""
    if head["unknown_in"] and not _known(head, "at_most"):
        why = f" (not on both contacts in {head['unknown_in']})"
    return [f"the life of {listing(head['unknown'])} is not known{why}"]


def end_of_carriage(answer: Answer) -> str:
    """Return the last line of a carriage: how long it lasts, and which roller or rail ends it by
    which limit.
    """
    head = answer.headline
    if answer.kind == "lasts" and _known(head, "at_most"):
        contacts = f"roller {head['roller']} is not on both contacts in {head['not_on_both']}"
        return f"The carriage lasts {_at_most(head)}: {contacts}."
    if answer.kind != "lasts" or not head["limit"]:
        return ""
    if head["body"] == "guide":
        place = f"the rail under roller {head['roller']}"
    else:
        place = f"roller {head['roller']}"
    reaches = f"then {place} reaches its first limit, {head['limit']}"
    bound = ""
    if head["unknown"]:
        bound = "at most "
    return f"The carriage lasts {bound}{_life_to_end(head)}: {reaches}."


def _at_most(head: Mapping[str, Any]) -> str:
    """Return the bound of a life of which the damage of some load cases is not known."""
    hours = f"{grouped(head['at_most'], 3)} h"
    return f"at most {_noted(hours, [years_of(head['at_most'])])}"


def _life_to_end(head: Mapping[str, Any]) -> str:
    """Return the range of a life in hours, with its years where the duty is known."""
    text = f"{carried_range(head['low'], head['high'])} h"
    return _noted(text, [years_of(head["low"], head["high"])])


def _if_model_holds(head: Mapping[str, Any]) -> str:
    """Return the condition of a life that the model does not judge; '' for one that it judges."""
    if not head["not_judged"]:
        return ""
    return f"if the model holds ({listing(head['not_judged'])}: not judged), "


PEAK = 1.01  # times the pressure at both ends, from which on a larger one between them is said


def _hours_said(hours: float) -> str:
    """Return hours with their years where the duty is known."""
    return ", ".join(filter(None, [f"{grouped(hours, 3)} h", years_of(hours)]))


def _exceeded_in_blocks(listed: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return the worst limit that blocks of a spectrum exceed, and how many more there are."""
    if not listed:
        return []
    worst = listed[0]
    use = ""
    if worst["use"] is not None and math.isfinite(worst["use"]):
        use = f" ({percent(worst['use'])})"
    further = ""
    if len(listed) > 1:
        further = f" and {len(listed) - 1} more"
    blocks = listing(list(worst["blocks"])[:MOST_NAMES])
    return [f"{_limit_of(worst)} exceeded{use} in {blocks}{further}"]


STOPS: dict[str, Callable[[Answer], Headline]] = {  # kinds of one roller without a usual life
    "failed": _failed,
    "lifts_off": _lifts_off,
    "breaks": _breaks,
    "skids": _skids,
}


TEMPLATES: dict[str, Callable[[Answer], Headline]] = {
    "decide": decide,
    "what matters": what_matters,
    "how sure": how_sure,
    "best": best,
    "which model": which_model,
    "how it behaves": how_it_behaves,
    "roller": roller,
    "spectrum": spectrum,
    "wear": wear,
    "carriage": carriage,
}
WARNING_HEADS = {
    "not_held": "Not held",
    "not_judged": "Not judged",
    "second_model": "Second model",
    "extrapolated": "Extrapolated",
    "worn": "Worn",
    "not_given": "Not given",
    "at_end": "At an end",
    "unlike": "Unlike",
    "guessed": "Guessed",
    "doubtful": "Doubtful",
    "flagged": "Flagged",
}


def warning_line(caution: Caution) -> str:
    """Return a warning in one line: its head, how many rows of how many, and where."""
    head = ", ".join(filter(None, [WARNING_HEADS[caution.code], warning_rows(caution)]))
    if caution.where:
        return f"{head}: {caution.where}"
    return head


def warning_rows(caution: Caution) -> str:
    """Return how many rows a warning concerns; nothing is counted where it concerns none."""
    if not caution.what:
        return ""
    if caution.of < 2 and caution.what != "cases":
        return "leader"
    return f"{caution.count:,} of {caution.of:,} {caution.what}"


def _joined(lead: str, clauses: Sequence[str]) -> Headline:
    """Return a headline of its lead and the clauses behind it."""
    if not clauses:
        return Headline(lead, ".")
    separator = ": "
    if ":" in lead:
        separator = "; "
    return Headline(lead, f"{separator}{'; '.join(clauses)}.")


def _known(head: Mapping[str, Any], key: str) -> bool:
    """Return whether a key holds a value."""
    value = head.get(key)
    if value is None:
        return False
    return not (isinstance(value, float) and math.isnan(value))


def _first(names: Any) -> Mapping[str, Any]:
    if names:
        return names[0]
    return {}


def _name(answer: Answer, name: Mapping[str, Any]) -> str:
    """Return a candidate by its levels: 'steel, groove 6.5 mm'."""
    columns = {column.name: column for column in answer.columns}
    texts = [key for key, level in name.items() if isinstance(level, str)]
    spoken = []
    for key, level in name.items():
        column = columns.get(key) or _column_of(key)
        alone = isinstance(level, str) and len(texts) == 1
        alone = alone or (key in NAMED and not isinstance(level, str))
        text = _level(column, level)
        if not alone:
            text = f"{lowered(column.title)} {text}"
        spoken.append(text)
    shown = spoken[:1]
    for text in spoken[1:]:
        if len(" ".join([*shown, text]).split()) > NAME_WORDS:
            break
        shown.append(text)
    left = len(spoken) - len(shown)
    further = ""
    if left:
        further = f" and {left} more"
    return ", ".join(shown) + further


def _column_of(key: str) -> Column:
    """Return the column of a choice that the table does not show."""
    known = parameter_of(key)
    if known is None or known.unit == "-":
        units = ""
    else:
        units = known.unit
    return Column(key, long_name(key), units, kind="level", role="name")


def _alternatives(answer: Answer, names: Sequence[Mapping[str, Any]]) -> str:
    """Return candidates that are equally good; the title of a single choice is said once."""
    columns = {column.name: column for column in answer.columns}
    keys = {key for name in names for key in name}
    if len(keys) == 1:
        key = keys.pop()
        column = columns.get(key)
        levels = [name[key] for name in names]
        if (
            column is not None
            and key not in NAMED
            and not any(isinstance(level, str) for level in levels)
        ):
            values = " or ".join(_plain_level(level) for level in levels)
            return f"{lowered(column.title)} {values} {unit_text(column.units)}".replace(
                " –", ""
            ).replace(" °", "°")
    return " or ".join(_name(answer, name) for name in names)


def _level(column: Column, level: Any) -> str:
    """Return a level with its unit."""
    if isinstance(level, bool):
        if level:
            return "yes"
        return "no"
    if column.name in NAMED or isinstance(level, str):
        return level_text(column.name, level)
    unit = unit_text(column.units).replace("–", "")
    return f"{_plain_level(level)} {unit}".strip().replace(" °", "°")


def _plain_level(level: Any) -> str:
    if isinstance(level, str):
        return level
    return grouped(float(level))


def _value_said(answer: Answer) -> str:
    """Return the value of the leader, with its years, and whether it is extrapolated."""
    head = answer.headline
    return _output(answer, head["low"], head.get("high"), _notes(head))


def _notes(head: Mapping[str, Any]) -> list[str]:
    """Return what stands in brackets behind a value: why nothing lasts, and whether the value is
    extrapolated.
    """
    if head.get("ends") and not head.get("body"):
        return [str(head["ends"])]
    if head.get("extrapolated"):
        return ["extrapolated"]
    return []


def _output(
    answer: Answer, low: float, high: float | None = None, notes: Sequence[str] = ()
) -> str:
    """Return a value of the output of an answer, or a range; hours alone are a life of the pair."""
    value = _value(answer, low, high, notes)
    if answer.output[2] == "h" and not body_of(answer.output[0]):
        return value
    return f"{lowered(answer.output[1])} {value}"


def _value(answer: Answer, low: float, high: float | None = None, notes: Sequence[str] = ()) -> str:
    """Return a value or a range with its unit, and its years and other notes in brackets."""
    if high is None or math.isnan(high):
        high = low
    bounds = bounds_of_output(answer)
    if math.isinf(low) and low > 0:
        return _noted("unlimited", notes)
    text = carried_range(low, high, answer.headline.get("error", math.nan), bounds)
    if answer.output[2] != "h":
        return _noted(_measured(text, answer.output[2]), notes)
    return _noted(f"{text} h", [years_of(low, high), *notes])


def _measured(text: str, units: str) -> str:
    """Return a number with its unit; a plain number has none."""
    unit = unit_text(units).replace("–", "")
    return f"{text} {unit}".strip().replace(" °", "°")


def _noted(text: str, notes: Sequence[str]) -> str:
    """Return a text with notes in brackets behind it; blank notes are left out."""
    words = ", ".join(note for note in notes if note)
    if words:
        return f"{text} ({words})"
    return text


def _beyond(head: Mapping[str, Any]) -> str:
    if head.get("extrapolated"):
        return " (extrapolated)"
    return ""


def _then(head: Mapping[str, Any]) -> str:
    """Return the limit that ends the leader; two where the ends of its range differ; '' where it
    does not roll.
    """
    if not head.get("ends") or not head.get("body"):
        return ""
    limits = dict.fromkeys([head["ends"], head.get("ends_high") or head["ends"]])
    return f", then {' or '.join(limits)} of the {head['body']}{_lines(head)}"


def _other_rules(head: Mapping[str, Any]) -> list[str]:
    """Return a second model that turns the verdict, a limit that comes before the required life,
    and the check that is exceeded most.
    """
    clauses = []
    second = head.get("second")
    if second:
        verb = {
            "met": "meets",
            "open": "leaves it open",
            "missed": "misses",
            "none": "does not judge",
        }
        life = []
        if second["verdict"] == "open" and _known(second, "low"):
            life = [f"{carried_range(second['low'], second['high'])} h"]
        clauses.append(_noted(f"the {second['limit']} {verb[second['verdict']]}", life))
    earlier = head.get("earlier")
    if earlier:
        hours = carried_range(earlier["low"], earlier["high"])
        clauses.append(f"{_limit_of(earlier)} comes first ({hours} h)")
    exceeded = head.get("exceeded")
    if exceeded:
        clauses.append(f"{exceeded['limit']} exceeded ({percent(exceeded['use'])})")
    return clauses


def _required(answer: Answer) -> list[str]:
    """Return what is required, as one clause."""
    if answer.kind in SILENT or not answer.required:
        return []
    return [f"required {listing([_bound(one, answer) for one in answer.required])}"]


def _bound(required: Required, answer: Answer) -> str:
    """Return a requirement with its unit, and with the words of its output where it is another than
    the table's; a single life of the pair needs no words.
    """
    lives = sum(one.units == "h" for one in answer.required)
    of_pair = required.output in OF_PAIR
    if required.output == answer.output[0] or (of_pair and lives == 1):
        words = ""
    else:
        words = f"{lowered(required.words)} "
    if math.isfinite(required.least) and math.isfinite(required.most):
        return f"{words}{grouped(required.least, 6)} to {_amount(required, required.most)}"
    if math.isfinite(required.most):
        return f"{words}at most {_amount(required, required.most)}"
    if words:
        words += "at least "
    return f"{words}{_amount(required, required.least)}"


def _amount(required: Required, value: float) -> str:
    text = _measured(as_required(value), required.units)
    years = ""
    if required.units == "h":
        years = years_of(value)
    return _noted(text, [years])


def _reach(required: Sequence[Required]) -> str:
    """Return the verb of conditions that meet a requirement: 'reach 5,000 h'."""
    if len(required) != 1:
        return "meet the requirements"
    one = required[0]
    if math.isfinite(one.least) and math.isfinite(one.most):
        return f"keep to {grouped(one.least, 6)} to {_amount(one, one.most)}"
    if math.isfinite(one.most):
        return f"stay within {_amount(one, one.most)}"
    return f"reach {_amount(one, one.least)}"


def _verb_of_requirement(required: Sequence[Required]) -> str:
    """Return the verb of one candidate that meets a requirement: 'reaches 5,000 h'; '' without a
    requirement.
    """
    if not required:
        return ""
    if len(required) > 1:
        return "meets the requirements"
    verb, amount = _reach(required).split(" ", 1)
    third = {"reach": "reaches", "stay": "stays", "keep": "keeps"}
    return f"{third[verb]} {amount}"


def _share(head: Mapping[str, Any]) -> str:
    if head.get("line_low") != head.get("line_high"):  # the ends of each life decide
        return f"{100 * head['share_short']:.0f} to {percent(head['share_long'])}"
    text = percent(head["share"])
    if not _known(head, "share_low"):
        return text
    ends = [f"{100 * head[key]:.0f}" for key in ("share_low", "share_high")]
    return f"{text} ({' to '.join(ends)})"


def _part(lost: Mapping[str, Any], what: str) -> str:
    """Return 'COUNT of ALL conditions', with the levels that hold them where they are short."""
    where = _short(lost.get("where"))
    place = ""
    if where:
        place = f" ({where})"
    return f"{lost['count']:,} of {lost['of']:,} {what}" + place


def _short(text: Any) -> str:
    """Return a text of the record if it is short, otherwise nothing: then it stands in the table
    alone.
    """
    if not isinstance(text, str) or len(text.split()) > SHORT:
        return ""
    return text
