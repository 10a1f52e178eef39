"""Finding and mending damaged files of a study."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from trackroller.study import store
from trackroller.study.files import StudyFolder, link_or_copy, sweep

Tell = Callable[[str], None]


def drop_corrupt(folder: StudyFolder, tell: Tell) -> list[str]:
    """Remove, and name, every solved chunk that cannot be trusted; returns their names."""
    for place in ("plan", "chunks", "store"):
        sweep(folder.root / place)
    dropped = []
    for path in sorted((folder.root / "store").glob("*.nc")):
        name = path.stem
        linked = folder.chunk(name)
        try:
            store.read_chunk(path)
        except store.CorruptFile as exc:
            tell(f"corrupt chunk, its cases are solved again: {exc}")
            if linked.exists() and linked.samefile(path):
                linked.unlink()
            path.unlink()
            dropped.append(name)
            continue
        if linked.exists() and not linked.samefile(path) and linked.read_bytes() != path.read_bytes():
            tell(f"corrupt chunk, restored from the store: {linked}")
            linked.unlink(missing_ok=True)
            link_or_copy(path, linked)
    for path in sorted((folder.root / "chunks").glob("*.nc")):
        if not folder.kept(path.stem).is_file():
            if not _adopt(folder, path, tell):
                path.unlink()
    return dropped


def _adopt(folder: StudyFolder, path: Path, tell: Tell) -> bool:
    """A good chunk whose other name is missing (a copied folder) is taken into the store."""
    try:
        store.read_chunk(path)
    except store.CorruptFile as exc:
        tell(f"corrupt chunk, its cases are solved again: {exc}")
        return False
    link_or_copy(path, folder.kept(path.stem))
    return True
