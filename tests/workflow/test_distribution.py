"""What others use of this workflow names files that exist: container, catalog entry, configuration."""

from __future__ import annotations

import re
import shutil
import subprocess

import yaml
from workflow_place import ROOT


def test_the_container_copies_files_that_exist_and_starts_the_workflow():
    lines = re.sub(r"\\\n", " ", (ROOT / "Dockerfile").read_text()).splitlines()
    told = [line.split() for line in lines if line and not line.startswith("#")]
    assert {words[0] for words in told} <= {"FROM", "ENV", "COPY", "RUN", "WORKDIR", "ENTRYPOINT", "CMD"}
    copied = [name for words in told if words[0] == "COPY" for name in words[1:-1]]
    assert copied and all((ROOT / name).exists() for name in copied)
    needed = {"requirements.lock", "pyproject.toml", "Snakefile", "trackroller", "workflow", "config", "profiles"}
    assert needed <= set(copied)
    readme = re.search(r'^readme = "(.+)"', (ROOT / "pyproject.toml").read_text(), re.M)
    assert readme is None or readme[1] in copied
    made = (ROOT / "Makefile").read_text()
    for words in ("--require-hashes -r", "--no-deps --no-build-isolation -e", "python -c"):  # as `make env` installs
        (line,) = (" ".join(told_line) for told_line in told if words in " ".join(told_line))
        assert words in made and (words != "python -c" or line.partition("-c ")[2] in made)


def test_the_catalog_entry_has_the_standard_form():
    entry = yaml.safe_load((ROOT / ".snakemake-workflow-catalog.yml").read_text())
    assert set(entry["usage"]) <= {"mandatory-flags", "software-stack-deployment", "report"}
    assert {"desc", "flags"} == set(entry["usage"]["mandatory-flags"])
    for name in ("workflow/Snakefile", "config/README.md", "config/config.yaml", "README.md", "LICENSE"):
        assert (ROOT / name).is_file()


def test_the_default_configuration_is_described_and_names_a_study():
    default = yaml.safe_load((ROOT / "config" / "config.yaml").read_text())
    told = (ROOT / "config" / "README.md").read_text()
    assert all(f"| `{key}` |" in told for key in default)
    assert (ROOT / default["study"]).is_file()


def test_ci_runs_its_parts():
    """The script is sound shell, and each part it names is defined."""
    text = (ROOT / ".ci" / "run").read_text()
    assert subprocess.run(["sh", "-n", str(ROOT / ".ci" / "run")], check=False).returncode == 0
    loops = " ".join(re.findall(r"for part in ([a-z ]+);", text)).split()
    parts = loops + re.findall(r"\btimed ([a-z]+)$", text, re.M)
    assert sorted(parts) == sorted(re.findall(r"^part_([a-z]+)\(\)", text, re.M))
    assert set(re.findall(r"parts: ([a-z ]+);", text)[0].split()) == set(parts)
    made = re.findall(r"\bmake ([a-z-]+)", text)
    targets = re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), re.M)
    assert set(made) <= set(targets) and shutil.which("sh")
    supported = re.findall(r"Python :: (3\.\d+)", (ROOT / "pyproject.toml").read_text())
    assert re.findall(r"for version in ([\d. ]+);", text) == [f"{supported[0]} {supported[-1]}"]
