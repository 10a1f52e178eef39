"""The Slurm profile starts both Snakefiles: a local rule runs, the next job goes to `sbatch`, here a stub."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest
from workflow_place import ROOT, SNAKEMAKE, lay_study

SBATCH = """#!/bin/sh
echo "$@" >> "{told}"
echo "sbatch: error: no cluster here" >&2
exit 1
"""


@pytest.fixture
def stub(tmp_path):
    """Return the environment of a cluster that takes no job, and the file in which it records requests."""
    tools, told = tmp_path / "bin", tmp_path / "submitted.txt"
    tools.mkdir()
    texts = {"sbatch": SBATCH.format(told=told), "sinfo": "#!/bin/sh\necho 'main*'\n", "squeue": "#!/bin/sh\n"}
    for name, text in texts.items():
        (tools / name).write_text(text)
        (tools / name).chmod(0o755)
    return os.environ | {"PATH": f"{tools}:{Path(SNAKEMAKE).parent}:{os.environ['PATH']}"}, told


def run(folder, env, snakefile, *targets):
    words = [SNAKEMAKE, "-s", str(ROOT / snakefile), "--profile", str(ROOT / "profiles" / "slurm"), "--nocolor", "--"]
    return subprocess.run([*words, *targets], cwd=folder, env=env, capture_output=True, text=True, timeout=240)


@pytest.mark.long
@pytest.mark.parametrize(
    ("snakefile", "local", "submitted", "threads"),
    [
        ("Snakefile", "results/tiny/design.nc", "results/tiny/study.nc", 1),
        ("validation/Snakefile", "", "results/extremes/extremes.json", 2),
    ],
    ids=["study", "validation"],
)
def test_a_local_rule_runs_and_the_next_job_is_submitted(tmp_path, stub, snakefile, local, submitted, threads):
    env, told = stub
    lay_study(tmp_path)
    done = run(tmp_path, env, snakefile, *filter(None, (local, submitted)))
    assert done.returncode == 1 and "no cluster here" in done.stdout + done.stderr
    assert not local or (tmp_path / local).is_file(), "a submitted job leaves no file here"
    asked = told.read_text()
    for word in ("--mem 1000", "-t 60", f"--cpus-per-task={threads}"):
        assert word in asked, asked
