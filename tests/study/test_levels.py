"""Levels of a factor in words: short, and no two of them the same."""

from __future__ import annotations

import json

import pytest

from trackroller.parameters import OUTPUT_GROUPS
from trackroller.roller.case import mapping_text
from trackroller.study.cost import bytes_a_case, rate
from trackroller.study.design.levels import short
from trackroller.study.file.load import parse_study
from trackroller.study.run import run_study
from trackroller.study.status import status_of
from trackroller.study.store.ledger import study_folder

POINTS = [[float(x), -0.01 * x * x] for x in range(-5, 6)]


BEARING = {"rows": 2, "row_distance": 8, "kind": "ball", "dynamic_rating": 3000, "static_rating": 1500}
BEARING |= {"e": 0.3, "X": 0.56, "Y": 1.5, "X0": 0.6, "Y0": 0.5}
CATALOGUE = {"radial_force": 800, "axial_force": 300, "moment": 2000, "basic_life": 100, "law": "dry"}


@pytest.mark.parametrize(
    ("name", "levels"),
    [
        (
            "roller_profile",
            [
                {"arcs": [{"radius": -7, "to": 0.2}, {"radius": -6.3}]},
                {"arcs": [{"radius": -7, "to": 0.2}, {"radius": -6.5}]},
                {"arcs": [{"radius": -7, "to": 0.3}, {"radius": -6.3}]},
                {"arcs": [{"radius": -7}]},
                {"arcs": [{"radius": -7, "to": 0.1}, {"radius": -9, "to": 0.2}, {"radius": -6.3}]},
                {"arcs": [{"radius": -7, "to": 0.1}, {"radius": -8, "to": 0.2}, {"radius": -6.3}]},
            ],
        ),
        (
            "roller_profile",
            [
                {"arc": -7, "edge": edge}
                for edge in (
                    {"outer": 0.1},
                    {"outer": 0.2},
                    {"inner": 0.1},
                    {"outer": 0.1, "chamfer": 1.0},
                    {"outer": 0.1, "chamfer": 2.0},
                    {"inner": 0.1, "outer": 0.1},
                )
            ],
        ),
        ("roller_profile", [{"arc": -7}, {"arc": -7.0000002}, {"arc": -7, "width": 9}, {"parabola": -7}]),
        (
            "guide_profile",
            [{"points": POINTS, "smooth": s} for s in (0, 0.001, "auto")] + [{"points": POINTS, "frame": "contact"}],
        ),
        (
            "friction_law",
            [
                {"kind": "table", "speed": [0, 50], "friction": [0.3, 0.1]},
                {"kind": "table", "speed": [0, 50], "friction": [0.2, 0.1]},
                {"kind": "table", "speed": [0, 20, 50], "friction": [0.3, 0.2, 0.1]},
                {"kind": "table", "speed": [0, 20, 50], "friction": [0.3, 0.15, 0.1]},
            ],
        ),
        ("bearing", [BEARING, BEARING | {"kind": "roller"}, BEARING | {"Y0": 0.6}]),
        ("catalogue", [CATALOGUE, CATALOGUE | {"law": "cubic"}]),
        ("wear_table", [{"work_rate": [0, 10], "roller": [0, top], "guide": [0, 55]} for top in (55, 66)]),
    ],
)
def test_levels_of_a_factor_read_differently(name, levels):
    texts = [mapping_text(name, level) for level in levels]
    words = [short(name, text) for text in texts]
    assert len(set(words)) == len(set(texts)) == len(levels)
    assert max(map(len, words)) < 60


def test_status_tells_failed_profiles_in_words(tmp_path):
    flat = [{"points": [[float(x), z] for x in range(-180, 181)], "frame": "section"} for z in (0.0, 1.0)]
    study = parse_study(
        {
            "name": "p",
            "outputs": ["forces"],
            "contact_model": "sliding",
            "normal": "halfspace",
            "accuracy": "preview",
            "method": "grid",
            "factors": {"roller_profile": {"values": flat}},
        }
    )
    run_study(study, tmp_path)
    levels = [level for _, level in status_of(study, study_folder(study.name, tmp_path)).by_level]
    assert len(levels) == 2 and all(t.startswith("drawn") and t.endswith("361 points") for t in levels)


def test_a_plan_knows_time_and_size_of_every_group_of_outputs():
    """More outputs take no less time and more disk; limits of patches cost more than the forces alone."""
    for group in OUTPUT_GROUPS:
        both = tuple(dict.fromkeys(("forces", group)))
        assert bytes_a_case(both) >= bytes_a_case(("forces",)) and rate({"outputs": both}) <= rate({})
    assert rate({"outputs": ("forces", "multiaxial")}) < 0.5 * rate({})


def test_friction_laws_and_profiles_are_told_in_a_few_words():
    law = json.dumps({"kind": "linear", "speed": 50, "lowest": 0.3})
    assert short("friction_law", law) == "linear to 0.3 at 50 mm/s"
    assert short("friction_law", "") == "constant"
    assert short("roller_profile", '{"arc":-7.0,"width":9}') == "arc −7 mm, 9 mm wide"
    drawn = [json.dumps({"points": [[0, 0], [1, z]], "frame": "section"}) for z in (1, 2)]
    assert len({short("guide_profile", text) for text in drawn}) == 2
    assert len(short("friction_law", "{" + "x" * 200)) <= 40
