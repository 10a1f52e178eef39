"""Parameter studies of locating-bearing track rollers: forces, tractions, stresses, fatigue life.

`Case`, `solve` and `load_study` are the way in; `stress_from_tractions` serves any other contact.
Heavy parts are imported when they are first used.
"""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import TYPE_CHECKING, Any

from trackroller.fit import SHOWN as _SHOWN_OF_FIT
from trackroller.results import SHOWN as _SHOWN_OF_RESULTS

__version__ = "0.1.0"

_WHERE = {
    "Case": "trackroller.roller.case",
    "InputError": "trackroller.errors",
    "explore": "trackroller.report.show",
    "find": "trackroller.roller.find",
    "fit_bench": "trackroller.fit.bench",
    "fit_catalogue": "trackroller.fit.catalogue",
    "fit_sn": "trackroller.fit.coupons",
    "next_tests": "trackroller.fit.next_tests",
    "patch": "trackroller.one_patch.solve",
    "solve": "trackroller.roller.solver",
    "load_study": "trackroller.study.file.load",
    "open_study": "trackroller.results.stored_study",
    "run": "trackroller.results.run",
    "size": "trackroller.results.size",
    "wear": "trackroller.roller.wear",
    "workbook": "trackroller.report.show",
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
    from trackroller.fit.catalogue import fit_catalogue as fit_catalogue
    from trackroller.fit.coupons import fit_sn as fit_sn
    from trackroller.fit.next_tests import next_tests as next_tests
    from trackroller.halfspace.stress import max_shear as max_shear
    from trackroller.halfspace.stress import principal_stresses as principal_stresses
    from trackroller.halfspace.stress import stress_from_tractions as stress_from_tractions
    from trackroller.halfspace.stress import stress_on_grid as stress_on_grid
    from trackroller.halfspace.stress import von_mises as von_mises
    from trackroller.materials import load_database as load_database
    from trackroller.one_patch.solve import patch as patch
    from trackroller.report.show import explore as explore
    from trackroller.report.show import workbook as workbook
    from trackroller.results.run import run as run
    from trackroller.results.size import size as size
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


def _report(result: Any, path: Path | str) -> Path:
    """Write the page of a result, see `trackroller.report`."""
    from trackroller.report import write

    return write(result, path)


def _explore(results: Any, path: Path | str | None = None) -> Any:
    """Show the explorer of a study, see `trackroller.explore`."""
    from trackroller.report.show import explore

    return explore(results, path)


def _workbook(results: Any, path: Path | str) -> Path:
    """Write the cases of a study as a file, see `trackroller.workbook`."""
    from trackroller.report.show import workbook

    return workbook(results, path)


def _notebook_view(results: Any) -> str:
    """Show the answer to a study in a notebook."""
    from trackroller.report.show import view

    return view(results)._repr_html_()


_SHOWN_OF_FIT.update(report=_report)
_SHOWN_OF_RESULTS.update(
    report=_report, explore=_explore, export=_workbook, _repr_html_=_notebook_view
)


def __dir__() -> list[str]:
    """Return the public names, those that are not imported yet included."""
    return sorted(__all__)
