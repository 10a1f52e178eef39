"""Sort the entries of a case file, of the command line and of the live page: case, options, and
what goes with them.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from trackroller.damage.own import check_fields
from trackroller.errors import Collector, InputError, check_names, checked_text, unknown_name
from trackroller.materials import load_database
from trackroller.parameters import MATERIAL_FIELDS, OPTIONS
from trackroller.roller.aliases import ALIASES, OTHER_OPTIONS, RADII, renamed, with_options
from trackroller.roller.case import FIELDS, Case
from trackroller.roller.duty import STROKES_ATTRIBUTE, checked_duty, of_roller, strokes_in
from trackroller.roller.fields import other_than_default
from trackroller.roller.log_answers import checked_log
from trackroller.roller.output_names import PARTS
from trackroller.roller.requirement import checked_requirement, written

if TYPE_CHECKING:
    import xarray as xr

# texts at the head of a sheet
SHEET_FIELDS = ("project", "part", "revision", "date", "author", "checker")
# entries that change no result, and that a result keeps as attributes
BESIDE = ("duty", "sheet", "requirement", "log")
LONGEST = 200  # signs of a text at the head of a sheet


def checked_sheet(value: Any) -> dict[str, str]:
    """Return the texts at the head of a sheet by their names in `SHEET_FIELDS`.

    Raises
    ------
    InputError
        If the value is no mapping, or for an unknown name or a text that is none.

    Examples
    --------
    >>> checked_sheet({"project": "Lift 7", "revision": 2})
    {'project': 'Lift 7', 'revision': '2'}
    """
    if not isinstance(value, Mapping):
        remedy = "Write sheet: {project: Lift 7, part: R-12, author: Ada}."
        raise InputError("sheet", value, f"texts by name: {', '.join(SHEET_FIELDS)}", remedy)
    check_names("sheet: key", value, SHEET_FIELDS)
    given = {name: text for name, text in value.items() if text is not None}
    wrong = Collector()
    for name, text in given.items():
        with wrong.part():
            if (
                isinstance(text, bool)
                or not isinstance(text, (str, int, float))
                or len(str(text)) > LONGEST
            ):
                allowed = f"a text of at most {LONGEST} signs"
                raise InputError(f"sheet.{name}", text, allowed, "Write a short text, in quotes.")
            checked_text(str(text), f"sheet.{name}")
    wrong.check()
    return {name: str(text) for name, text in given.items()}


def with_beside(ds: xr.Dataset, beside: Mapping[str, Any]) -> xr.Dataset:
    """Return the result of one case with what `checked_case` returned beside it as attributes."""
    return ds.assign_attrs({name: json.dumps(value) for name, value in beside.items()})


def sheet_of(ds: xr.Dataset) -> dict[str, str]:
    """Return the texts at the head of the sheet of a result; {} if none were given."""
    return json.loads(ds.attrs.get("sheet", "{}"))


LOADS = ("radial_force", "axial_force")


def parts_for_spectrum(given: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return what a load spectrum takes of a roller's file.

    Parameters
    ----------
    given : mapping
        The file.

    Returns
    -------
    tuple of dict
        The fields that describe the roller, without its loads, options and entries `BESIDE`; and
        the options that a spectrum file takes.
    """
    fields = {key: value for key, value in given.items() if key not in (*OPTIONS, *BESIDE)}
    options = {
        key: given[key]
        for key, option in OPTIONS.items()
        if key in given and "spectrum" in option.files
    }
    return {key: value for key, value in renamed(fields).items() if key not in LOADS}, options


def _checked_beside(key: str, value: Any, duty: Mapping[str, float] | None) -> Any:
    """Return the checked value of an entry of `BESIDE`, as JSON holds it."""
    if key == "duty":
        return checked_duty(value)
    if key == "sheet":
        return checked_sheet(value)
    if key == "log":
        return checked_log(value)
    required = checked_requirement(value, duty)
    for name, own in required.items():
        if name not in PARTS:
            raise unknown_name("requirement", name, PARTS)
        if own.in_shares:
            allowed = "min and max: one roller has one condition"
            raise InputError(
                f"requirement.{name}.probability", own.probability, allowed, "Write it in a study."
            )
    return written(required)


def _by_strokes(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the duty of a roller in hours, and what follows from its strokes."""
    duty = checked_duty(values["duty"])
    case = Case.from_dict(
        {key: value for key, value in values.items() if key in (*FIELDS, *ALIASES, *RADII)}
    )
    if "velocity" in case.not_given:
        velocity = None
    else:
        velocity = case.velocity
    in_time, given = of_roller(duty, velocity, case.guide_overrollings_per_hour)
    return {"duty": in_time, **given}


def checked_case(values: Mapping[str, Any]) -> tuple[Case, dict[str, Any], dict[str, Any]]:
    """Return the case, the options of `solve`, and the entries `BESIDE` of a case file that are
    given.

    The duty is in hours; strokes stand beside it as `strokes`, as they were given.

    Parameters
    ----------
    values : mapping
        Fields of a case, options, and the entries `BESIDE` by name.

    Raises
    ------
    InputError
        For an unknown name and for every value that `Case` refuses, all of them together.

    Examples
    --------
    >>> values = {"axial_force": 70, "contact_model": "sliding", "sheet": {"part": 7}}
    >>> case, options, beside = checked_case(values)
    >>> case.axial_force, options, beside
    (70.0, {'contact_model': 'sliding'}, {'sheet': {'part': '7'}})
    """
    fields = with_options(values)
    wrong = Collector()
    beside: dict[str, Any] = {}
    options = {key: fields.pop(key) for key in OPTIONS if key in fields}
    if fields.get("duty") is not None:
        with wrong.part():
            strokes = strokes_in(checked_duty(fields["duty"]))
            if strokes is not None:
                fields |= _by_strokes(fields)
                beside[STROKES_ATTRIBUTE] = strokes
    for key in (name for name in BESIDE if name in fields):
        with wrong.part():
            beside[key] = _checked_beside(key, fields.pop(key), beside.get("duty"))
    with wrong.part():
        check_fields(
            "case field", fields, (*FIELDS, *ALIASES, *RADII, *OPTIONS, *OTHER_OPTIONS, *BESIDE)
        )
    for key in options:
        if OPTIONS[key].kind == "words" and isinstance(options[key], str):
            options[key] = [part.strip() for part in options[key].split(",")]
    with wrong.part():
        case = Case.from_dict(
            {key: value for key, value in fields.items() if key in (*FIELDS, *ALIASES, *RADII)}
        )
    database = load_database()
    for name in MATERIAL_FIELDS:
        with wrong.part():
            if isinstance(fields.get(name), str):
                database.material(fields[name], name)
    with wrong.part():
        if options:
            from trackroller.roller.options import Options  # heavy: numba

            Options(**options)  # refuses wrong options before the solver is imported
    wrong.check()
    if "outputs" in options:
        from trackroller.damage import check_used  # heavy: scipy

        given = {name: getattr(case, name) for name in FIELDS if name not in case.not_given}
        given = other_than_default(given) | beside
        check_used(given, options["outputs"], options.get("not_checked", ()))
    return case, options, beside
