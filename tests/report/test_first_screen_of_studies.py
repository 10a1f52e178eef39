"""Sentences of the first screen of studies whose designs cannot be compared, or that only some values decide."""

import re
from collections import Counter

import numpy as np

import trackroller as tr
from trackroller.report.words.designs import unanswered

STEEL = dict.fromkeys(("roller_material", "guide_material"), "1.7225-quenched-tempered")
BASE = {"axial_force": 8, "motor_force": 0, "guide_curve_radius": np.inf, "guide_overrollings_per_hour": 150, **STEEL}


def run(factors, base=None, **keys):
    study = {"name": "screen", "base": BASE | (base or {}), "factors": factors}
    return tr.run(study | {"contact_model": "sliding", "accuracy": "preview"} | keys, progress=False)


def test_designs_that_share_their_conditions_are_not_told_to_differ():
    """The corners of a central composite design share theirs; its stars have the centre."""
    factors = {"contact_angle": {"uniform": [30, 40]}, "roller_profile_radius": {"uniform": [-9, -7]}}
    factors |= {"radial_force": {"uniform": [-150, -70]}, "friction_coefficient": {"uniform": [0.05, 0.2]}}
    results = run(factors, design="central_composite")
    rows = {}
    for row in results.table.itertuples():
        design = row.contact_angle, row.roller_profile_radius
        rows.setdefault(design, set()).add((row.radial_force, row.friction_coefficient))
    (_, most), *_ = Counter(map(frozenset, rows.values())).most_common()
    sizes = sorted(map(len, rows.values()))
    said = unanswered(results.candidates()).text
    found = re.match(
        r"The (\d+) designs have (\d) to (\d) conditions each, and at most (\d+) of them share the same", said
    )
    assert [int(text) for text in found.groups()] == [len(rows), sizes[0], sizes[-1], most]
    assert most < len(rows) and "needs" not in said and "; they are no random sample of the use, so this" in said
