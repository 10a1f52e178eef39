"""Record the facts that repeating a result needs: versions, commit, study, materials, date."""

from __future__ import annotations

import contextlib
import datetime
import functools
import json
import platform
import subprocess
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING, Any

from trackroller import __version__
from trackroller.damage.own import digests
from trackroller.parameters import OPTIONS
from trackroller.roller.dataset import file_attributes
from trackroller.roller.stored_inputs import NOT_GIVEN
from trackroller.study.store.mark import STORE_FORMAT
from trackroller.study.store.program_digest import solver_digest

if TYPE_CHECKING:
    from trackroller.study.file.study import Study

DATE = "date_created"  # attribute of results in memory; a folder keeps the date in its plan
_PACKAGES = ("numpy", "scipy", "numba", "xarray", "netCDF4", "SALib", "snakemake")


def now() -> str:
    """Return the date and time in UTC."""
    return datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds")


def git_commit() -> str:
    """Return the commit of the source tree, with '+changed' after an edit; 'unknown' outside a
    source tree.
    """
    root = Path(__file__).resolve().parents[3]
    if not (root / ".git").exists():
        return "unknown"
    try:

        def git(*words: str) -> str:
            # without optional locks, a run that is killed here does not leave the repository locked
            return subprocess.run(
                ["git", "--no-optional-locks", "-C", str(root), *words],
                capture_output=True,
                text=True,
                timeout=10,
                check=True,
            ).stdout.strip()

        changed = git("status", "--porcelain", "--untracked-files=no", "--", "trackroller")
        return git("rev-parse", "HEAD") + ("+changed" if changed else "")
    except (OSError, subprocess.SubprocessError):
        return "unknown"


def versions() -> dict[str, str]:
    """Return the versions of all that computes the numbers: this package, Python, packages, limits
    of a user's own.
    """
    own = {f"config/limits/{path.name}": f"sha256 {digest}" for path, digest in digests().items()}
    return {"trackroller": __version__, "python": platform.python_version()} | own | _packages()


@functools.cache
def _packages() -> dict[str, str]:
    """Return the versions of the installed packages; reading them takes 6 ms, and the live page
    repeats it.
    """
    versions = {}
    for name in _PACKAGES:
        with contextlib.suppress(metadata.PackageNotFoundError):
            versions[name] = metadata.version(name)
    return versions


def attributes(study: Study) -> dict[str, Any]:
    """Return the global attributes of the gathered file for a study, those of its materials left
    out.
    """
    config = study.config
    stated = {
        **file_attributes(
            f"Parameter study '{study.name}' of locating-bearing track rollers",
            "solved and gathered",
        ),
        "comment": config.description or f"Results of the study {study.name}",
        "study": study.merged(),
        NOT_GIVEN: json.dumps(study.not_given),
        "study_name": study.name,
        "design": config.method_name,
        "seed": config.seed,
        "accuracy": OPTIONS["accuracy"].attribute(config.accuracy, ""),
        "solver_digest": solver_digest(),
        "store_format": STORE_FORMAT,
        "versions": json.dumps(versions()),
        "git_commit": git_commit(),
        DATE: now(),
    }
    if study.path is not None:
        stated["study_file"] = study.path.name
    return stated
