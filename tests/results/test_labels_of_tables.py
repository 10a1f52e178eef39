"""A column of a table that is no parameter: it names the conditions that it stands with, or the designs."""

import numpy as np
import pandas as pd

import trackroller as tr

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


def table_study(folder, rows, **changes):
    """Return the solved study of a table of one material."""
    rows.to_csv(folder / "rows.csv", index=False)
    base = {"motor_force": 0, "friction_coefficient": 0.15, "guide_overrollings_per_hour": 150, "axial_force": 5}
    base |= dict.fromkeys(("roller_material", "guide_material"), "1.7225-quenched-tempered")
    study = {"name": "rows", "base": base, "method": "table", "table": str(folder / "rows.csv")}
    return tr.run(study | {"contact_model": "sliding", "accuracy": "preview"} | changes, progress=False)


def test_a_number_of_each_row_changes_no_verdict(tmp_path):
    rows = PROPOSALS.drop(columns="proposal").merge(BLOCKS, how="cross")
    plain = table_study(tmp_path, rows).answer
    for number in (np.arange(len(rows)), [f"L{i}" for i in range(len(rows))]):
        found = table_study(tmp_path, rows.assign(id=number)).answer
        assert found.kind == plain.kind == "build"
        assert found.headline["names"] == plain.headline["names"]
        assert found.headline["low"] == plain.headline["low"]


def test_blocks_of_one_design_keep_their_names_and_may_repeat_their_loads(tmp_path):
    rows = pd.concat([BLOCKS, BLOCKS.iloc[:1].assign(block="empty again")])
    found = table_study(tmp_path, rows).answer
    assert found.question == "how it behaves"
    assert found.facts["cases"] == 4
    assert found.table["cases"].iloc[0] == 4
