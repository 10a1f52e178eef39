"""Share between the programs that copy results of the validation into the documentation (`validation/adopt/*.py`)."""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from PIL import Image

from validation.pages import Block

FOLDER = Path(__file__).resolve().parents[2] / "docs"
DATA, FIGURES, PAGES = FOLDER / "data", FOLDER / "figures", FOLDER / "validation"
PICTURES = "../figures"  # as the pages name the folder of figures


def shortened(content: Sequence[Block], sections: Sequence[str], data: str) -> list[Block]:
    """Return a page without the text and the tables of some sections; the data file holds what is left out.

    Parameters
    ----------
    content : sequence of Block
        The whole page.
    sections : sequence of str
        Headings of the sections of which only the figures remain.
    data : str
        Path of the data file in the repository.

    Returns
    -------
    list of Block
        The page, with a paragraph at its end that names the data file.

    Raises
    ------
    ValueError
        If the page has no such section.
    """
    missing = set(sections) - {value for kind, value in content if kind == "h2"}
    if missing:
        raise ValueError(f"the page has no sections {sorted(missing)}")
    kept, inside = [], False
    for kind, value in content:
        if kind == "h2":
            inside = value in sections
        if not inside or kind == "figure":
            kept.append((kind, value))
    names = ", ".join(f"*{name}*" for name in sections)
    return [*kept, ("h2", "More data"), ("p", f"`{data}` holds {names}; the page in `results/` shows them.")]


def copy_figures(results: Path, names: Iterable[str], colours: int | None = None) -> None:
    """Copy PNGs of `results/figures`; `colours` reduces the palette so that the repository stays small."""
    for name in names:
        source, kept = results / "figures" / f"{name}.png", FIGURES / f"{name}.png"
        if colours is None:
            shutil.copy(source, kept)
        else:
            with Image.open(source) as image:
                image.convert("RGB").quantize(colours).save(kept, optimize=True)


def results_of(target: str) -> Path:
    """Return the folder that the command line names; without a name, `results/TARGET` of the repository."""
    return Path(sys.argv[1]) if len(sys.argv) > 1 else FOLDER.parent / "results" / target


def main(target: str, path: Path, text: Callable[[], str], adopt: Callable[[Path], None]) -> None:
    """Adopt the data of a target and write the file that follows from them; `--check` only compares.

    Parameters
    ----------
    target : str
        Name of the folder in `results/`, if the command line names none.
    path : Path
        The file to write, or to compare: with `--check` the program ends with 1 if the file is out of date.
    text : callable
        Returns the text of the file from the data in the repository.
    adopt : callable
        Copies the data from a folder of results into the repository.
    """
    if "--check" in sys.argv[1:]:
        raise SystemExit(path.read_text(encoding="utf-8") != text())
    DATA.mkdir(exist_ok=True)
    adopt(results_of(target))
    path.write_text(text(), encoding="utf-8")


def write_generated() -> None:
    """Write the pages of `docs/generate.py`, in a process of its own that reads the new data."""
    subprocess.run([sys.executable, str(FOLDER / "generate.py")], check=True)
