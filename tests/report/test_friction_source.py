"""Friction from the database: value, source and placeholder mark stand in every result and report."""

import itertools
import json

import pytest

import trackroller as tr
from trackroller.materials import load_database
from trackroller.report.pages.sheet import as_json
from trackroller.results.roller_answer import answer_of_roller
from trackroller.roller.stored_inputs import friction_records

STEEL, POM, PA6 = "1.7225-normalised", "POM", "PA6"
FACTORS = {
    "material_pair": {"values": [[STEEL, STEEL], [STEEL, PA6], [POM, POM]]},
    "radial_force": {"values": [-100, -200]},
    "axial_force": {"values": [0, 5, 10]},
}

KEYS = ("material_pair", "level", "value", "source", "placeholder")


def solved(tmp_path=None, **changes):
    study = {"name": "mu", "base": {"friction_coefficient": None}, "factors": FACTORS, "contact_model": "sliding"}
    return tr.run(study | changes, progress=False, results=tmp_path)


def expected(levels=("typical",)):
    """Return pair, level, value, source and placeholder mark of each coefficient, asked one by one."""
    known = load_database()
    rows = []
    for (roller, guide), level in itertools.product(FACTORS["material_pair"]["values"], levels):
        value = known.friction(roller, guide, level)
        rows.append((f"{roller} / {guide}", level, value.value, value.source, value.placeholder))
    return rows


def test_levels_as_a_factor_are_recorded_each():
    levels = ("lower", "upper")
    found = solved(base={}, factors=FACTORS | {"friction_coefficient": {"values": list(levels)}})
    assert sorted(tuple(r.values()) for r in friction_records(found.data.attrs)) == sorted(expected(levels))


def warned(answer):
    return [one.where for one in answer.warnings if one.code == "doubtful"]


@pytest.mark.slow
def test_typical_friction_below_the_tests_of_the_dry_pair_is_warned_of_and_the_remedy_works():
    pair = {"roller_material": STEEL, "guide_material": STEEL}
    ds = tr.solve(tr.Case(friction_coefficient=None, **pair), contact_model="sliding")
    (told,) = warned(answer_of_roller(ds))
    assert told == (
        f"friction of {STEEL} / {STEEL}: 0.19 is the typical coefficient, and tests of the dry pair give 0.45 to 0.8. "
        "Give friction_coefficient: dry, lubricated or a number."
    )
    for level, value in (("dry", 0.5), ("lubricated", 0.1), (0.2, 0.2), ("upper", 0.3)):
        other = tr.solve(tr.Case(friction_coefficient=level, **pair), contact_model="sliding")
        assert warned(answer_of_roller(other)) == []
        known = json.loads(as_json(other))["friction"]
        assert [one["value"] for one in known] == ([value] if isinstance(level, str) else [])
    study = solved(factors=FACTORS | {"material_pair": {"values": [[STEEL, STEEL], [STEEL, PA6], [POM, POM]]}})
    pairs = [text.partition(":")[0] for text in warned(study.answer)]
    assert pairs == [f"friction of {STEEL} / {STEEL}", f"friction of {STEEL} / {PA6}"]  # no test of POM on itself


@pytest.mark.parametrize("level", [None, "upper", 0.2])
def test_a_single_case_records_its_coefficient(level):
    ds = tr.solve(tr.Case(friction_coefficient=level, roller_material=POM, guide_material=POM), contact_model="sliding")
    records = json.loads(as_json(ds))["friction"]
    if level == 0.2:
        assert records == []
        return
    (one,) = records
    known = load_database().friction(POM, POM, level or "typical")
    assert one == {
        "material_pair": "POM / POM",
        "level": level or "typical",
        "value": known.value,
        "source": known.source,
        "placeholder": True,
    }
