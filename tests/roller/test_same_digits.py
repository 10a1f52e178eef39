"""The process that compiles the kernels finds the same digits as those that load them compiled."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

CODE = """
import hashlib, itertools, sys
import trackroller as tr
rows = itertools.product((0, 30, 60), (0.05, 0.2), (-6.4, -7.5), (0, -20))
names = ("axial_force", "friction_coefficient", "roller_profile_radius", "motor_force")
cases = [dict(zip(names, row)) for row in rows]
found = tr.solve(cases, outputs=("contact", "friction_work", "life"))
print(hashlib.sha256(b"".join(found[n].values.tobytes() for n in sorted(found.data_vars))).hexdigest())
"""


@pytest.mark.slow
def test_first_process_of_a_fresh_place_finds_the_digits_of_later_ones(tmp_path):
    env = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path), "NUMBA_NUM_THREADS": "1"}
    told = [
        subprocess.run([sys.executable, "-c", CODE], env=env, capture_output=True, text=True, timeout=300)
        for _ in range(2)
    ]
    assert told[0].returncode == told[1].returncode == 0, told[0].stderr + told[1].stderr
    assert told[0].stdout == told[1].stdout
