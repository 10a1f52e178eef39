"""Parameter studies of locating-bearing track rollers: forces, tractions, stresses, fatigue life.

`Case`, `solve` and `load_study` are the way in; `stress_from_tractions` serves any other contact. Heavy parts are
imported when they are first used.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

_WHERE = {
    "Case": "trackroller.roller.case",
    "InputError": "trackroller.errors",
    "solve": "trackroller.roller.solver",
    "load_study": "trackroller.study.file.load",
    "open_study": "trackroller.solved",
    "run": "trackroller.solved",
    "wear": "trackroller.roller.wear",
    "load_database": "trackroller.materials",
    "stress_from_tractions": "trackroller.halfspace.stress",
    "stress_on_grid": "trackroller.halfspace.stress",
    "von_mises": "trackroller.halfspace.stress",
    "principal_stresses": "trackroller.halfspace.stress",
    "max_shear": "trackroller.halfspace.stress",
}
__all__ = [
    "Case",
    "InputError",
    "__version__",
    "app",
    "load_database",
    "load_study",
    "max_shear",
    "open_study",
    "principal_stresses",
    "report",
    "run",
    "solve",
    "stress_from_tractions",
    "stress_on_grid",
    "von_mises",
    "wear",
]

if TYPE_CHECKING:
    from trackroller import app, report
    from trackroller.errors import InputError
    from trackroller.halfspace.stress import (
        max_shear,
        principal_stresses,
        stress_from_tractions,
        stress_on_grid,
        von_mises,
    )
    from trackroller.materials import load_database
    from trackroller.roller.case import Case
    from trackroller.roller.solver import solve
    from trackroller.roller.wear import wear
    from trackroller.solved import open_study, run
    from trackroller.study.file.load import load_study


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used."""
    if name in ("app", "report"):
        return importlib.import_module(f"trackroller.{name}")  # the module itself can be called
    if name in _WHERE:
        return getattr(importlib.import_module(_WHERE[name]), name)
    raise AttributeError(f"module 'trackroller' has no attribute {name!r}")


def __dir__() -> list[str]:
    """Return the public names, those that are not imported yet included."""
    return sorted(__all__)
