"""Decorators that compile functions with every option stated, so that digits do not depend on the order of compilation.

numba takes an option that a function leaves open from the function that calls it first, and keeps the result in its
cache. The options of floating-point arithmetic would thus depend on which kernels the cache held before.

numba's own functions for powers, `hypot` and complex numbers are compiled once in a process as well, with the options
of their first caller. Functions with `FAST` arithmetic therefore use products and `sqrt` instead
(tests/numerics/test_compiled.py).
"""

from __future__ import annotations

import contextlib
import os
import re
import warnings
from pathlib import Path
from typing import Any

import numba
from numba import njit
from numba.extending import register_jitable
from numba.misc.appdirs import AppDirs

from trackroller.environment import is_writable, temporary_cache
from trackroller.errors import InputError

COMPILES = re.compile(rf"^\s*(?:import|from) (?:numba|{re.escape(__name__)})\b", re.MULTILINE)  # in a source file
FAST = {"reassoc", "contract", "arcp", "nsz"}  # lets loops run in vectors; keeps NaN and inf
_PLAIN: dict[str, Any] = {"error_model": "numpy", "fastmath": False}
_FAST: dict[str, Any] = {"error_model": "numpy", "fastmath": FAST}


def forget_stale(package: Path) -> None:
    """Delete what numba compiled below a folder before a source file of compiled functions was changed there.

    A function becomes a part of its callers, but numba compiles again only the functions of the changed file. Callers
    in other files would go on with the old one.
    """
    with contextlib.suppress(OSError):  # a folder that cannot be written, or another process that deletes the same
        kernels = {path: path.stat().st_mtime for path in package.glob("**/__pycache__/*.nb[ic]")}
        oldest = min(kernels.values(), default=float("inf"))
        changed = [path for path in package.glob("**/*.py") if path.stat().st_mtime > oldest]
        texts = {path: path.read_text(encoding="utf-8") for path in changed}
        newest = max((p.stat().st_mtime for p, text in texts.items() if COMPILES.search(text)), default=0)
        for path, time in kernels.items():
            if time < newest:
                path.unlink(missing_ok=True)


def can_cache(package: Path) -> bool:
    """Return whether numba can keep what it compiles, after a temporary folder was named for it where needed.

    numba keeps the compiled functions of a file beside the file, or in the cache folder of the user. If it can write
    neither, it refuses to compile.

    Parameters
    ----------
    package : pathlib.Path
        Folder of the files with compiled functions.

    Returns
    -------
    bool
        False if the temporary folder cannot be written either.
    """
    given = os.environ.get("NUMBA_CACHE_DIR")
    users = AppDirs("numba", appauthor=False).user_cache_dir
    if given:
        can_write = is_writable(given)
    else:
        beside = {file.parent / "__pycache__" for file in package.rglob("*.py")}
        can_write = all(map(is_writable, beside)) or is_writable(users)
    if can_write:
        return True
    place = temporary_cache("NUMBA_CACHE_DIR", "numba", given or users)
    if place is None:
        warnings.warn(
            "no folder for compiled functions can be written, so this run compiles them anew, which takes a minute. "
            "Set NUMBA_CACHE_DIR to a folder that can be written.",
            stacklevel=3,
        )
        return False
    vars(numba.config)["CACHE_DIR"] = str(place)  # the environment was read when numba was imported
    return True


def check_compiler() -> None:
    """Refuse the setting of numba that leaves functions uncompiled; their records work in compiled code only."""
    if vars(numba.config)["DISABLE_JIT"]:
        raise InputError(
            "environment variable NUMBA_DISABLE_JIT",
            os.environ.get("NUMBA_DISABLE_JIT", "1"),
            "0, or no such variable",
            "Remove the variable (`unset NUMBA_DISABLE_JIT`), or remove disable_jit from .numba_config.yaml.",
            wrong="switches off the compiler that the solver needs",
        )


check_compiler()
PACKAGE = Path(__file__).parents[1]
forget_stale(PACKAGE)
CACHE = can_cache(PACKAGE)
_CACHED: dict[str, Any] = {"cache": CACHE, "nogil": True, "forceinline": False}
# of functions that only compiled functions call: always inlined, without the wrappers for callers in Python
_INNER: dict[str, Any] = {"cache": CACHE, "forceinline": True, "no_cpython_wrapper": True, "no_cfunc_wrapper": True}

compiled: Any = njit(**_PLAIN, **_CACHED)
fast: Any = njit(**_FAST, **_CACHED)
inner: Any = njit(**_FAST, **_INNER)
# for functions that become a part of each caller, with the options of that caller
woven: Any = njit(inline="always")


@woven
def assign(out, values):
    """Write an array into `out`, both contiguous and of the same size.

    numba's own ``out[:] = values`` brings the text of an error into each caller, which takes a third of the time to
    compile the solver.
    """
    source, target = values.reshape(-1), out.reshape(-1)
    for k in range(source.size):
        target[k] = source[k]


# for functions that compiled code calls with numbers, and plain Python with arrays
formula: Any = register_jitable(**_PLAIN, forceinline=True)
fast_formula: Any = register_jitable(**_FAST, forceinline=True)
