"""A column of a table that is no parameter: it names the conditions that it stands with, or the designs."""

import numpy as np
import pandas as pd

import trackroller as tr
from trackroller.report.words.verdict import verdict_sentences

BLOCKS = pd.DataFrame(
    {
        "block": ["empty", "loaded", "curve"],
        "share": [0.4, 0.5, 0.1],
        "radial_force": [-40.0, -120.0, -150.0],
        "axial_force": [4.0, 9.0, 38.0],
    }
)
PROPOSALS = pd.DataFrame(
    {"proposal": ["P", "Q", "R"], "roller_profile_radius": [-6.4, -6.9, -6.4], "contact_angle": [36.0, 44.0, 44.0]}
)


def test_proposals_under_the_same_blocks_are_compared(tmp_path):
    """Blocks and their shares repeat with their loads: they are no designs of their own."""
    PROPOSALS.merge(BLOCKS, how="cross").to_csv(tmp_path / "blocks.csv", index=False)
    base = {"motor_force": 0, "friction_coefficient": 0.15, "guide_overrollings_per_hour": 150}
    base |= dict.fromkeys(("roller_material", "guide_material"), "1.7225-quenched-tempered")
    study = {"name": "blocks", "base": base, "design": "table", "table": str(tmp_path / "blocks.csv")}
    study |= {"contact_model": "sliding", "accuracy": "preview"}
    results = tr.run(study, progress=False)
    worst = results.data.pair_life_to_first_limit_hours.values.reshape(3, 3).min(axis=1)  # a proposal has three rows
    first = PROPOSALS["proposal"][int(np.argmax(worst))]
    found = results.verdict
    assert (found.kind, found.best[0].choices["proposal"]) == ("build", first)
    assert found.best[0].low == worst.max() and found.best[0].conditions == len(BLOCKS)
    assert "block curve" in verdict_sentences(results)[1].text
