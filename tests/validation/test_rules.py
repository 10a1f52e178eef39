"""Rules depend on all code that their results come from, as the import graph says."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import yaml

from trackroller.study.store import sources
from trackroller.study.store.sources import source_files
from validation.benchmarks import programs

ROOT = Path(__file__).parents[2]
SOLVER = {
    "roller/geometry.py",
    "roller/solver.py",
    "roller/equilibrium/__init__.py",
    "parameters/accuracy.py",
    "roller/expected_errors.json",
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


@pytest.mark.parametrize("room", ["paper", "extremes", "tradeoff", "contact_models"])
def test_evidence_depends_on_the_whole_solver_and_on_its_own_code(room):
    files = source_files([f"validation.{room}.__main__", sources.SOLVER])
    found = {path.relative_to(ROOT).as_posix() for path in files}
    assert {f"trackroller/{name}" for name in SOLVER} <= found
    own = {p.relative_to(ROOT).as_posix() for p in (ROOT / "validation" / room).glob("*.py")}
    assert own & found


def test_every_rule_that_computes_names_its_code():
    """Each rule that runs code has an input `code`, except the rule solve: the code is part of a chunk's name there."""
    for path in [*(ROOT / "workflow" / "rules").glob("*.smk"), ROOT / "validation" / "Snakefile"]:
        for rule in re.split(r"^ *rule\b", path.read_text(encoding="utf-8"), flags=re.M)[1:]:
            name = rule.partition(":")[0].strip()
            if ("script:" in rule or "shell:" in rule) and name != "solve":
                assert "code=" in rule and "digest_file(" in rule, f"{path.name}: {name}"


def test_programs_of_the_evidence_run_with_the_interpreter_of_the_workflow():
    """`python` of the PATH may be another interpreter without the packages, or one of another version."""
    text = (ROOT / "validation" / "Snakefile").read_text(encoding="utf-8")
    commands = re.findall(r"shell:\s+(.*)", text)
    assert len(commands) == 4 and "OWN_PYTHON=sys.executable" in text
    assert all(command.startswith('\'"$OWN_PYTHON" -m ') for command in commands)


def test_each_program_has_a_small_instance():
    """The small instance that CI runs gives every program of the evidence fewer cases, and names no other program."""
    small = yaml.safe_load((ROOT / "validation" / "config" / "small.yaml").read_text(encoding="utf-8"))
    assert set(small) == set(programs()) | {"tradeoff", "extremes", "contact_models", "kalker_table"}


@pytest.mark.parametrize("target", ["analysis", "report"])
def test_what_a_user_sees_depends_on_its_room(target):
    show = {name for rule in modules("workflow/rules/show.smk") for name in rule}
    found = {path.relative_to(ROOT).as_posix() for path in source_files(sorted(show))}
    used = {p for p in found if p.startswith(f"trackroller/{target}/")}
    all_files = {p.relative_to(ROOT).as_posix() for p in (ROOT / "trackroller" / target).rglob("*.py")}
    assert len(used) > 0.6 * len(all_files), sorted(all_files - used)
