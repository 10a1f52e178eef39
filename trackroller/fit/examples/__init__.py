"""Example tests, all synthetic, with the case files that belong to them; `trackroller fit example`
writes them.
"""

from __future__ import annotations

from pathlib import Path

from trackroller.errors import InputError
from trackroller.files import write_text

FILES = (
    "rig.yaml",
    "bench-synthetic.csv",
    "design.yaml",
    "share.yaml",
    "candidates.yaml",
    "coupons-synthetic.csv",
    "groove.yaml",
    "depths-synthetic.csv",
)


def write_examples(folder: Path) -> list[Path]:
    """Write the example files into a folder, and return their paths.

    Parameters
    ----------
    folder : Path
        The folder; it is made if it does not exist.

    Raises
    ------
    InputError
        If one of these files stands there with another content; then none is written.
    """
    texts = {
        folder / name: Path(__file__).with_name(name).read_text(encoding="utf-8") for name in FILES
    }
    for path, text in texts.items():
        if path.exists() and (
            not path.is_file() or path.read_text(encoding="utf-8", errors="replace") != text
        ):
            remedy = "Give an empty folder, or move this file."
            raise InputError(
                "folder",
                str(folder),
                "a folder without these files",
                remedy,
                f"holds another {path.name}",
            )
    folder.mkdir(parents=True, exist_ok=True)
    for path, text in texts.items():
        write_text(path, text)
    return list(texts)
