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
    "find": "trackroller.roller.find",
    "fit_bench": "trackroller.fit.bench",
    "fit_sn": "trackroller.fit.coupons",
    "next_tests": "trackroller.fit.next_tests",
    "solve": "trackroller.roller.solver",
    "load_study": "trackroller.study.file.load",
    "open_study": "trackroller.results.stored_study",
    "run": "trackroller.results.solving",
    "wear": "trackroller.roller.wear",
    "load_database": "trackroller.materials",
    "stress_from_tractions": "trackroller.halfspace.stress",
    "stress_on_grid": "trackroller.halfspace.stress",
    "von_mises": "trackroller.halfspace.stress",
    "principal_stresses": "trackroller.halfspace.stress",
    "max_shear": "trackroller.halfspace.stress",
}
__all__ = ["__version__", "app", "carriage", "report", *_WHERE]

if TYPE_CHECKING:
    from trackroller import app as app
    from trackroller import carriage as carriage
    from trackroller import report as report
    from trackroller.errors import InputError as InputError
    from trackroller.fit.bench import fit_bench as fit_bench
    from trackroller.fit.coupons import fit_sn as fit_sn
    from trackroller.fit.next_tests import next_tests as next_tests
    from trackroller.halfspace.stress import max_shear as max_shear
    from trackroller.halfspace.stress import principal_stresses as principal_stresses
    from trackroller.halfspace.stress import stress_from_tractions as stress_from_tractions
    from trackroller.halfspace.stress import stress_on_grid as stress_on_grid
    from trackroller.halfspace.stress import von_mises as von_mises
    from trackroller.materials import load_database as load_database
    from trackroller.results.solving import run as run
    from trackroller.results.stored_study import open_study as open_study
    from trackroller.roller.case import Case as Case
    from trackroller.roller.find import find as find
    from trackroller.roller.solver import solve as solve
    from trackroller.roller.wear import wear as wear
    from trackroller.study.file.load import load_study as load_study


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used."""
    if name in ("app", "carriage", "report"):
        return importlib.import_module(f"trackroller.{name}")  # the module itself can be called
    if name in _WHERE:
        return getattr(importlib.import_module(_WHERE[name]), name)
    raise AttributeError(f"module 'trackroller' has no attribute {name!r}")


def __dir__() -> list[str]:
    """Return the public names, those that are not imported yet included."""
    return sorted(__all__)
