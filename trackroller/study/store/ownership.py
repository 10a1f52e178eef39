"""Tell which files of a results folder this program wrote: no other file is ever overwritten, moved or removed.

Every function that writes into the folder of a study, or clears something there, asks this file. The rules are:

- A folder belongs to a study if its `plan.json` fits its own digest. Folders of earlier versions, and folders whose
  `plan.json` was damaged, are recognised by other files: a sealed result, a chunk that fits its checksum, a crate.
  Every other folder that is not empty is somebody else's and is refused.
- Links inside the folder are refused. The results folder and `results/NAME` may be links: where results lie is the
  user's choice.
- A file is ours as long as it has the content that we wrote: its digest stands in a record `plan/NAME.sha256`, it ends
  with its own checksum, or it has a form that only this program writes (`FORMS`).
- A file that a record names, but whose content has changed since, is kept: it moves to `aside/` when its place is
  needed.
- Any other file stays where it is. If its place is needed, the command is refused.
"""

from __future__ import annotations

import contextlib
import functools
import os
import re
import shutil
import stat
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path

from trackroller.errors import InputError
from trackroller.files import (
    disk_errors,
    is_link,
    open_here,
    refuse_link,
    refuse_links,
    scratch_name,
    write_whole,
)
from trackroller.study.store.digests import (
    LONE,
    MARK,
    METADATA,
    OUTDATED,
    Digests,
    digest_of_file,
    listed,
    mark,
    of_crate,
    read_record,
    record_of,
    sums_up,
)

ASIDE, UNFINISHED = "aside", "unfinished"
MADE_BY = {"made_by": "trackroller"}  # in the mark of each folder whose results have records, also outdated ones
PAGES = ("sensitivity.nc", "report.html", "figures", "tables", "explorer.html")
RESULTS = ("design.nc", "study.nc", METADATA, "designs.csv", "inputs", "page.log", *PAGES)
CASES = re.compile(r"(plan|chunks)/[0-9a-f]{16}\.nc")  # end with a checksum
NAMED = re.compile(rf"plan\.json|{CASES.pattern}|plan/({'|'.join(map(re.escape, RESULTS))})\.sha256")  # ours by name
_TEMPORARY = r"\.[^/]+\.\d+-[0-9a-f]{16}\.tmp"
SCRATCH = re.compile(rf"([^/]+/)*{_TEMPORARY}")
NOTES = "plan/scratch.txt"  # names of the temporary files of processes that run or were killed
UNKNOWN = "0" * 64  # stands in a record for a file of an earlier version, which kept no digest of it
_STAMP = rb"\d{4}-\d\d-\d\d \d\d:\d\d:\d\d,\d{3} "
FORMS = {  # name -> content
    r"plan/\.(lock|report|search)": rb"",
    r"plan/[0-9a-f]{16}\.(lock|solved)": rb"",
    r"looks/\d+-[0-9a-f]{16}\.solved|(.+/)?\.snakemake_timestamp|\.page\.lock|\.pause": rb"",
    r"plan/[^/]+\.sha256": rb"(# outdated\n)?([0-9a-f]{64}  \.\./[^\n]+\n)*",
    LONE.replace(".", r"\."): rb"(# outdated\n)?([0-9a-f]{64}  [^\n]+\n)*",
    NOTES.replace(".", r"\."): rb"([^\n]+\.tmp\n)*",
    r"code/[\w.]+\.txt": rb"[0-9a-f]{16}\n",
    r"looks/\d+\.json": rb'\{"stopped": .*, "chunks": .*\}\n',
    r"logs/.+\.log": rb"(" + _STAMP + rb".*)?",
    r"\.page\.json": rb'\{.*"step": .*\}',
    r"page\.log": rb"(trackroller: .*)?",
}
# what a process of an earlier version left behind if it was killed before it wrote its first record
_EARLIER_SCRATCH = re.compile(r"(plan/|inputs/)?\.[^/]+\.\d+\.tmp")
_TITLES = (" – explorer</title>".encode(), " – study of track rollers</title>".encode())
_noted: dict[str, tuple[int, set[str]]] = {}  # lines that this process has written into each file of notes
Tell = Callable[[str], object]


def is_study(root: Path) -> bool:
    """Return whether a folder is that of a study: by its mark, or by what stands in it."""
    return bool(mark(root)) or any(_evidence(root))


def _evidence(root: Path) -> Iterator[bool]:
    """Yield what tells of a study in a folder whose mark is missing or damaged."""
    yield any(_proved_alone(root, path) for place in ("plan", "chunks") for path in sorted((root / place).glob("*.nc")))
    yield any(read_record(path)[1] for path in (root / "plan").glob("*.sha256"))
    stored = root / "inputs" / "study.yaml"
    yield stored.is_file() and of_crate(root).get("inputs/study.yaml") == digest_of_file(stored)
    files, scratch = files_below(root), _scratch_of(root)
    begun = {root / "plan" / ".lock", root / ".page.lock"} & {*files}
    names = {file: file.relative_to(root).as_posix() for file in files if scratch.isdisjoint(_within(root, file))}
    yield bool(begun) and all(_EARLIER_SCRATCH.fullmatch(n) or _proved_alone(root, file) for file, n in names.items())


def _scratch_of(root: Path) -> set[Path]:
    """Return the temporary files and folders that processes have noted; they may be gone."""
    notes = root / NOTES
    lines = notes.read_text(encoding="utf-8").splitlines() if _proved_alone(root, notes) else []
    return {root / line for line in lines if SCRATCH.fullmatch(line) and ".." not in Path(line).parts}


def check(root: Path) -> None:
    """Refuse a folder of somebody else, and a folder with links inside.

    Raises
    ------
    InputError
        If the folder exists, is not empty, and is not that of a study, or holds a link.
    """
    if not root.is_dir():
        return
    with disk_errors(root):
        names = sorted(os.listdir(root))
        if _holds_something(root) and not is_study(root):
            more = f" and {len(names) - 4} more" if len(names) > 4 else ""
            raise InputError(
                "results folder",
                str(root),
                "a new or empty folder, or one that trackroller made",
                "Give the study another name, choose another --results, or move the folder away.",
                f"was not made by trackroller and holds {', '.join(names[:4])}{more}",
            )
        check_links(root)


def _holds_something(root: Path) -> bool:
    """Return whether a folder holds a file or a link, at any level."""
    return any(files or any(is_link(Path(place, name)) for name in folders) for place, folders, files in os.walk(root))


def check_readable(root: Path) -> None:
    """Refuse to read a folder with links inside, or with a `plan.json` of somebody else; it may be without one."""
    check_links(root)
    if os.path.lexists(root / MARK):
        check(root)


def check_links(root: Path) -> None:
    """Refuse a folder that holds a link; the folder itself may be one."""
    refuse_links(root, "results folder", inside=True)


def root_of(path: Path) -> Path | None:
    """Return the folder of the study in which a path lies, None if it lies in none, or in a temporary folder."""
    for parent in list(path.parents)[:4]:
        if re.fullmatch(_TEMPORARY, parent.name):
            return None  # a file gets its record when the folder takes its place
        if (parent / "plan").is_dir() or (parent / MARK).is_file():
            if is_study(parent):
                return parent
    return None


def write_record(record: Path, names: dict[str, set[str]], current: bool) -> None:
    """Write a record of digests; `current` says whether it is that of the newest result."""
    above = "../" if record.parent.name == "plan" else ""
    lines = [f"{digest}  {above}{name}\n" for name in sorted(names) for digest in sorted(names[name])]
    write_text(record, "".join(["" if current else OUTDATED, *lines]))


def proved(root: Path, path: Path, known: Digests | None = None) -> bool:
    """Return whether a file has the content that this program gave it; `known` are the digests in the records."""
    if _proved_alone(root, path):
        return True
    digests = (listed(root) if known is None else known).get(path.relative_to(root).as_posix(), set())
    return bool(digests) and digest_of_file(path) in digests


def _proved_alone(root: Path, path: Path) -> bool:
    """Return whether what stands in a file proves without a record that this program wrote it."""
    name = path.relative_to(root).as_posix()
    form = next((content for names, content in FORMS.items() if re.fullmatch(names, name)), None)
    if name == MARK:
        return bool(mark(root))
    if form is None and not CASES.fullmatch(name):
        return False
    with contextlib.suppress(OSError):
        if stat.S_ISREG(os.lstat(path).st_mode):
            with open_here(path, "rb") as stream:
                content = stream.read()
            return sums_up(content) if form is None else bool(re.fullmatch(form, content, re.DOTALL))
    return False


def files_below(root: Path) -> list[Path]:
    """Return all files below a folder, in order."""
    return sorted(Path(place, name) for place, _, names in os.walk(root) for name in names)


def replaceable(path: Path, root: Path | None = None, same: str = "", known: Digests | None = None) -> bool:
    """Return whether a file of a study may be replaced as it stands, True also if there is none or no study.

    Parameters
    ----------
    path : pathlib.Path
        The file.
    root : pathlib.Path, optional
        The folder of its study; found if it is not given. Nothing is checked outside of studies.
    same : str
        Digest of the new content; a file that has it already is in nobody's way.
    known : dict, optional
        The digests in the records of the study; read if they are not given.

    Returns
    -------
    bool
        False if the file is named in a record but was changed since: it must be moved first.

    Raises
    ------
    InputError
        If a link, a folder, or a file of somebody else stands there.
    """
    root = root or root_of(path)
    if root is None:
        return True
    for part in _within(root, path):
        refuse_link(part, "results folder")
    try:
        before = os.lstat(path)
    except FileNotFoundError:
        return True
    except NotADirectoryError:
        raise InputError("results folder", str(path.parent), "a folder", "Move the file away.", "is a file") from None
    if stat.S_ISDIR(before.st_mode):
        raise InputError(path.name, str(path), "a file", "Move the folder away.", "is a folder")
    known = listed(root) if known is None else known
    if ((same and digest_of_file(path) == same) or proved(root, path, known)) and _unchanged(path, before):
        return True
    name = path.relative_to(root).as_posix()
    if not NAMED.fullmatch(name) and name not in known and not _has_damaged_record(root, path):
        remedy, wrong = "Move the file away or rename it, then start again.", "is in no record of this study"
        raise InputError("results folder", str(path), "a file that trackroller wrote", remedy, wrong)
    return False


def _has_damaged_record(root: Path, path: Path) -> bool:
    """Return whether the record of the result to which a file belongs was damaged, so that it names no file."""
    parts = path.relative_to(root).parts
    record = record_of(root, root.joinpath(*parts[: 2 if parts[0] == UNFINISHED else 1]))
    return os.path.lexists(record) and not _proved_alone(root, record)


def make_way(
    path: Path, root: Path | None = None, tell: Tell = warnings.warn, same: str = "", known: Digests | None = None
) -> None:
    """Make sure that a file of a study may be written: what was changed moves to `aside/`, see `replaceable`."""
    root = root or root_of(path)
    if root is not None and not replaceable(path, root, same, known):
        tell(f"{path} was altered after it was written: it is kept as {set_aside(root, path)}")


def _within(root: Path, path: Path) -> list[Path]:
    """Return a path and the folders above it, down to those in the folder of its study."""
    return [path, *(parent for parent in path.parents if root in parent.parents)]


def _unchanged(path: Path, before: os.stat_result) -> bool:
    """Return whether a file is still the one that was looked at."""
    with contextlib.suppress(OSError):
        return os.path.samestat(now := os.lstat(path), before) and now.st_mtime_ns == before.st_mtime_ns
    return False


def set_aside(root: Path, path: Path) -> Path:
    """Move a file of a study to the same place below `aside/`, under a free name, and return where it is."""
    goal = root / ASIDE / path.relative_to(root)
    for part in _within(root, goal):
        refuse_link(part, "results folder")
    with disk_errors(goal):
        goal.parent.mkdir(parents=True, exist_ok=True)
        free = (goal if n == 1 else goal.with_name(f"{goal.name}.{n}") for n in range(1, 1_000_000))
        goal = next(one for one in free if not os.path.lexists(one))
        os.rename(path, goal)
    return goal


def remove(path: Path, root: Path | None = None, known: Digests | None = None) -> bool:
    """Remove a file of a study if it is ours and unchanged, see `proved`, and return whether it is gone."""
    root = root or root_of(path)
    try:
        before = os.lstat(path)
    except OSError:
        return True
    if root is None or not (proved(root, path, known) and _unchanged(path, before)):
        return False
    path.unlink(missing_ok=True)
    return True


def clear(path: Path, root: Path | None = None, tell: Tell = warnings.warn) -> None:
    """Remove a file of a study, or move it to `aside/` if it was changed; refuse a file of somebody else."""
    make_way(path, root, tell)
    remove(path, root)


def write(path: Path, save: Callable[[Path], object], tell: Tell = warnings.warn) -> None:
    """Write a file whole, see `trackroller.files.write_whole`; inside the folder of a study, see `make_way`."""
    root = root_of(path)
    if root is None:
        write_whole(path, save)
        return
    make_way(path, root, tell)
    note(root, scratch_name(path))
    write_whole(path, save, ready=functools.partial(make_way, path, root, tell))


def write_text(path: Path, text: str) -> None:
    """Write a text file whole, see `write`."""
    write(path, lambda beside: beside.write_text(text, encoding="utf-8", newline="\n"))


def note(root: Path, scratch: Path) -> None:
    """Note the name of a temporary file of this process, so that `sweep` removes it if the process is killed."""
    notes, line = root / NOTES, f"{scratch.relative_to(root).as_posix()}\n"
    number, lines = _noted.get(str(notes), (0, set()))
    if number and number == _number(notes) and line in lines:
        return
    if not number or number != _number(notes):
        for part in _within(root, notes):
            refuse_link(part, "results folder")
        try:
            make_way(notes, root)
        except InputError:  # another process may have added a line between the two looks at the file
            if not _proved_alone(root, notes):
                raise
        lines = set()
    with disk_errors(notes):
        notes.parent.mkdir(exist_ok=True)
        with open_here(notes, "a") as stream:
            stream.write(line)
    lines.add(line)
    _noted[str(notes)] = _number(notes), lines


def _number(path: Path) -> int:
    """Return the number of a file in the file system, 0 if there is none."""
    try:
        return os.lstat(path).st_ino
    except OSError:
        return 0


def sweep(root: Path) -> None:
    """Remove the temporary files and folders that killed processes noted; only the sole holder of the lock may call it.

    A file that merely looks like a temporary one stays.
    """
    for path in _scratch_of(root):
        if any(map(is_link, _within(root, path))):
            continue
        if path.is_dir():
            shutil.rmtree(path, ignore_errors=True)
        else:
            path.unlink(missing_ok=True)
    remove(root / NOTES, root)


def adopt(root: Path) -> None:
    """Give the results of an earlier version, which lack our mark, their records, so that they stay ours.

    A file is listed with the digest that `plan.json` or the crate holds of it, and a page with that of what stands
    there. The content of any other file is not known to be ours: it will be moved to `aside/`, not overwritten.
    """
    if MADE_BY.items() <= mark(root).items():
        return
    stored = mark(root).get("inputs", {})
    known = of_crate(root) | {f"inputs/{name}": str(one["sha256"]) for name, one in stored.items()}
    for result in (*RESULTS, *(f"{UNFINISHED}/{page}" for page in PAGES)):
        path = root / result
        record = record_of(root, path)
        if os.path.lexists(record) or not os.path.lexists(path):
            continue
        files = files_below(path) if path.is_dir() else [path]
        names = {file.relative_to(root).as_posix(): file for file in files}
        digests = {n: {known.get(n) or _own_digest(root, file)} for n, file in names.items()}
        write_record(record, digests, current=names.keys() <= known.keys())


def _own_digest(root: Path, path: Path) -> str:
    """Return the digest of a page or a crate that an earlier version wrote without a record, otherwise `UNKNOWN`."""
    ours = is_page(path) or (path.name == METADATA and "inputs/study.yaml" in of_crate(root))
    return digest_of_file(path) if ours else UNKNOWN


def is_page(path: Path) -> bool:
    """Return whether a file is a report or an explorer that this program wrote, by its title."""
    with contextlib.suppress(OSError), open_here(path, "rb") as stream:
        head = stream.read(4096)
        return head.startswith(b"<!doctype html>") and any(title in head for title in _TITLES)
    return False


def free_for_workflow(root: Path, tell: Tell) -> None:
    """Move away or refuse what Snakemake would delete before it runs a job, although this program did not write it.

    Snakemake removes the outputs and log files of a job without a look at them, and the folder `figures/` as a whole.
    """
    figures = root / "figures"
    paths = [root / name for name in ("design.nc", "study.nc", "sensitivity.nc", "report.html", METADATA)]
    paths += [*(root / "plan").glob("*.solved"), *([] if figures.is_dir() else [figures])]
    paths += [file for place in ("figures", "logs", "looks") for file in files_below(root / place)]
    known = listed(root)
    changed = [path for path in paths if not replaceable(path, root, known=known)]
    for path in changed:
        make_way(path, root, tell, known=known)
    if any(figures in path.parents for path in changed):  # the other figures must go too, or none is drawn again
        for path in files_below(figures):
            remove(path, root, known)
        remove_empty(figures)


def delete_study(root: Path) -> None:
    """Delete the folder of a study with everything in it.

    Raises
    ------
    InputError
        If the folder is not that of a study, or holds a file of somebody else; nothing is deleted then.
    """
    check(root)
    scratch, files, known = _scratch_of(root), files_below(root), listed(root)
    foreign = [path for path in files if scratch.isdisjoint(_within(root, path)) and not proved(root, path, known)]
    if foreign:
        names = ", ".join(str(path.relative_to(root)) for path in foreign[:4])
        more = f" and {len(foreign) - 4} more" if len(foreign) > 4 else ""
        remedy = "Move these files away, or delete the folder yourself."
        wrong = f"holds files that trackroller did not write: {names}{more}"
        raise InputError("results folder", str(root), "a folder with files that trackroller wrote", remedy, wrong)
    sweep(root)
    # the records and the mark prove what the other files are, so they go last
    for path in sorted(files, key=lambda path: (path == root / MARK, path.suffix == ".sha256")):
        remove(path, root, known)
    remove_empty(root)


def remove_empty(root: Path) -> None:
    """Remove a folder and the folders in it, as far as no file is left in them."""
    for place, _, _ in os.walk(root, topdown=False):
        with contextlib.suppress(OSError):
            os.rmdir(place)
