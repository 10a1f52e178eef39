"""Share between the programs that copy results of the validation into the documentation (`validation/adopt/*.py`)."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Callable, Iterable
from pathlib import Path

from PIL import Image

FOLDER = Path(__file__).resolve().parents[2] / "docs"
DATA, FIGURES, PAGES = FOLDER / "data", FOLDER / "figures", FOLDER / "validation"
PICTURES = "../figures"  # as the pages name the folder of figures


def copy_figures(results: Path, names: Iterable[str], colours: int | None = None) -> None:
    """Copy PNGs of `results/figures`; `colours` reduces the palette so that the repository stays small."""
    for name in names:
        source, kept = results / "figures" / f"{name}.png", FIGURES / f"{name}.png"
        if colours is None:
            shutil.copy(source, kept)
        else:
            with Image.open(source) as image:
                image.convert("RGB").quantize(colours).save(kept, optimize=True)


def main(target: str, page: Callable[[], str], adopt: Callable[[Path], None]) -> None:
    """Adopt `results/TARGET` or the given folder and write its page; `--check` ends with 1 if it is out of date."""
    words, path = sys.argv[1:], PAGES / f"{target}.md"
    if "--check" in words:
        raise SystemExit(path.read_text(encoding="utf-8") != page())
    DATA.mkdir(exist_ok=True)
    adopt(Path(words[0]) if words else FOLDER.parent / "results" / target)
    path.write_text(page(), encoding="utf-8")
