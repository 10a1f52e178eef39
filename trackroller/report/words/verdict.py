"""The verdict of a study in words: what to build, measure or give, and why, in at most 120 words."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from trackroller.damage import LIMITS
from trackroller.damage.bearing import FIELD, WEIBULL, life_at
from trackroller.parameters import BODIES, PARAMETERS
from trackroller.report.numbers import (
    BEYOND,
    as_given,
    lasting,
    level_text,
    long_name,
    percent,
    plain,
    quantity,
    rounded,
    setting,
    shortened,
)
from trackroller.report.words.designs import (
    SAME,
    body_words,
    condition_words,
    design_words,
    ended_by,
    ends_text,
    ends_words,
    idle,
    lasting_one,
    roller_words,
    span_words,
    unanswered,
    worst_words,
)
from trackroller.report.words.pareto import holes_words, partly_holding
from trackroller.report.words.sentence import Sentence, say
from trackroller.results.by_tests import not_held
from trackroller.results.candidates import UNRANKED, Candidates
from trackroller.results.intervals import Cases
from trackroller.results.lives import OF_PAIR
from trackroller.results.results import Results
from trackroller.results.verdict import Candidate, Misses, Turn, Verdict
from trackroller.roller.dataset import validity_bit
from trackroller.roller.limit_notes import given_in_vain, guessed_lines, placeholders_of
from trackroller.roller.record import names_not_given
from trackroller.study.spectrum.file import TRAVEL

MOST = 3  # candidates that a sentence names
WORDS = 120  # of a verdict
LEAST_NEEDED = (
    "scatter",
    "next",
    "not_judged",
    "turn",
    "lives",
    "guessed",
    "out",
)  # kinds of sentences that also stand below, the first one least
SHORT = {"bearing": "bearing", "shakedown": "shakedown", "guide": "guide (give `guide_overrollings_per_hour`)"}
REASONS = {  # of `Cases.reason`, as what the candidate does
    "breaks": "breaks",
    "yields": "yields below its surface",
    "not converged": "has no solution",
    "life not known": "has no known life",
    "fatigue not known": "has no known life by fatigue",
    "outside the half-space": "lies outside the half-space",
    "conformal": "touches the edge of its groove",
    "steep friction": "may not roll steadily",
}


def verdict_sentences(results: Results) -> list[Sentence]:
    """Say the verdict of a study: first what to do, then why, what is left out, and what was not checked.

    Returns
    -------
    The sentences, the first one in a few words; none for a search.
    """
    found = results.verdict
    if found is None:
        return [] if results.config.method.proposes else [say("verdict", "no_goal")]
    words = _Words(results, found)
    said = [
        words.head(),
        *words.reasons(),
        words.tested(),
        words.not_held(),
        words.aside(),
        words.untried(),
        words.open_limits(),
        words.guessed(),
        words.bearings(),
        words.worn(),
        words.scatter(),
        words.unchecked(),
    ]
    return _fitting([sentence for sentence in said if sentence is not None])


def _fitting(said: list[Sentence]) -> list[Sentence]:
    """Return the sentences of a verdict within `WORDS`: what is least needed for the decision is left out first."""
    traded = any(sentence.kind == "tradeoff" for sentence in said)  # which asks for more than one life
    for kind in (*LEAST_NEEDED, *(("ends",) if traded else ())):
        if sum(len(sentence.text.split()) for sentence in said) > WORDS:
            said = [sentence for sentence in said if sentence.kind != kind]
    return said


class _Words:
    """The verdict with the study that it is about."""

    def __init__(self, results: Results, found: Verdict) -> None:
        self.results, self.found = results, found
        self.candidates = Candidates.grouped(results, found.goal)

    def name(self, one: Candidate) -> str:
        return design_words(self.candidates, one.choices) or "the roller"

    @property
    def compared(self) -> bool:
        """Return whether the study has a life or a stress that the candidates are compared by."""
        return self.found.goal != UNRANKED

    def span(self, one: Candidate) -> str:
        """Write both ends of a candidate's life, or its stress; '' without both."""
        unit = self.found.goal[2]
        if not self.found.goal_rises:
            return quantity(one.low, unit) if self.compared else ""
        return span_words(one, unit)

    @property
    def scattered(self) -> bool:
        """Return whether the lives hold the material's own scatter, so that nine of ten rollers reach them."""
        return self.found.sampled and Cases(self.candidates).scatter is not None

    def head(self) -> Sentence:
        """Say what to do."""
        found = self.found
        named = [self.name(one) for one in found.best]
        values = {"names": named, "tried": found.tried, "many": len(named), "tie": found.why == "tie"}
        what = [what_words(turn) for turn in found.turns]
        lives = self.span(found.best[0]) if found.best else ""
        who = lasting_one(self.candidates) if found.goal_rises else "roller"
        if found.why == "tie" and (free := self.without_effect()):
            shared = {n: v for n, v in found.best[0].choices.items() if n not in free}
            name = ", ".join(setting(n, v) for n, v in shared.items())
            return say("verdict", "any", name=name, free=[long_name(n) for n in free], many=len(named))
        values |= {"unlimited": bool(found.best) and math.isinf(found.best[0].low), "sampled": found.sampled}
        values |= {"scattered": self.scattered, "compared": self.compared}
        return say("verdict", found.kind, **values, what=what, lives=lives, who=who, rises=found.goal_rises)

    def without_effect(self) -> list[str]:
        """Return the choices in which the named candidates differ, if these are all levels of these choices."""
        rows = [one.choices for one in self.found.best]
        free = [name for name in rows[0] if any(row[name] != rows[0][name] for row in rows)]
        return free if math.prod(len(self.results.levels(name)) for name in free) == len(rows) else []

    def reasons(self) -> list[Sentence | None]:
        """Say why: lives, what ends them, what turns the decision, and the conditions that are left out."""
        found = self.found
        if found.kind == "cannot_tell" and found.why == "conditions":
            return [self.lives_of_cases(), unanswered(self.candidates)]
        if found.kind == "give":
            return [self.given(), self.out(found.out_of_reach), *self.rest()]
        if found.kind == "cannot_tell":
            known = {"sample": self.by_sample, "accuracy": self.by_error, "untried": self.where_tried}
            known |= {"materials": self.by_materials}
            return [known.get(found.why, self.by_model)()]
        if found.kind == "none":
            return [self.nearest() if found.candidates else self.nowhere()]
        if found.kind == "measure":
            return [self.range_of(), *map(self.turn, found.turns), self.out(found.out_of_reach)]
        return [self.ends(found.best[0]), self.following(), self.out(found.out_of_reach)]

    def lives_of_cases(self) -> Sentence | None:
        """State the lives of all cases, and what ends them if it is always the same; with a target that all meet it."""
        cases, own = Cases(self.candidates), self.results.of_one_model()
        rows = own & (cases.reason == "")
        if self.found.target:
            every = cases.on_target(exact=False)[1][own].all()
            return say("verdict", "all_meet", cases=int(own.sum()), target=self.target()) if every else None
        if not self.found.goal_rises or not rows.any():
            return None
        low, high = (end[rows] for end in cases.ends)
        ends = {
            (str(n), bool(g))
            for end in ("_low", "_high")
            for n, g in zip(*(v[rows] for v in cases.at_end(end)), strict=True)
        }
        limit, guide = ends.pop() if len(ends) == 1 else ("", False)
        values = {"limit": ended_by(limit), "body": BODIES[guide], "cases": int(rows.sum()), "of": int(own.sum())}
        beyond = (cases.beyond | cases.beyond_at_high)[rows]
        values["beyond"] = ("partly " * (not beyond.all()) + BEYOND) * bool(beyond.any())
        values["ranged"] = bool((high > low * (1 + SAME)).any())
        values["lives"] = ends_text(float(low.min()), float(high.max()), "", self.found.goal[2])
        values["model"] = self.results.held_level("contact_model") if "contact_model" in self.results.factors else ""
        return say("verdict", "lives", **values, who=lasting_one(self.candidates))

    def ends(self, one: Candidate) -> Sentence:
        """Say how long a candidate lasts, where, what ends it, and the target."""
        found = self.found
        said = {} if found.out_of_reach is None else found.out_of_reach.not_given
        not_given = {name: value for name, value in found.not_given.items() if name not in said}
        return say(
            "verdict",
            "ends",
            candidate=one,
            lives=self.span(one),
            interval=[rounded(end) for end in one.interval] if found.sampled else [],
            unit=found.goal[2],
            sampled=found.sampled,
            where=self.where(one),
            who=lasting_one(self.candidates),
            body=body_words(self.candidates, one),
            goal=found.goal[1],
            rises=found.goal_rises,
            limit=ends_words(one),
            target=self.target(),
            edges=[long_name(name) for name in one.edges] if found.kind == "build" else [],
            many=len(found.best),
            tie=found.why == "tie",
            repeats=found.kind == "lasts",
            unlimited=math.isinf(one.low),
            scattered=self.scattered,
            shared=bool(self.candidates.untried.any()),
            compared=self.compared,
            met=min(one.met for one in found.best),
            not_given=_values(not_given),
        )

    def where(self, one: Candidate) -> str:
        """Name the worst condition of a candidate."""
        return worst_words(self.candidates, one) if self.candidates.conditions else ""

    def target(self) -> str:
        """Write the targets of the study."""
        return targets_in_words(self.results, self.found.goal[2])

    def following(self) -> Sentence | None:
        """Name the next best candidate by the same measure."""
        one, found = self.found.next, self.found
        if one is None:
            return None
        others = [c for c in found.candidates[found.named :] if c.number != one.number and c.judged]
        if any(math.isclose(c.low, one.low, rel_tol=SAME) and c.met == one.met for c in others):
            return None  # of several alike none is the next
        values = {"candidate": one, "name": self.name(one), "lives": self.span(one), "holds": one.met == one.conditions}
        values |= {"target": bool(found.target), "ranged": one.high > one.low}
        return say("verdict", "next", **values)

    def causes(self, misses: Misses) -> list[str]:
        """Write why conditions are not met, the most frequent reason first; what ends a life too early is no reason."""
        words = []
        for word in (word for word in misses.reasons if word and word not in LIMITS):
            kind, _, name = word.partition(" ")
            if kind == "limit":
                words.append(f"exceeds the limit of {ended_by(name)}")
            elif kind == "target":
                several = len(self.found.target) > 1
                words.append("misses the target" + f" of its {self.results.quantity(name)[2]}" * several)
            else:
                words.append(REASONS.get(word, word))
        return words

    def out(self, misses: Misses | None) -> Sentence | None:
        """Name the conditions that no candidate meets, and why."""
        if misses is None or not misses.count:
            return None
        given = _values(misses.not_given) if self.found.kind != "give" else []
        values = {"where": _levels(misses), "why": self.causes(misses), "alone": len(self.candidates.size) == 1}
        return say("verdict", "out", misses=misses, **values, not_given=given)

    def nearest(self) -> Sentence:
        """Say that no candidate is enough, which one is nearest, and where it fails."""
        found, one = self.found, self.found.candidates[0]
        fails = found.fails or Misses(0, 0, {})
        alike = 0 if self.compared else sum(other.met == one.met for other in found.candidates[1:])
        values = {
            "candidate": one,
            "name": (self.name(one) + f" (and {alike} more)" * bool(alike)) if len(found.candidates) > 1 else "",
            "target": self.target(),
        }
        limits = [ended_by(word) for word in fails.reasons if word in LIMITS]
        life = (self.untried_life(one, alone=False) or self.span(one)) if one.low > 0 else ""
        values |= {"where": _levels(fails), "why": self.causes(fails), "limits": limits, "life": life}
        ended = one.low > 0 and one.case >= 0 and not values["why"]  # its life is told: that of one roller
        of_life = list(filter(None, [roller_words(self.results, one.case)])) if ended else []
        values |= {"not_given": _values(fails.not_given), "rollers": of_life or self.failing(one)}
        values |= {"many": len(found.candidates), "worst": self.where(one)}
        every = found.out_of_reach  # of conditions that the nearest design misses, all are hopeless if as many are
        values["every"] = every is not None and len(found.candidates) > 1 and every.count == fails.count
        values |= {"scattered": self.scattered, "alone": one.conditions == 1}
        values["ranged"] = bool(found.target) and one.high > one.low * (1 + SAME)
        return say("verdict", "nearest", **values, sampled=found.sampled)

    def failing(self, one: Candidate) -> list[str]:
        """Name the rollers of a carriage that keep a candidate from holding, with their load cases; some at most."""
        cases = Cases(self.candidates)
        good = cases.on_target(scattered=False)[1] if self.found.target else cases.reason == ""
        rows = np.flatnonzero((self.candidates.design == one.number) & ~good)
        named = list(dict.fromkeys(roller_words(self.results, int(row)) for row in rows))
        return named if all(named) and len(named) <= MOST else []

    def nowhere(self) -> Sentence:
        """Say that no case of a study whose designs cannot be compared meets the target, and what the best reaches."""
        found, lives, name = self.found, "", ""
        if found.longest >= 0:
            lives = quantity(float(self.results.column(found.goal[0])[found.longest]), found.goal[2])
            name = design_words(self.candidates, self.results.table.iloc[found.longest])
        fails = found.fails or Misses(0, 0, {})
        values = {"target": self.target(), "why": self.causes(fails), "lives": lives, "name": name}
        values |= {"not_given": _values(fails.not_given)}
        return say("verdict", "nowhere", cases=fails.of, **values)

    def by_error(self) -> Sentence:
        """Say that the error of the solution holds the target, and where."""
        found, one, own = self.found, self.found.best[0], Cases(self.candidates)
        low, high = (float(end[found.within_error]) for end in own.ends)
        values = {
            "name": self.name(one) if len(found.candidates) > 1 else "",
            "lives": ends_text(low, high, "", found.goal[2]),
            "error": float(own.error[found.within_error]),
            "where": condition_words(self.candidates, found.within_error) if self.candidates.conditions else "",
        }
        return say("verdict", "accuracy", **values, target=self.target(), accuracy=self.results.config.accuracy)

    def by_model(self) -> Sentence:
        """Say how far the designs come that the model judges, where only others may be enough."""
        found = self.found
        judged = [one for one in found.candidates if one.judged]
        best = max(judged, key=lambda one: (one.met, one.low if found.goal_rises else -one.low), default=None)
        name, lives = ("", "") if best is None else (self.name(best), self.span(best))
        values = {"many": len(judged), "target": self.target(), "holds": best is not None and best.low > 0}
        return say("verdict", "model", name=name, lives=lives, rises=found.goal_rises, **values)

    def by_materials(self) -> Sentence:
        """Say that stresses do not rank candidates of different materials, and name the first of each material."""
        found = self.found
        shown = [(self.name(one), self.span(one)) for one in found.best[:MOST]]
        values = {"shown": shown, "left": len(found.best) - len(shown), "goal": found.goal[1]}
        holds = len([one for one in found.candidates if one.status == "met"])
        return say("verdict", "materials", **values, target=self.target(), holds=holds)

    def where_tried(self) -> Sentence:
        """Say that a candidate meets the target under the conditions of a table that it was tried under."""
        one = self.found.best[0]
        return say("verdict", "where_tried", name=self.name(one), lives=self.span(one), target=self.target())

    def by_sample(self) -> Sentence:
        """Say that the interval of the sampled conditions holds the target."""
        found, one = self.found, self.found.best[0]
        values = {"candidate": one, "name": self.name(one) if len(found.candidates) > 1 else ""}
        values |= {"lives": self.span(one), "interval": [rounded(end) for end in one.interval], "unit": found.goal[2]}
        values |= {"scattered": self.scattered, "compared": self.compared}
        return say("verdict", "sample", **values, target=self.target())

    def range_of(self) -> Sentence:
        """State the ranges of the candidates between which the measurement decides."""
        found = self.found
        shown = [(self.name(one), self.span(one), ends_words(one)) for one in found.best[:MOST]]
        first = found.best[0]
        ranged, places = any(one.guessed for one in found.best), {self.where(one) for one in found.best[:MOST]}
        worn = any("wear" in (one.ends, one.ends_high) for one in found.best[:MOST] if one.high > one.low)
        values = {"ranged": ranged, "worn": worn, "shown": shown, "left": len(found.best) - len(shown)}
        values |= {"limit": ends_words(first), "alike": len({limit for _, _, limit in shown}) == 1}
        return say(
            "verdict",
            "range",
            **values,
            target=self.target(),
            where=places.pop() if len(places) == 1 else "",
            body=first.body,
        )

    def tested(self) -> Sentence | None:
        """Say which tests leave the life of the first candidates open, and whether it is an extrapolation of them."""
        found = self.found.ranked
        own = self.results.by_tests
        shown = [*found.best[:MOST], *([] if found.next is None else [found.next])]
        named = list(dict.fromkeys(name for one in shown for name in one.tested))
        if own is None or not named or not found.goal_rises:
            return None
        far = next((one for one in shown if one.beyond_tests and one.tested), None)
        values = {"tests": own.words(named), "far": "", "stress": ""}
        if far is not None:
            fit, stress = own.fits[far.tested[0]], float(own.stress[far.body][far.case])
            cycles = float(self.results.column(f"life_cycles_{far.body}")[far.case])
            low, high, longest = fit.tested
            values |= {"far": self.name(far) if len(shown) > 1 else "", "stress": quantity(stress, "MPa")}
            values |= {"cycles": rounded(cycles, 2), "longest": rounded(longest, 2)}
            values |= {"tested": f"{rounded(low)} to {quantity(high, 'MPa')}"}
        return say("verdict", "tested", **values, next=found.kind == "measure")

    def not_held(self) -> Sentence | None:
        """Name the fitted materials whose values do not hold for the options of the study."""
        found = not_held(self.results) if self.found.goal_rises else {}
        return say("verdict", "not_held", materials=list(found.items())) if found else None

    def turn(self, turn: Turn) -> Sentence | None:
        """Say at which value the decision turns."""
        named = {one.number: self.name(one) for one in self.found.best}
        others = [name for number, name in named.items() if number != turn.candidate]
        return turn_words(turn, self.target(), named.get(turn.candidate, ""), others)

    def given(self) -> Sentence:
        """Say which value was used instead of the one that was not given, or the ends of several goals."""
        traded = self.found.tradeoff
        if traded is None:
            turns = [(long_name(t.what), level_text(t.what, t.low, words=False)) for t in self.found.turns]
            return say("verdict", "given", turns=turns)
        ends = []
        for choices, values, beyond in traded.ends:
            lives = [
                lasting(v, unit, far) if unit == "h" else quantity(v, unit)
                for v, (_, unit, _), far in zip(values, traded.goals, beyond, strict=True)
            ]
            ends.append(f"{' at '.join(lives)} ({', '.join(setting(n, v) for n, v in choices.items())})")
        ends = list(dict.fromkeys(ends))
        front = self.results.pareto()
        holes, partly = ([], 0) if front is None else (holes_words(front), partly_holding(front))
        return say("verdict", "tradeoff", designs=traded.designs, ends=ends, holes=holes, partly=partly)

    def rest(self) -> list[Sentence | None]:
        """Say the verdict over the conditions that remain."""
        rest = self.found.rest
        if rest is None or rest.why == "conditions":
            return [] if rest is None else [unanswered(self.candidates)]
        own = _Words(self.results, rest)
        if rest.kind == "none":
            return [say("verdict", "rest", text="", kind=rest.kind, goal=""), own.nearest()] if rest.candidates else []
        head = own.head().text
        goal = self.found.goal[1] if self.found.tradeoff is not None else ""
        first = say("verdict", "rest", text=head[:1].lower() + head[1:], kind=rest.kind, goal=goal)
        return [first, *own.reasons()[: 2 if rest.kind == "measure" else 1]]

    def aside(self) -> Sentence | None:
        """Name the candidates that the model does not judge."""
        found = self.found
        others = found.not_judged
        if found.kind == "give" and found.rest is not None:
            others = found.rest.not_judged
        if not others:
            return None
        unit = found.goal[2]
        shown = []
        for one in others[:MOST]:
            told = self.compared and one.ends != "fatigue not known" and not math.isnan(one.holds)
            holds = quantity(one.holds, unit) if told else ""
            shown.append((self.name(one), REASONS.get(one.ends, one.ends), holds))
        return say("verdict", "not_judged", shown=shown, left=len(others) - len(shown), rises=found.goal_rises)

    def untried_life(self, one: Candidate, alone: bool = True) -> str:
        """Write the shortest life of a candidate under conditions that not every design was tried under; '' if none.

        Unless `alone`, the conditions that all designs share count, too.
        """
        own = self.candidates.design == one.number
        if not ((self.candidates.untried & own).any() and self.found.goal_rises):
            return ""
        rows = own & self.candidates.untried if alone else own
        low, high = (float(end[rows].min()) for end in Cases(self.candidates).ends)
        return ends_text(low, high, "", self.found.goal[2])

    def untried(self) -> Sentence | None:
        """Name the conditions of a table that not every design was tried under."""
        rows = np.flatnonzero(self.candidates.untried)
        if not len(rows):
            return None
        named = list(dict.fromkeys(condition_words(self.candidates, int(row)) for row in rows))
        there = self.untried_life(self.found.best[0]) if self.found.best else ""
        return say("verdict", "untried", shared=int(self.candidates.size[0]), named=named, there=there)

    def open_limits(self) -> Sentence | None:
        """Name the limits of the first candidate that are exceeded at one end of the range of a placeholder."""
        found = self.found
        names = found.best[0].open_limits if found.best else ()
        if not names:
            return None
        return say("verdict", "open", limits=[ended_by(name) for name in names])

    def guessed(self) -> Sentence | None:
        """Say that fatigue ends the first candidate by an S-N line that rests on guesses."""
        found = self.found.ranked
        if not found.best or found.why == "model" or "fatigue" not in (found.best[0].ends, found.best[0].ends_high):
            return None
        one = found.best[0]
        body, case = (one.body, one.case) if one.ends == "fatigue" else (one.body_high, one.case_high)
        material = str(self.results.material(body)[case])
        return say("verdict", "guessed", material=material) if material in guessed_lines(self.results.data) else None

    def bearings(self) -> Sentence | None:
        """Say that half of the bearings reach a life that the bearing ends, while makers state that of nine of ten."""
        found = self.found.ranked
        return bearing_words(self.results, [name for one in found.best[:MOST] for name in (one.ends, one.ends_high)])

    def scatter(self) -> Sentence | None:
        """Say that a life of nine of ten conditions by fatigue leaves out the scatter of the material."""
        found, results = self.found.ranked, self.results
        if not (found.sampled and found.best and results.config.analysis.material_scatter is False):
            return None
        if "fatigue" not in (found.best[0].ends, found.best[0].ends_high):
            return None
        material = str(results.material(found.best[0].body)[found.best[0].case])
        values = json.loads(str(results.data.attrs.get("materials", "{}"))).get(material, {})
        known = any(values.get(name) is not None for name in ("scatter_in_cycles", "scatter_in_stress"))
        return say("verdict", "scatter", material=material, known=known)

    def worn(self) -> Sentence | None:
        """Say of a first candidate that wear ends: its coefficient is a placeholder, and its groove is worn through."""
        found = self.found.ranked
        if not found.best or "wear" not in (found.best[0].ends, found.best[0].ends_high):
            return None
        one, results = found.best[0], self.results
        worn_body, case = (one.body, one.case) if one.ends == "wear" else (one.body_high, one.case_high)
        own, on = (str(results.material(body)[case]) for body in (worn_body, *({*BODIES} - {worn_body})))
        places = placeholders_of(results.data)
        guessed = any((p.limit, p.material) == ("wear", own) and p.on in ("", on) for p in places)
        flags = int(results.column(f"validity_{worn_body}", missing=0)[case])
        worn = bool(flags & validity_bit("worn"))
        guessed &= found.kind != "measure"
        guessed &= not (found.kind == "none" and found.target)  # a measurement decides nothing
        return say("verdict", "worn", material=own, on=on, guessed=guessed, worn=worn) if guessed or worn else None

    def unchecked(self) -> Sentence | None:
        """Name what was not checked."""
        names = unchecked_words(self.results, self.found.not_checked)
        names += [f"{ended_by(n)} of {self.name(one)}" for one in self.found.best[:1] for n in one.unchecked]
        vain = vain_in_base(self.results, self.found.not_checked)
        vain += [name for name in idle(self.results) if name.lower() in TRAVEL]  # blocks are judged one by one
        return say("verdict", "not_checked", names=names, vain=vain) if names else None


def vain_in_base(results: Results, not_checked: Iterable[str]) -> list[str]:
    """Return the values under `base` that a study gives for limits which were not checked, and for nothing else."""
    unknown = names_not_given(results.data.attrs)
    return [name for name in given_in_vain(results.config.base, not_checked) if name not in unknown]


def bearing_words(results: Results, limits: Iterable[str]) -> Sentence | None:
    """Say what share of a bearing's life nine of ten bearings reach; None where no bearing ends a median life."""
    own = results.config.base.get("bearing")
    if "bearing" not in limits or results.config.failure_probability != 0.5 or not own:
        return None
    slope = np.array([WEIBULL[str(kind)] for kind in FIELD.columns(np.array([own], dtype=object))["kind"]])
    share = 1.0 / float(life_at(np.ones(1), 0.5, slope)[0])
    return say("verdict", "bearing", share=share)


def unchecked_words(results: Results, names: Iterable[str]) -> list[str]:
    """Name the limits that were not checked, with what fatigue lacks at a failure probability other than 0.5."""
    words = [SHORT.get(name) or ended_by(name) for name in names]
    chance = results.config.failure_probability
    lacks = f" at {percent(chance)} failures (give `scatter_in_cycles`)"
    left_out = "fatigue" in results.config.not_checked
    return [word + lacks * (word.startswith("fatigue") and chance != 0.5 and not left_out) for word in words]


def targets_in_words(results: Results, unit_of_goal: str = "h") -> str:
    """Write the targets of a study: the largest life that they ask of the pair, then the others by their names."""
    lives, texts = [], []
    for name, wanted in results.config.requirement.items():
        unit, words = results.quantity(name)[1:]
        ends = wanted.ends
        if name in OF_PAIR and set(ends) == {"min"} and unit_of_goal == "h":
            lives.append(ends["min"])
        else:
            parts = [f"at {'least' if end == 'min' else 'most'} {as_given(v, unit)}" for end, v in ends.items()]
            texts.append(f"{words} {' and '.join(parts)}")
    return ", ".join([*([as_given(max(lives), "h")] if lives else []), *texts])


def turn_words(turn: Turn, target: str, name: str = "", others: Sequence[str] = ()) -> Sentence | None:
    """Say at which value a decision turns, None where it is not known; `name` and `others` are candidates."""
    if not (math.isfinite(turn.value) or math.isfinite(turn.until)):
        return None
    texts = {key: quantity(getattr(turn, key), turn.units) for key in ("value", "until", "high")}
    texts["low"] = rounded(turn.low)
    values = {
        "turn": turn,
        "name": name,
        "others": list(others),
        "target": target,
        "wear": turn.what == "wear_coefficient",
    }
    return say("verdict", "turn", **values, texts=texts)


def what_words(turn: Turn) -> str:
    """Name what to measure or to give."""
    if turn.what == "requirement":
        return "a requirement"
    if turn.what == "tests":
        return f"the S-N line of {turn.of} with more tests"
    if turn.what in PARAMETERS and not turn.of:
        return f"the {long_name(turn.what)}"
    if turn.what in ("placeholder_position", "placeholder"):
        return f"the placeholders of {turn.of}"
    if " or " in turn.what:
        return f"what an open limit rests on, the {plain(turn.what)} of {turn.of}"
    return f"the {plain(turn.what)} of {turn.of}" + f" on {'itself' if turn.on == turn.of else turn.on}" * bool(turn.on)


def _values(not_given: Mapping[str, float]) -> list[str]:
    """Write values of the paper's example that stand for values which were not given: 'axial force 30 N'."""
    return [f"{long_name(n)} {level_text(n, v, words=False)}" for n, v in not_given.items()]


def _levels(misses: Misses) -> str:
    """Write the levels of conditions: 'friction coefficient 0 and 0.05, driven −20 N'."""
    places = []
    for place in misses.where:
        parts = []
        for name, levels in place.items():
            texts = [level_text(name, v) for v in levels]
            spoken = setting(name, levels[0]) == texts[0]
            parts.append(shortened(texts) if spoken else f"{long_name(name)} {shortened(texts)}")
        places.append(", ".join(parts))
    return ", and at ".join(places)
