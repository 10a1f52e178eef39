"""Sort the entries of a case file, of the command line and of the live page into case, options and duty."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from trackroller.errors import Collector, check_names
from trackroller.materials import load_database
from trackroller.parameters import MATERIAL_FIELDS, OPTIONS
from trackroller.roller.aliases import ALIASES, RADII
from trackroller.roller.case import FIELDS, Case
from trackroller.roller.duty import checked_duty
from trackroller.roller.fields import other_than_default


def checked_case(values: Mapping[str, Any]) -> tuple[Case, dict[str, Any], dict[str, float] | None]:
    """Return the case, the options of `solve` and the duty among the entries of a case file.

    Parameters
    ----------
    values : mapping
        Fields of a case, options and `duty` by name.

    Raises
    ------
    InputError
        For an unknown name and for every value that `Case` refuses, all of them together.

    Examples
    --------
    >>> case, options, duty = checked_case({"axial_force": 70, "contact_model": "sliding"})
    >>> case.axial_force, options, duty
    (70.0, {'contact_model': 'sliding'}, None)
    """
    left = dict(values)
    wrong, duty = Collector(), None
    options = {key: left.pop(key) for key in OPTIONS if key in left}
    with wrong.part():
        duty = checked_duty(left.pop("duty")) if "duty" in left else None
    with wrong.part():
        check_names("case field", left, (*FIELDS, *ALIASES, *RADII, *OPTIONS, "duty"))
    for key in options:
        if OPTIONS[key].kind == "words" and isinstance(options[key], str):
            options[key] = [part.strip() for part in options[key].split(",")]
    with wrong.part():
        case = Case.from_dict({key: value for key, value in left.items() if key in (*FIELDS, *ALIASES, *RADII)})
    database = load_database()
    for name in MATERIAL_FIELDS:
        with wrong.part():
            if isinstance(left.get(name), str):
                database.material(left[name], name)
    with wrong.part():
        if options:
            from trackroller.roller.options import Options  # heavy: numba

            Options(**options)  # refuses wrong options before the solver is imported
    wrong.check()
    if "outputs" in options:
        from trackroller.damage import check_used  # heavy: scipy

        given = {name: getattr(case, name) for name in FIELDS if name not in case.not_given}
        check_used(other_than_default(given), options["outputs"], options.get("not_checked", ()))
    return case, options, duty
