"""Read random profiles as people and instruments write them: right, or refused, or doubted, but never wrong."""

from __future__ import annotations

import json

import numpy as np
import pytest
from examples import EXAMPLES
from written_profiles import Written, written

import trackroller as tr
from trackroller.contact.measured_points import in_order
from trackroller.contact.profiles import canonical
from trackroller.roller.doubts import doubts
from trackroller.roller.point_files import read_points

BLOCKS = 8  # so that two processes share them
FILES = 2 * EXAMPLES  # 2,000 in CI


def said_of(file: Written) -> tuple[str, bool]:
    """Return '' if the file is read right or refused with reason, otherwise what went wrong; and whether it is read."""
    with open("profile.csv", "wb") as stream:
        stream.write(file.content)
    try:
        profile = canonical({"file": "profile.csv", "frame": "contact"}, "roller_profile", read_points)
    except tr.InputError as error:
        unnamed = "" if "profile.csv" in str(error) else "the file is not named: "
        return f"refused without reason: {error}"[:500] if file.clear and not file.fault else unnamed, False
    points = np.array(profile["points"])
    x, z = points[in_order(points)].T
    scatters = any("scatter" in doubt for doubt in doubts({"roller_profile": profile}))
    allowed = max((0.03 if scatters else 0.006) * file.spacing, file.unseen)
    off = np.abs(z - file.curve(np.clip(x, *file.ends)))
    if np.abs(x[[0, -1]] - file.ends).max() > 2 * file.spacing or off.max() > allowed:
        return f"read wrong: {off.max() / file.spacing:.3g} spacings off at point {off.argmax()} of {x.size}", True
    return "doubted without reason" if scatters and not file.fault else "", True


@pytest.mark.slow
@pytest.mark.parametrize("block", range(BLOCKS))
def test_profiles_are_read_right_or_refused(block, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    wrong, accepted = {}, 0
    for seed in range(block, FILES, BLOCKS):
        file = written(seed)
        said, is_read = said_of(file)
        accepted += is_read
        if said:
            wrong[seed] = file.fault, said
    assert not wrong, json.dumps(wrong, indent=1)
    assert accepted > 0.15 * FILES / BLOCKS, "most files are refused, so that the test shows little"
