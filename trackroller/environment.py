"""The environment of this process and of the processes that it starts: what Python imports, and
where caches stand.
"""

from __future__ import annotations

import contextlib
import os
import stat
import sys
import tempfile
import warnings
from pathlib import Path

OWN = Path(__file__).resolve().parents[1]  # the folder that this package was imported from
try:  # before a page takes a temporary folder of its own, which is deleted at its end
    TEMPORARY: Path | None = Path(tempfile.gettempdir())
except OSError:
    TEMPORARY = None
# Python puts neither the working folder nor the folder of a script on its path
SAFE_PATH = "PYTHONSAFEPATH"


def python(module: str, *words: str) -> list[str]:
    """Return the words that run a module in a Python of its own, which imports nothing from the
    working folder.

    Examples
    --------
    >>> python("trackroller.cli", "--version")[1:]
    ['-P', '-m', 'trackroller.cli', '--version']
    """
    return [sys.executable, "-P", "-m", module, *words]


def forget_working_folder() -> None:
    """Remove the working folder from the path if `python -m` has put it there, so that no file of
    it is imported.

    The folder stays if this package itself was imported from it.
    """
    if not sys.flags.safe_path and Path(sys.path[0]).resolve() != OWN:
        del sys.path[0]


def leave_out(*packages: str) -> None:
    """Let imports of optional packages fail in this process, unless they are there already.

    Libraries import them where they can, which costs a command of one case a quarter of its time.
    """
    for package in packages:
        sys.modules.setdefault(package, None)  # type: ignore[arg-type] # Python reads None as not there


def take_in(package: str) -> None:
    """Let a package be imported again that `leave_out` has named."""
    if sys.modules.get(package, sys) is None:
        del sys.modules[package]


def import_nothing_from(folder: Path) -> None:
    """Let neither this process nor those that it starts import Python files from a folder.

    The folder is about to become the working folder, and relative entries of a path would name it.
    The folder stays on the path if this package itself was imported from it.
    """
    banned = {folder.resolve()} - {OWN}
    sys.path[:] = [
        entry for entry in map(os.path.abspath, sys.path) if Path(entry).resolve() not in banned
    ]
    entries = [
        os.path.abspath(entry)
        for entry in os.environ.get("PYTHONPATH", "").split(os.pathsep)
        if entry
    ]
    if entries:
        os.environ["PYTHONPATH"] = os.pathsep.join(
            e for e in entries if Path(e).resolve() not in banned
        )
    else:
        os.environ.pop("PYTHONPATH", None)
    os.environ[SAFE_PATH] = "1"


def is_writable(folder: str | Path) -> bool:
    """Return whether a file can be written into a folder, which is created if it is not there."""
    if str(folder).startswith("~"):  # the system does not know the home
        return False
    try:
        os.makedirs(folder, exist_ok=True)
        tempfile.TemporaryFile(dir=folder).close()
    except OSError:
        return False
    return True


def let_matplotlib_cache() -> None:
    """Name a temporary folder for Matplotlib if it cannot keep its list of fonts where it usually
    does.
    """
    given = os.environ.get("MPLCONFIGDIR")
    home = os.path.expanduser("~")
    usual = [os.path.join(home, ".matplotlib")]
    if sys.platform.startswith(("linux", "freebsd")):
        kinds = {"XDG_CONFIG_HOME": ".config", "XDG_CACHE_HOME": ".cache"}
        places = [
            os.environ.get(name) or os.path.join(home, folder) for name, folder in kinds.items()
        ]
        usual = [os.path.join(place, "matplotlib") for place in places]
    if given:
        usual = [given]
    bad = next((place for place in usual if not is_writable(place)), None)
    if bad is not None:
        temporary_cache("MPLCONFIGDIR", "matplotlib", bad)


def temporary_cache(variable: str, name: str, instead: str) -> Path | None:
    """Name a temporary folder in an environment variable and say so.

    Parameters
    ----------
    variable, name : str
        Environment variable of a library, and the name of the library.
    instead : str
        The folder that the library would take, which cannot be written.

    Returns
    -------
    pathlib.Path or None
        The folder; None if no temporary folder can be written either.
    """
    root = _temporary_folder()
    if root is None or not is_writable(root / name):
        return None
    os.environ[variable] = str(root / name)  # processes that this one starts take it without a word
    if instead.startswith("~"):
        why = "this user has no home"
    else:
        why = f"{instead} cannot be written"
    remedy = f"Set {variable} to a folder that stays and can be written."
    warnings.warn(f"{why}, so {name} keeps its cache in {root / name}. {remedy}", stacklevel=4)
    return root / name


def _temporary_folder() -> Path | None:
    """Return a folder for caches that nobody else can write, the same for each process of a user;
    None without one.

    Caches hold compiled code, so a folder that another user prepared under this name is not taken.
    The working folder, which Python takes where the system has no temporary folder, may hold files
    of other people.
    """
    if TEMPORARY is None:
        return None
    with contextlib.suppress(OSError):
        if (
            TEMPORARY.resolve() == Path.cwd().resolve()
            and not TEMPORARY.stat().st_mode & stat.S_ISVTX
        ):
            return None
        user = os.getuid() if hasattr(os, "getuid") else None
        folder = TEMPORARY / f"trackroller-{'cache' if user is None else user}"
        with contextlib.suppress(FileExistsError):
            folder.mkdir(mode=0o700)
        state = folder.lstat()
        own = stat.S_ISDIR(state.st_mode) and (
            user is None or (state.st_uid == user and not state.st_mode & 0o022)
        )
        if own and is_writable(folder):
            return folder
        return Path(tempfile.mkdtemp(prefix="trackroller-", dir=TEMPORARY))
    return None
