"""Friction from the database: value, source and placeholder mark stand in every result and report."""

import itertools
import json

import numpy as np
import pytest
from told import effect_of

import trackroller as tr
from trackroller.materials import load_database
from trackroller.report.pages.sheet import as_json
from trackroller.report.pages.study import contents
from trackroller.roller.record import friction_records

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


@pytest.mark.slow
def test_the_report_lists_every_coefficient_with_source_and_placeholder(tmp_path):
    """Kept and unkept results record the same; the page names the guess beside what rests on it."""
    for found in (solved(), solved(tmp_path)):
        records = friction_records(found.data.attrs)
        assert [tuple(r[key] for key in KEYS) for r in records] == expected()
        page = contents(found)
        table = next(t for t in page["materials"] if t.name == "friction")
        assert [row[2] for row in table.rows] == [value for _, _, value, _, _ in expected()]
        for row, (_, level, _, source, guess) in zip(table.rows, expected(), strict=True):
            assert row[1] == level and source in row[3] and ("placeholder" in row[3]) == guess
        (said,) = (s for s in dict(page["summary"])["How sure"] if s.kind == "friction_guess")
        guesses = [value for _, _, value, _, guess in expected() if guess]
        assert [float(value) for value, _ in said.values["guesses"]] == guesses


def test_levels_as_a_factor_are_recorded_each():
    levels = ("lower", "upper")
    found = solved(base={}, factors=FACTORS | {"friction_coefficient": {"values": list(levels)}})
    assert sorted(tuple(r.values()) for r in friction_records(found.data.attrs)) == sorted(expected(levels))


def test_a_study_with_its_own_friction_records_none():
    found = solved(base={"friction_coefficient": 0.2})
    assert "friction" not in found.data.attrs
    page = contents(found)
    assert [t.name for t in page["materials"]] == ["materials"]
    assert not [s for head, said in page["summary"] for s in said if s.kind == "friction_guess"]


@pytest.mark.parametrize("free", [True, False])
def test_pairs_of_materials_say_that_their_friction_differs(free):
    """Two pairs of materials that the database gives two frictions differ in more than the material."""
    found = solved(base={"friction_coefficient": None if free else 0.2})
    results = found
    values = 1.0 + results.table["material_pair"].astype(str).str.len().to_numpy()
    results.table["roller_life_hours"] = values  # the words count here, not the number
    rows = np.ones(len(results.table), dtype=bool)
    said = effect_of(results, "roller_life_hours", "material_pair", rows)
    assert said.values["changed"] == ["friction_coefficient"] * free


def test_levels_of_friction_do_not_follow_from_themselves():
    found = solved(base={}, factors=FACTORS | {"friction_coefficient": {"values": ["lower", "upper"]}})
    results = found
    results.table["roller_life_hours"] = np.where(results.table["friction_coefficient"] == "upper", 10.0, 1.0)
    rows = np.ones(len(results.table), dtype=bool)
    assert effect_of(results, "roller_life_hours", "friction_coefficient", rows).values["changed"] == []


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
