"""Carriages of the live page: the loads of a text at once, its lives and margins later, and the
files of the folder.

The text of a carriage file is what the page keeps. Fields and the picture send changes of it, and
the answer holds the changed text, so that fields, picture and text show the same carriage.
"""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Any

import pydantic
import xarray as xr

from trackroller.app.studies import RESULTS, TEXTS, WRITTEN
from trackroller.app.tables import limits_on_page, part_on_page
from trackroller.carriage.example import EXAMPLE
from trackroller.carriage.file import Carriage, carriage_of
from trackroller.carriage.files import name_of_study, spectrum_of
from trackroller.carriage.solve import forces_of, solve_carriage
from trackroller.errors import InputError
from trackroller.files import files_beside, is_link, read_text, sha256, write_text
from trackroller.report.headlines import headline_of, warning_line
from trackroller.report.numbers import lives_in_years
from trackroller.report.tables.table import cell
from trackroller.results.answer import Answer
from trackroller.results.carriage_answer import answer_of_carriage, worst_place
from trackroller.roller.aliases import ALIASES
from trackroller.study.store.digests import digest_of_text
from trackroller.yaml_file import change_yaml, errors_by_line, parse_mapping, write_yaml

LONGEST = 200_000  # bytes of a file that the list looks into
HEADS = tuple(re.compile(rf"^{key}\s*:", re.M) for key in ("mass", "rollers", "cases"))
WHAT = "carriage file"
TABLES = (".csv", ".xlsx")  # ends of the names of shelves
# of others
RESERVED = ("materials.yaml", "materials.yml", "config.yaml", "mkdocs.yml", "workflow", "profiles")


class Change(pydantic.BaseModel):
    """A changed value of a carriage file; see `trackroller.yaml_file.change_yaml`."""

    path: list[str | int]
    value: str | None


def carriage_files() -> dict[str, Any]:
    """Return the carriage files and the tables of the folder, and the example with which the page
    begins.
    """
    paths = sorted(
        path.as_posix() for pattern in ("*.y*ml", "*/*.y*ml") for path in Path().glob(pattern)
    )
    files = [name for name in paths if is_carriage(Path(name))]
    return {"files": files, "tables": _tables(), "example": EXAMPLE}


def _tables() -> list[str]:
    """Return the tables of the folder, each of which may be a shelf of rollers."""
    ends = [pattern + end for pattern in ("*", "*/*") for end in TABLES]
    names = sorted(path.as_posix() for pattern in ends for path in Path().glob(pattern))
    return [name for name in names if _is_allowed(name)]


def _is_allowed(name: str) -> bool:
    """Return whether the page may read a table."""
    try:
        place_of(name, "shelf", TABLES, "rollers.csv")
    except InputError:
        return False
    return True


def is_carriage(path: Path) -> bool:
    """Return whether a file of this folder has the keys of a carriage file."""
    try:
        text = read_text(place_of(path.as_posix(), "file"), WHAT, LONGEST)
    except InputError:
        return False
    return _has_heads(text)


def _has_heads(text: str) -> bool:
    """Return whether a text has the keys that every carriage file has."""
    return all(head.search(text) for head in HEADS)


def _check_kind(text: str, path: Path) -> None:
    """Refuse a text that is no carriage file, which may be a file of another kind."""
    if not _has_heads(text):
        allowed = "a carriage file, with mass, rollers and cases at the beginning of lines"
        raise InputError(
            "file",
            path.as_posix(),
            allowed,
            "Give the name of a carriage file.",
            "is no carriage file",
        )


def open_carriage(file: str) -> dict[str, Any]:
    """Return the text of a carriage file of the folder, which the page may save under this name
    again.
    """
    path = place_of(file, "file")
    text = read_text(path, WHAT)
    _check_kind(text, path)
    WRITTEN.note({path.as_posix(): sha256(path)})
    return {"text": text}


def carriage_loads(
    text: str, file: str = "", changes: list[Change] | None = None
) -> dict[str, Any]:
    """Change the text of a carriage, and return the loads of its rollers by statics alone.

    Parameters
    ----------
    text : str
        A carriage file.
    file : str
        Its name, from whose folder it names the files of rollers; "" for the folder of the page.
    changes : list of Change, optional
        What is changed before.

    Returns
    -------
    dict
        `text` and its `values`; `errors` with field, line and message; `places` of rollers and
        masses, and `loads`, each None while the text is wrong.
    """
    out: dict[str, Any] = {
        "text": text,
        "values": None,
        "errors": [],
        "places": None,
        "loads": None,
    }
    try:
        out["text"] = text
        if changes:
            out["text"] = change_yaml(text, [(one.path, one.value) for one in changes], WHAT)
        out["values"] = parse_mapping(out["text"], WHAT)
        whole = _carriage(out["text"], file)
        out["places"] = _places(whole)
        out["loads"] = _loads(forces_of(whole))
    except InputError as exc:
        out["errors"] = _errors(exc)
    return out


def _errors(exc: InputError) -> list[dict[str, Any]]:
    return [{"field": one.field, "line": one.line, "message": str(one)} for one in exc.errors]


def _carriage(text: str, file: str) -> Carriage:
    """Return the checked carriage of a text."""
    if file:
        path = place_of(file, "file")
    else:
        path = Path("carriage.yaml")
    values = parse_mapping(text, WHAT)
    with errors_by_line(text, aliases=ALIASES), files_beside(path):
        return carriage_of({"name": path.stem} | values)


def _places(whole: Carriage) -> dict[str, Any]:
    """Return where rollers and masses are, for the picture."""
    rollers = [
        {"name": r.name, "at": r.at.tolist(), "pushes": r.pushes.tolist(), "axis": r.axis.tolist()}
        for r in whole.rollers
    ]
    masses = [
        {"at": mass.at.tolist(), "value": mass.value} for mass in (whole.mass, *whole.payloads)
    ]
    return {"rollers": rollers, "masses": masses, "cases": [case.name for case in whole.cases]}


def _loads(ds: xr.Dataset) -> dict[str, Any]:
    """Return the forces as numbers by load case and roller, and as a table with a row for each
    roller.
    """
    radial, axial = (ds[name].values for name in ("radial_force", "axial_force"))
    rows = []
    for name, radials, axials in zip(ds["roller"].values, radial.T, axial.T, strict=True):
        rows.append([str(name), *map(_force_cell, radials, axials)])
    note = (
        "Radial forces below 0 press the roller on its rail; axial forces act on the roller "
        "along its own axis x_R."
    )
    table = {
        "title": "Radial / axial force of the rollers by load case [N]",
        "heads": ["Roller", *map(str, ds["load_case"].values)],
        "rows": rows,
        "note": note,
    }
    return {
        "radial": radial.tolist(),
        "axial": axial.tolist(),
        "worst": worst_place(ds)[1],
        "table": table,
        **_headline(answer_of_carriage(ds)),
    }


def _force_cell(radial: float, axial: float) -> str:
    """Return the cell of a roller in a load case."""
    if radial == 0:
        return "lifted"
    return f"{cell(float(radial))} / {cell(float(axial))}"


def _headline(answer: Answer) -> dict[str, Any]:
    """Return the headline of a record and its warnings as texts."""
    headline = headline_of(answer)
    warnings = [warning_line(caution) for caution in answer.warnings]
    return {"headline": {"lead": headline.lead, "rest": headline.ending}, "warnings": warnings}


def carriage_lives(text: str, file: str = "") -> dict[str, Any]:
    """Return the record of a carriage with lives and margins: headline, warnings, and its tables as
    texts.
    """
    return _lives(solve_carriage(_carriage(text, file)))


@lives_in_years
def _lives(ds: xr.Dataset) -> dict[str, Any]:
    answer = answer_of_carriage(ds)
    shown = [column.name for column in answer.columns]
    return {
        **_headline(answer),
        "answer": answer.to_dict(),
        "tables": [
            limits_on_page(answer, shown),
            *(part_on_page(answer, part) for part in answer.parts),
        ],
        "worst": str(ds.attrs.get("worst_roller", "")),
    }


def save_carriage(text: str, file: str, opened: str = "") -> dict[str, str]:
    """Write a carriage file into the folder.

    Parameters
    ----------
    text : str
        The text of the page.
    file : str
        Name of the file.
    opened : str
        The file from which the text comes, "" for the example: no other file is replaced.

    Raises
    ------
    InputError
        If the file is there and the text comes from another one, or if somebody has changed it in
        the meantime.
    """
    path = place_of(file, "file")
    _check_kind(text, path)
    if os.path.lexists(path) and Path(opened) != path:
        remedy = "Give it another name, or open the file first."
        raise InputError(
            "file",
            path.as_posix(),
            "the file that is open, or a new one",
            remedy,
            "is there already",
        )
    return {"file": _write(path, text)}


def carriage_spectrum(text: str, roller: str, file: str = "") -> dict[str, str]:
    """Write the load spectrum of a roller into the folder, as `trackroller carriage --spectrum`
    does.
    """
    whole = _carriage(text, file)
    values = spectrum_of(whole, forces_of(whole), roller)
    name = name_of_study(f"{whole.name}-{roller}")
    return {
        "file": _write(
            place_of((Path(file).parent / f"{name}.yaml").as_posix(), "file"), write_yaml(values)
        )
    }


def place_of(
    file: str, field: str, ends: tuple[str, ...] = (".yaml", ".yml"), example: str = "shuttle.yaml"
) -> Path:
    """Return the path of a file in this folder, or in a folder of it that is not the page's
    own.
    """
    path = Path(file.strip())
    allowed = f"a name such as {example}, in this folder or in a folder of it"
    whole = path.suffix.lower() in ends and file.isprintable() and not path.is_absolute()
    hidden = any(part.startswith(".") for part in path.parts)
    if not whole or hidden or len(path.parts) > 2 or path.parts[0] in (RESULTS.name, TEXTS.name):
        raise InputError(
            field, file[:200], allowed, f"Give the file a name that ends in {ends[0]}."
        )
    if path.name.lower() in RESERVED or path.parts[0].lower() in RESERVED:
        remedy = f"Give the file another name, such as {example}."
        raise InputError(field, file, allowed, remedy, "is a name of another kind of file")
    if is_link(path) or is_link(path.parent):
        raise InputError(field, file, allowed, "Copy the file here.", "is a link")
    return path


def _write(path: Path, text: str) -> str:
    """Write a file, unless somebody else has changed it since the page read or wrote it."""
    digest = digest_of_text(text)
    if not WRITTEN.owns(path, digest):
        remedy = "Give it another name, or open the file first."
        raise InputError(
            "file",
            path.as_posix(),
            "a file as this page last read or wrote it",
            remedy,
            "is there already",
        )
    WRITTEN.note({path.as_posix(): digest})
    write_text(path, text)
    return path.as_posix()
