"""A folder with a configuration of its own, and Snakemake started there with the workflow where it lies."""

from __future__ import annotations

import multiprocessing
import os
import shutil
import subprocess
import sys
from pathlib import Path

from snakemake import cli

ROOT = Path(__file__).parents[1]
SNAKEMAKE = str(Path(sys.executable).parent / "snakemake")
QUIET = ("--quiet", "host")
HANGS = 900  # [s], more than the slowest machine needs
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


def command(*words: str, snakefile: Path = ROOT / "Snakefile", quiet: tuple[str, ...] = QUIET) -> list[str]:
    """Return the words that start Snakemake on two cores; without more words it names each rule that it runs."""
    return [SNAKEMAKE, "-s", str(snakefile), *quiet, "--cores", "2", "--nocolor", *words]


def environment(snakefile: Path) -> dict[str, str]:
    """Return the environment in which a copied workflow takes the package beside it."""
    paths = [str(snakefile.parent), os.environ.get("PYTHONPATH", "")]  # an empty path would be the working folder
    return dict(os.environ) | {"PYTHONPATH": os.pathsep.join(filter(None, paths))}


def snakemake_process(folder: Path, *words: str, code: int = 0, snakefile: Path = ROOT / "Snakefile") -> str:
    """Run Snakemake in a folder as users do, require an exit code, and return what it printed."""
    words, env = tuple(command(*words, snakefile=snakefile)), environment(snakefile)
    done = subprocess.run(words, cwd=folder, env=env, capture_output=True, text=True, timeout=HANGS)
    told = done.stdout + done.stderr
    assert done.returncode == code, told
    return told


def snakemake(folder: Path, *words: str, code: int = 0, snakefile: Path = ROOT / "Snakefile", quiet=QUIET) -> str:
    """Do what `snakemake_process` does in a fork of this process, which has imported Snakemake already."""
    told = folder / ".told.txt"
    words = command(*words, snakefile=snakefile, quiet=quiet)[1:]
    context = multiprocessing.get_context("fork")
    child = context.Process(target=_main, args=(folder, told, snakefile, words))
    child.start()
    child.join(HANGS)
    child.kill()
    text = told.read_text()
    assert child.exitcode == code, text
    return text


def _main(folder: Path, told: Path, snakefile: Path, words: list[str]) -> None:
    """Be a Snakemake that prints into a file and imports the package beside the Snakefile."""
    with told.open("w") as stream:
        os.dup2(stream.fileno(), 1)
        os.dup2(stream.fileno(), 2)
    sys.stdout, sys.stderr = (open(number, "w", buffering=1, closefd=False) for number in (1, 2))
    os.chdir(folder)
    os.environ |= environment(snakefile)
    if snakefile.parent != ROOT:
        sys.path.insert(0, str(snakefile.parent))
        for name in [name for name in sys.modules if name.partition(".")[0] == "trackroller"]:
            del sys.modules[name]
    cli.main(words)


def started(told: str) -> list[str]:
    """Return the names of the rules that were run, sorted."""
    return sorted(
        line.split("rule ")[1].rstrip(":") for line in told.splitlines() if line.startswith(("rule ", "localrule "))
    )
