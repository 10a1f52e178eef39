"""Every process finds the same digits, whether it compiles the kernels, in whatever order, or loads them compiled."""

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
digest = hashlib.sha256()
for model in ("sliding", "kalker"):
    found = tr.solve(cases, outputs=("contact", "friction_work", "life"), contact_model=model)
    for name in sorted(found.data_vars):
        digest.update(found[name].values.tobytes())
print(digest.hexdigest())
"""
# compile kernels that both models share before CODE does, and for other callers
OTHERS_FIRST = """
import numpy as np
from trackroller.halfspace.kernels import point_kernel
from trackroller.numerics.knots import polyline
point_kernel(1.0, 1.0, 1.0)
polyline(0.5, np.array([0.0, 1.0]), np.array([1.0, 0.5]))
"""


def digits(code: str, **env: str) -> str:
    env = os.environ | {"NUMBA_NUM_THREADS": "1"} | env
    told = subprocess.run([sys.executable, "-c", code], env=env, capture_output=True, text=True, timeout=300)
    assert told.returncode == 0, told.stderr
    return told.stdout


@pytest.mark.long
def test_digits_depend_neither_on_the_cache_nor_on_the_order_of_compilation(tmp_path):
    loaded = digits(CODE)  # the kernels that this environment compiled, in the order of its first study
    assert digits(OTHERS_FIRST + CODE, NUMBA_CACHE_DIR=str(tmp_path)) == loaded
