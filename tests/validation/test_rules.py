"""Rules depend on all code that their results come from, as the import graph says."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from trackroller.study.store.sources import source_files

ROOT = Path(__file__).parents[2]
SOLVER = {
    "roller/geometry.py",
    "roller/solver.py",
    "roller/equilibrium/__init__.py",
    "roller/accuracy.py",
    "roller/accuracy.json",
    "roller/case.py",
    "contact/hertz.py",
    "contact/sliding.py",
    "damage/fatigue.py",
    "halfspace/peak.py",
    "materials/database.py",
}


def modules(rules: str) -> list[tuple[str, ...]]:
    """Return the modules that each rule of a file depends on."""
    text = (ROOT / rules).read_text(encoding="utf-8")
    calls = re.findall(r"digest_file\((.*?)\)", text, re.DOTALL)
    return [tuple(re.findall(r'"((?:trackroller|validation)[\w.]+)"', call)) for call in calls]


@pytest.mark.parametrize("room", ["paper", "extremes", "tradeoff", "contact_models", "peers"])
def test_evidence_depends_on_the_whole_solver_and_on_its_own_code(room):
    files = source_files(modules(f"validation/rules/{room}.smk")[0])
    found = {path.relative_to(ROOT).as_posix() for path in files}
    assert {f"trackroller/{name}" for name in SOLVER} <= found
    own = {p.relative_to(ROOT).as_posix() for p in (ROOT / "validation" / room).glob("*.py")}
    assert own & found


def test_every_rule_that_computes_names_its_code():
    """Each rule with a script has an input `code`, except the rule solve: the code is part of a chunk's name there."""
    for path in [*(ROOT / "workflow" / "rules").glob("*.smk"), *(ROOT / "validation" / "rules").glob("*.smk")]:
        for rule in re.split(r"^rule ", path.read_text(encoding="utf-8"), flags=re.M)[1:]:
            name = rule.partition(":")[0]
            if "script:" in rule and name not in ("solve", "tradeoff_gather"):
                assert "code=digest_file(" in rule, f"{path.name}: {name}"


@pytest.mark.parametrize("target", ["analysis", "report"])
def test_what_a_user_sees_depends_on_its_room(target):
    show = {name for rule in modules("workflow/rules/show.smk") for name in rule}
    found = {path.relative_to(ROOT).as_posix() for path in source_files(sorted(show))}
    used = {p for p in found if p.startswith(f"trackroller/{target}/")}
    all_files = {p.relative_to(ROOT).as_posix() for p in (ROOT / "trackroller" / target).rglob("*.py")}
    assert len(used) > 0.6 * len(all_files), sorted(all_files - used)
