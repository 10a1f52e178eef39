"""A folder with a configuration of its own, and Snakemake started there with the workflow where it lies."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
SNAKEMAKE = str(Path(sys.executable).parent / "snakemake")
STUDY = """
name: tiny
description: a small study
factors:
  axial_force: {{linspace: [0, 60, {levels}]}}
  friction_coefficient: {{values: [0.1, 0.2]}}
outputs: [{outputs}]
contact_model: sliding
chunk_size: {size}
"""


def lay_study(folder: Path, levels: int = 6, outputs: str = "forces", size: int = 4) -> Path:
    """Write `tiny.yaml` and a configuration that names it into a folder, and return the folder."""
    (folder / "tiny.yaml").write_text(STUDY.format(levels=levels, outputs=outputs, size=size))
    (folder / "config").mkdir(exist_ok=True)
    (folder / "config" / "config.yaml").write_text("study: tiny.yaml\nresults: results\n")
    return folder


def copy_program(folder: Path) -> Path:
    """Copy the package and its workflow, with the compiled kernels, into a folder; return the copied Snakefile."""
    for part in ("trackroller", "workflow", "config", "profiles"):
        shutil.copytree(ROOT / part, folder / part)
    return Path(shutil.copy(ROOT / "Snakefile", folder))


def command(*words: str, snakefile: Path = ROOT / "Snakefile") -> list[str]:
    """Return the words that start Snakemake on two cores, and name each rule that it runs."""
    return [SNAKEMAKE, "-s", str(snakefile), "--quiet", "host", "--cores", "2", "--nocolor", *words]


def snakemake(folder: Path, *words: str, code: int = 0, snakefile: Path = ROOT / "Snakefile") -> str:
    """Run Snakemake in a folder, require an exit code, and return what it printed."""
    words = tuple(command(*words, snakefile=snakefile))
    hangs = 900  # [s], more than the slowest machine needs
    paths = os.pathsep.join([str(snakefile.parent), os.environ.get("PYTHONPATH", "")])
    env = os.environ | {"PYTHONPATH": paths}  # a copied workflow takes the package beside it
    done = subprocess.run(words, cwd=folder, env=env, capture_output=True, text=True, timeout=hangs)
    told = done.stdout + done.stderr
    assert done.returncode == code, told
    return told


def started(told: str) -> list[str]:
    """Return the names of the rules that were run, sorted."""
    return sorted(
        line.split("rule ")[1].rstrip(":") for line in told.splitlines() if line.startswith(("rule ", "localrule "))
    )
