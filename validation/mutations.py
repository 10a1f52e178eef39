"""Break formulas and decisions one at a time in a copy of the tree and say which test catches each.

    python -m validation.mutations [NAME ...]

Each mutation changes a sign, a factor or an index of one formula, or a border outside formulas (`decisions.py`). The
quick tests beside it must then fail. Prints formula, change and the test that caught it; ends with 1 if a mutation
survives.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

from trackroller.study.store.sources import source_files
from validation.decisions import DECISIONS

ROOT = Path(__file__).resolve().parents[1]
PARTS = ("trackroller", "tests", "validation", "workflow", "config", "docs", "pyproject.toml", "README.md", "Makefile")
HANGS = 1200  # [s]


@dataclass(frozen=True)
class Mutation:
    """A formula, the file of the package that holds it, the text before and after, and the tests that may catch it."""

    formula: str
    path: str
    before: str
    after: str
    tests: tuple[str, ...]


SLIP, SLIP_TESTS = (
    "halfspace/rigid_slip.py",
    ("contact/test_slip.py", "contact/test_sliding.py", "contact/test_slip_terms.py"),
)
GEOMETRY, GEOMETRY_TESTS = (
    "roller/geometry.py",
    ("roller/test_geometry.py", "roller/test_equilibrium.py", "roller/test_solver.py"),
)
SOBOL_TESTS = ("analysis/test_sensitivity.py",)
TABLE, TABLE_TESTS = "contact/table/coordinates.py", ("contact/test_kalker_table.py",)
MUTATIONS = {
    "profile-slip": Mutation(
        "eq. (20), slip of the guide's profile", SLIP, "return -np.minimum(deep", "return np.minimum(deep", SLIP_TESTS
    ),
    "rolling-slip": Mutation(
        "eq. (21), rolling slip",
        SLIP,
        "return shift + profile_slip(x",
        "return shift - profile_slip(x",
        SLIP_TESTS,
    ),
    "rolling-slip-kernel": Mutation(
        "eq. (21) without a division",
        SLIP,
        "np.sqrt(flat * flat - deep)",
        "np.sqrt(flat * flat + deep)",
        (*SLIP_TESTS, "halfspace/test_peak.py"),
    ),
    "pole-rolling": Mutation(
        "eq. (22), spin pole on the trailing edge", SLIP, "(x_spin / a) ** 2", "(x_spin / b) ** 2", SLIP_TESTS
    ),
    "pole-lateral": Mutation(
        "eq. (23), lateral place of the spin pole", SLIP, "return shift / sine", "return shift * sine", SLIP_TESTS
    ),
    "lateral-slip": Mutation("eq. (24), lateral slip", SLIP, "sine * (y - offset)", "sine * (y + offset)", SLIP_TESTS),
    "pole-offset": Mutation("eq. (25), skewed pole line", SLIP, "k0 + np.maximum(k1", "k0 + np.minimum(k1", SLIP_TESTS),
    "contact-modulus": Mutation(
        "Hertz, contact modulus E*",
        "contact/hertz.py",
        "(1 - nu_2**2) / e_2",
        "(1 - nu_1**2) / e_2",
        ("contact/test_hertz.py", "contact/test_contact_models.py"),
    ),
    "axis-ratio": Mutation(
        "Hertz, ratio of the semi-axes",
        "contact/hertz.py",
        "return 2 * x + np.log(d)",
        "return x + np.log(d)",
        ("contact/test_hertz.py",),
    ),
    "curvature": Mutation(
        "curvature in the rolling plane, which the paper does not number",
        GEOMETRY,
        "1.0 / np.asarray(rolling_radius) + 1.0",
        "1.0 / np.asarray(rolling_radius) - 1.0",
        GEOMETRY_TESTS,
    ),
    "lever-arm": Mutation(
        "eq. (14), lever arm of the lateral force",
        GEOMETRY,
        "np.cos(contact_angle) - guide_profile_radius)\n    return h_normal",
        "np.cos(contact_angle) + guide_profile_radius)\n    return h_normal",
        GEOMETRY_TESTS,
    ),
    "point-load": Mutation(
        "stresses below a point load",
        "halfspace/kernels.py",
        "t11 = 3.0 * t4",
        "t11 = 2.0 * t4",
        ("halfspace/test_halfspace_kernels.py",),
    ),
    "exponent": Mutation(
        "S-N curve, exponent k",
        "materials/sn_curve.py",
        "np.log(cycles) / np.log(stresses)",
        "np.log(cycles) * np.log(stresses)",
        ("materials/test_sn_curve.py", "damage/test_fatigue.py"),
    ),
    "creepage-index": Mutation(
        "Kalker's coefficients, order of C22 and C23",
        "contact/linear.py",
        "c22: np.ndarray\n    c23: np.ndarray",
        "c23: np.ndarray\n    c22: np.ndarray",
        ("contact/test_kalker_linear.py",),
    ),
    "spin-arm": Mutation(
        "table of exact solutions, arm L of the spin", TABLE, "g / 4.0) / 3.0", "g / 2.0) / 3.0", TABLE_TESTS
    ),
    "coupling": Mutation(
        "table of exact solutions, creepage Z of unlike materials",
        TABLE,
        "0.5 / (1.0 + g)",
        "0.5 / (1.0 - g)",
        TABLE_TESTS,
    ),
    "total-index": Mutation("Sobol, total index", "analysis/sobol.py", '("ST", 1 - rest)', '("ST", rest)', SOBOL_TESTS),
    "second-order": Mutation(
        "Sobol, second-order index",
        "analysis/sobol.py",
        "first[:, i] - first[:, j]",
        "first[:, i] + first[:, j]",
        SOBOL_TESTS,
    ),
    "dominated": Mutation(
        "Pareto, a design beats another",
        "analysis/pareto.py",
        "(held < costs[row]).any",
        "(held < costs[row]).all",
        ("analysis/test_pareto.py",),
    ),
    "direction": Mutation(
        "Pareto, sign of a goal",
        "analysis/pareto.py",
        '"min" else -1.0',
        '"min" else 1.0',
        ("analysis/test_pareto.py",),
    ),
} | {name: Mutation(name, *entry) for name, entry in DECISIONS.items()}


def copied(place: Path) -> Path:
    """Copy what the tests need, with the compiled kernels, into a folder."""
    for name in PARTS:
        source = ROOT / name
        (shutil.copytree if source.is_dir() else shutil.copy2)(source, place / name)
    return place


def forget_kernels(place: Path, path: str) -> None:
    """Remove the compiled kernels of every module that imports a file: numba looks at a kernel's own file only."""
    changed = ROOT / "trackroller" / path
    for module in (ROOT / "trackroller").rglob("*.py"):
        inside = module.relative_to(ROOT)
        kernels = list((place / inside.parent / "__pycache__").glob(f"{module.stem}.*.nb[ic]"))
        if kernels and changed in source_files(".".join(inside.with_suffix("").parts)):
            for kernel in kernels:
                kernel.unlink()


def catching_test(place: Path, mutation: Mutation) -> str:
    """Return the first test that fails with a mutation, "" if none does."""
    file = place / "trackroller" / mutation.path
    text = file.read_text(encoding="utf-8")
    if text.count(mutation.before) != 1:
        raise ValueError(f"{mutation.path} holds {mutation.before!r} {text.count(mutation.before)} times, not once")
    file.write_text(text.replace(mutation.before, mutation.after), encoding="utf-8")
    forget_kernels(place, mutation.path)
    tests = [str(Path("tests") / name) for name in mutation.tests]
    words = [
        sys.executable,
        "-m",
        "pytest",
        "-q",
        "-x",
        "-m",
        "not long and not slow",
        "-p",
        "no:cacheprovider",
        *tests,
    ]
    env = os.environ | {"PYTHONPATH": str(place)}
    try:
        done = subprocess.run(words, cwd=place, env=env, capture_output=True, text=True, timeout=HANGS)
    finally:
        forget_kernels(place, mutation.path)
        file.write_text(text, encoding="utf-8")
    if done.returncode == 0:
        return ""
    failed = re.search(r"^(?:FAILED|ERROR) (\S+)", done.stdout, re.M)
    if failed is None:
        raise RuntimeError(done.stdout + done.stderr)
    return failed[1].removeprefix("tests/")


def main(names: list[str]) -> int:
    """Try mutations by name, or all of them, and return 1 if one survives."""
    survived = 0
    with tempfile.TemporaryDirectory() as folder:
        place = copied(Path(folder))
        for name in names or MUTATIONS:
            mutation = MUTATIONS[name]
            caught = catching_test(place, mutation)
            survived += not caught
            before, after = (" ".join(text.split()) for text in (mutation.before, mutation.after))
            print(f"| {mutation.formula} | `{before}` → `{after}` | {caught or 'SURVIVED'} |", flush=True)
    return int(survived > 0)


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
