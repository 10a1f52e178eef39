"""A large study: time and memory of planning and gathering, and the workflow's share of the solving time.

    python benchmarks/million.py [CASES] [solve]

Without `solve` a stand-in takes the solver's place (forces only, same width), so that the machinery is measured
alone. Prints seconds and the peak of resident memory after each step.
"""

from __future__ import annotations

import resource
import shutil
import sys
import tempfile
import time
from pathlib import Path

import numpy as np


def memory() -> str:
    """Peak of resident memory of this process."""
    return f"{resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6:.2f} GB"


def stand_in(design, database=None, **options):
    """60 columns a case, as forces, contact and life have."""
    import xarray as xr

    n = design.sizes["case"]
    wide = np.repeat(design["axial_force"].values[:, None], 14, axis=1)
    found = {f"v{i}": (("case", "contact", "body"), wide[:, :4].reshape(n, 2, 2)) for i in range(14)}
    found["regime"] = ("case", np.zeros(n, "i1"))
    found["converged"] = ("case", np.ones(n, "i1"))
    return xr.Dataset(found, {"contact": [1, 2], "body": ["roller", "guide"]})


def main() -> None:
    """Plan, solve, gather."""
    from trackroller.study.config import parse_study
    from trackroller.study.gather import gather
    from trackroller.study.plan import make_plan
    from trackroller.study.solve import solve_chunk

    cases = int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000
    real = "solve" in sys.argv[2:]
    study = parse_study({
        "name": "large", "design": "lhs", "samples": cases,
        "outputs": ["forces", "contact", "life"] if real else ["forces"],
        "factors": {"axial_force": {"uniform": [0, 60]}, "friction_coefficient": {"uniform": [0.01, 0.4]},
                    "radial_force": {"uniform": [-400, -100]},
                    "material_pair": {"values": [["1.7225-normalised"] * 2, ["PA6", "1.7225-normalised"]]}},
    })  # fmt: skip
    results = Path(tempfile.mkdtemp(prefix="million-"))
    begun = time.perf_counter()
    plan = make_plan(study, results)
    print(f"plan    {time.perf_counter() - begun:6.1f} s, {len(plan.chunks)} chunks, {memory()}")
    begun = time.perf_counter()
    for name in plan.chunks:
        solve_chunk(plan.folder, name, study.materials, solver=None if real else stand_in)
    print(f"solve   {time.perf_counter() - begun:6.1f} s, {memory()}")
    plan = make_plan(study, results)
    begun = time.perf_counter()
    gather(plan)
    print(f"gather  {time.perf_counter() - begun:6.1f} s, {memory()}")
    print(f"file    {plan.folder.gathered.stat().st_size / 1e6:.0f} MB")
    shutil.rmtree(results)


if __name__ == "__main__":
    main()
