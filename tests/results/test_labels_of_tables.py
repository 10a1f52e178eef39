"""A column of a table that is no parameter: it names the conditions that it stands with, or the designs."""

import numpy as np
import pandas as pd

import trackroller as tr
from trackroller.report.words.designs import best_table
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


def table_study(folder, rows, **changes):
    """Return the solved study of a table of one material."""
    rows.to_csv(folder / "rows.csv", index=False)
    base = {"motor_force": 0, "friction_coefficient": 0.15, "guide_overrollings_per_hour": 150, "axial_force": 5}
    base |= dict.fromkeys(("roller_material", "guide_material"), "1.7225-quenched-tempered")
    study = {"name": "rows", "base": base, "design": "table", "table": str(folder / "rows.csv")}
    return tr.run(study | {"contact_model": "sliding", "accuracy": "preview"} | changes, progress=False)


def test_numbers_of_drawings_at_one_load_are_neither_choices_nor_conditions(tmp_path):
    """The best drawing is the best of those tried, and the table of candidates names it."""
    drawings = PROPOSALS.rename(columns={"proposal": "drawing"})
    results = table_study(tmp_path, drawings)
    lives = results.data.pair_life_to_first_limit_hours.values.ravel()
    found, first = results.verdict, int(np.argmax(lives))
    assert set(results.roles) == {"roller_profile_radius", "contact_angle"}
    assert (found.kind, found.best[0].low, found.tried) == ("build", lives.max(), 3)
    order = drawings["drawing"].to_numpy()[np.argsort(-lives)].tolist()
    assert best_table(results).rows[0] == ["Drawing", *order] and order[0] == drawings["drawing"][first]
    assert "best of 3 tried" in verdict_sentences(results)[0].text


def test_a_number_of_each_row_changes_no_verdict(tmp_path):
    rows = PROPOSALS.drop(columns="proposal").merge(BLOCKS, how="cross")
    plain = table_study(tmp_path, rows).verdict
    for number in (np.arange(len(rows)), [f"L{i}" for i in range(len(rows))]):
        found = table_study(tmp_path, rows.assign(id=number)).verdict
        assert (found.kind, found.best[0].choices, found.best[0].low) == (
            "build",
            plain.best[0].choices,
            plain.best[0].low,
        )


def test_blocks_of_one_design_keep_their_names_and_may_repeat_their_loads(tmp_path):
    rows = pd.concat([BLOCKS, BLOCKS.iloc[:1].assign(block="empty again")])
    found = table_study(tmp_path, rows).verdict
    assert found.kind == "lasts" and found.best[0].conditions == 4


def test_no_distribution_of_labels_is_advised(tmp_path):
    rows = PROPOSALS.assign(radial_force=[-60, -80, -95])
    results = table_study(tmp_path, rows, roles={"proposal": "condition"})
    said = next(one for one in verdict_sentences(results) if one.kind == "unanswered")
    assert said.values["conditions"] == ["radial force"]
    assert "radial force as a distribution with" in said.text
