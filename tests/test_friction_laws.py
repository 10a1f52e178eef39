"""Friction laws: their mappings, and sliding, FASTSIM and the exact theory under them."""

import json

import numpy as np
import pytest

from trackroller.contact.friction_laws import constant, exponential_falling, law_of, linear_falling, table
from trackroller.errors import InputError

MAPPINGS = [
    {"kind": "constant"},
    {"kind": "linear", "speed": 100.0, "lowest": 0.5},
    {"kind": "exponential", "speed": 30.0},
    {"kind": "table", "speed": [0, 10, 100], "friction": [0.3, 0.35, 0.2]},
]


@pytest.mark.parametrize("mapping", MAPPINGS, ids=lambda m: m["kind"])
def test_a_law_survives_its_mapping_and_its_text(mapping):
    """Mapping -> law -> mapping -> law and JSON -> law give equal laws with equal hashes."""
    law = law_of(mapping)
    for again in (law_of(law.as_dict()), law_of(law.json), law_of(json.loads(law.json)), law_of(law)):
        assert again == law and hash(again) == hash(law) and again.json == law.json
    assert len({law, law_of(mapping)}) == 1


def test_laws_of_the_mapping_are_those_of_the_functions():
    assert law_of(None) == constant() == law_of("constant") == linear_falling(10.0, 1.0)
    assert law_of(MAPPINGS[1]) == linear_falling(100, 0.5) != linear_falling(100, 0.4)
    assert law_of(MAPPINGS[2]) == exponential_falling(30.0, 0.4)
    assert law_of(MAPPINGS[3]) == table([0, 10, 100], [0.3, 0.35, 0.2])
    np.testing.assert_allclose(table([0, 1], [3, 2]).factor, [1, 2 / 3])  # only ratios count
    np.testing.assert_allclose(law_of(MAPPINGS[1])([0, 50, 100, 1e6]), [1, 0.75, 0.5, 0.5])
    speeds = np.linspace(0, 300, 777)
    np.testing.assert_allclose(law_of(MAPPINGS[2])(speeds), 0.4 + 0.6 * np.exp(-speeds / 30), atol=1e-4)


@pytest.mark.parametrize(
    ("mapping", "names"),
    [
        ({"kind": "expnential", "speed": 3}, ("friction_law.kind", "exponential")),
        ({"speed": 3}, ("friction_law.kind", "constant, linear")),
        ({"kind": "linear"}, ("friction_law.speed", "needs speed")),
        ({"kind": "linear", "speed": -1}, ("friction_law.speed", "> 0")),
        ({"kind": "linear", "speed": "fast"}, ("friction_law.speed", "fast")),
        ({"kind": "linear", "speed": 1, "lowest": 2}, ("friction_law.lowest", "[0, 1]")),
        ({"kind": "linear", "speed": 1, "slope": 2}, ("friction_law.slope", "lowest")),
        ({"kind": "table", "speed": [0, 1], "friction": [1]}, ("friction_law.speed", "as many")),
        ({"kind": "table", "speed": [1, 2], "friction": [1, 1]}, ("friction_law.speed", "rise from 0")),
        ({"kind": "table", "speed": [0, 1], "friction": [0, 1]}, ("friction_law.friction", "the first > 0")),
        ({"kind": "table", "speed": [0, "x"], "friction": [0, 1]}, ("friction_law.speed", "numbers")),
        (7, ("friction_law", "mapping")),
        ("{broken", ("friction_law", "JSON")),
    ],
)
def test_wrong_laws_are_refused_by_name(mapping, names):
    with pytest.raises(InputError) as caught:
        law_of(mapping)
    assert all(name in str(caught.value) for name in names), str(caught.value)
