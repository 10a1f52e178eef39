"""A folder with the workflow in it, as a clone has it."""

import shutil
from pathlib import Path

ROOT = Path(__file__).parents[1]


def lay_workflow(folder: Path) -> Path:
    """Copies Snakefile, rules and profiles to `folder`, with a configuration that names tiny.yaml; returns it."""
    for name in ("workflow", "profiles", "config"):
        shutil.copytree(ROOT / name, folder / name)
    shutil.copy(ROOT / "Snakefile", folder)
    (folder / "config" / "config.yaml").write_text("study: tiny.yaml\nresults: results\n")
    return folder
