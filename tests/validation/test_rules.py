"""Rules depend on the code of the rooms in which their results are made."""

from __future__ import annotations

import re
from pathlib import Path

import yaml

from validation.benchmarks import programs

ROOT = Path(__file__).parents[2]


def rooms(rules: str) -> list[str]:
    """Return the room that each rule of a file names as its code."""
    text = (ROOT / rules).read_text(encoding="utf-8")
    return re.findall(r'digest_file\(\s*f"[^"]+",\s*"(\w+)"', text)


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
    others = {"tradeoff", "extremes", "contact_models", "fits", "kalker_table", "measured"}
    assert set(small) == set(programs()) | others


def test_rules_name_the_room_in_which_their_result_is_made():
    assert rooms("workflow/rules/show.smk") == ["results", "report"]
    assert rooms("workflow/rules/solve.smk") == ["study", "study"]
    assert rooms("workflow/rules/until.smk") == ["results", "results"]
    assert rooms("workflow/rules/search.smk") == ["results"]
    assert rooms("validation/Snakefile") == ["results", "results"], "the table of creep forces has a room of its own"
