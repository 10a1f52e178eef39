"""Pages of solved studies: nothing is said three times, one word a thing, and no life stands bare."""

from __future__ import annotations

import re
from collections import Counter
from functools import cache

import pytest

import trackroller as tr
from trackroller.report.figures.study import _jobs
from trackroller.report.numbers import Life
from trackroller.report.pages.study import contents

STEEL, HARD = "1.7225-normalised", "1.7225-quenched-tempered"
PAIRS = {"values": [[HARD, STEEL], [STEEL, "PA6"], ["POM", STEEL]]}
GUIDE = {"guide_overrollings_per_hour": 600}
SAMPLE = {
    "samples": 64,
    "seed": 1,
    "base": GUIDE | {"motor_force": 0},
    "analysis": {"target": {"min": 100}},
    "factors": {
        "roller_profile_radius": {"uniform": [-9, -6.4]},
        "friction_coefficient": {"uniform": [0.05, 0.3]},
        "axial_force": {"uniform": [0, 40]},
    },
}
STUDIES = {
    "grid": {
        "base": GUIDE,
        "analysis": {"target": {"min": 100}},
        "factors": {
            "roller_profile_radius": {"values": [-6.5, -8, -10]},
            "material_pair": PAIRS,
            "friction_coefficient": {"values": [0, 0.1, 0.3]},
            "motor_force": {"values": [0, -30]},
            "axial_force": {"values": [0, 30, 70]},
        },
    },
    "bare": {
        "base": {"friction_coefficient": None, "motor_force": -10},
        "constraints": ["max_pressure < 900"],
        "factors": {
            "material_pair": PAIRS,
            "contact_angle": {"values": [25, 35]},
            "axial_force": {"values": [0, 15, 30]},
            "radial_force": {"values": [-20, -100, -200]},
        },
    },
    "points": {
        "design": "inner_outer",
        "samples": 32,
        "seed": 1,
        "base": GUIDE | {"motor_force": 0, "radial_force": -60},
        "analysis": {"target": {"min": 1000}},
        "factors": {
            "roller_profile_radius": {"values": [-6.5, -8]},
            "contact_angle": {"values": [30, 40]},
            "friction_coefficient": {"uniform": [0.05, 0.3]},
            "axial_force": {"uniform": [0, 40]},
        },
    },
    "light": {
        "life_rule": "unlimited",
        "base": GUIDE | {"motor_force": 0},
        "factors": {
            "roller_profile_radius": {"values": [-6.5, -8, -10]},
            "friction_coefficient": {"values": [0.05, 0.1, 0.3]},
            "axial_force": {"values": [0, 4, 8]},
            "radial_force": {"values": [-5, -20, -60]},
        },
    },
    "lhs": SAMPLE | {"design": "lhs", "pareto": {"pair_life_hours": "max", "max_pressure": "min"}},
    "sobol": SAMPLE | {"design": "sobol"},
    "saltelli": SAMPLE | {"design": "saltelli", "samples": 16},
    "morris": SAMPLE | {"design": "morris", "samples": 16, "analysis": {}},
}
SAMPLES = ("lhs", "sobol", "saltelli", "morris")


@cache
def page(name):
    """Return the solved study, the contents of its page, and every passage of prose with its place."""
    study = {"name": name.replace(" ", "-"), "contact_model": "sliding", "accuracy": "preview"} | STUDIES[name]
    solved = tr.run(study, progress=False)
    found = contents(solved)
    prose = [(head, s.text) for head, said in found["summary"] for s in said]
    infos = [drawn[1] for draw in _jobs(solved) if (drawn := draw()) is not None]
    prose += [(info.name, info.caption) for info in infos]
    for table in (t for part in ("decide", "ends", "models") for t in found["tables"][part]):
        prose.append((table.name, table.note))
        if table.name not in ("indices", "validity"):  # their last column explains each row
            prose += [(table.name, v) for row in table.rows for v in row if isinstance(v, str) and len(v) > 60]
    return solved, found, [(place, text) for place, text in prose if text]


def sentences(prose):
    for place, text in prose:
        for one in re.split(r"(?<=[.;])\s+(?=[A-Z])", text):
            yield place, one.rstrip(".")


@pytest.mark.slow
@pytest.mark.parametrize("name", STUDIES)
def test_no_sentence_stands_three_times(name):
    """Once in In short, once where it is explained."""
    counted = Counter(one for _, one in sentences(page(name)[2]) if len(one.split()) > 5)
    assert {one: n for one, n in counted.items() if n > 2} == {}


@pytest.mark.parametrize("name", STUDIES)
def test_no_statement_stands_three_times(name):
    """The same numbers, three or more of them, in three places: one statement in other words."""
    counted = Counter()
    for _, one in set(sentences(page(name)[2])):
        numbers = re.findall(r"\d[\d,.]*\d|\d", re.sub(r"\d+-(?:normalised|quenched)|1\.7225", "", one))
        if len(set(numbers)) > 2:
            counted[tuple(sorted(set(numbers)))] += 1
    assert {numbers: n for numbers, n in counted.items() if n > 2} == {}


@pytest.mark.parametrize("name", STUDIES)
def test_cases_are_rows_and_designs_are_combinations_of_choices(name):
    solved, _, prose = page(name)
    rows = int(solved.data["regime"].size)
    choices = [n for n in ("roller_profile_radius", "material_pair", "contact_angle") if n in STUDIES[name]["factors"]]
    designs = len(solved.design.columns["friction_coefficient"]) if name in SAMPLES else 1
    if name not in SAMPLES:
        table = solved.table
        designs = table.groupby(choices).ngroups
    for _, text in prose:
        assert not re.search(r"(?<![\d.,·])1 (?:cases|designs|conditions|lives|rows|pairs|more designs)\b", text), text
        for many in re.findall(r"of (?:all )?([\d,]+) (?:allowed )?designs", text):
            assert int(many.replace(",", "")) <= designs, text
        for many in re.findall(r"of (?:all )?([\d,]+) (?:allowed |valid |rolling )?cases", text):
            assert int(many.replace(",", "")) <= rows, text


@pytest.mark.parametrize("name", STUDIES)
def test_lives_of_tables_and_sentences_are_marked(name):
    """Hours in a table are lives that know whether they lie beyond the S-N data; none is called unlimited."""
    _, found, prose = page(name)
    hours = 0
    for table in found["tables"]["decide"]:
        for row in table.rows:
            for head, cell in zip(table.heads[1:], row[1:], strict=True):
                what = f"{table.title} {head}" if "interval" not in head else ""
                if re.search(r"(?i)life.*\[h\]", str(row[0])) or re.search(r"(?i)life.*\[h\].*(?:b10|mean|%)", what):
                    assert (
                        isinstance(cell, Life)
                        or cell == "does not hold"
                        or head in ("Lift-off (95 % interval)",)
                        or "%" in str(cell)
                    ), row
                    hours += 1
    assert hours or name in SAMPLES
    assert not [text for _, text in prose if "unlimited h" in text or "∞ h" in text]


@pytest.mark.parametrize("name", SAMPLES)
def test_a_sample_without_designs_says_so_and_nothing_contradicts_it(name):
    """No row of these studies repeats a groove: the verdict refuses, and Pareto set and targets speak of cases."""
    solved, found, prose = page(name)
    best = {s.kind: s.text for s in dict(found["summary"])["Verdict"]}
    longest, target = solved.table.pair_life_hours.max(), solved.config.requirement
    if target and longest < target["pair_life_hours"].least:  # no need to compare designs
        assert solved.verdict.kind == "none" and f"None of the {len(solved.table)} cases meets" in best["nowhere"]
    else:
        assert solved.verdict.kind == "cannot_tell" and "design: inner_outer" in best["unanswered"]
    assert not {"build", "a_or_b", "next"} & set(best)
    assert not re.search(r"\bBuild |Candidate [1-9]|designs tie|best design", " ".join(text for _, text in prose))
    names = {t.name: t for t in found["tables"]["decide"]}
    assert "candidates" not in names
    if "pareto" in names:
        assert names["pareto"].title == "Pareto-optimal cases"
    if "targets" in names:
        assert names["targets"].rows[0][0] == "All cases"
    with pytest.raises(tr.InputError, match="inner_outer"):
        solved.best()
