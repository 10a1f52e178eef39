"""Heads and codes of tables of tests as people write them: `stress_amplitude_MPa`, `runout`, `x`.

A head that is known by another name stands for one column, and a code has one meaning under its
head. Whatever could mean two things is refused, and a fit says in its notes how it read such a
head.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass

from trackroller.errors import InputError, listing
from trackroller.numerics.table_cells import split_head

NAMES_OF_TESTS = {
    "test": "specimen specimen_id specimen_no specimen_number specimen_name test_id test_no "
    "sample sample_id coupon id "
    "no nr number probe proben_nr",
    "note": "notes comment comments remark remarks bemerkung kommentar",
}
OF_COUPONS = NAMES_OF_TESTS | {
    "amplitude": "amp load load_amplitude stress stress_amplitude stress_amp stress_s s sa s_a "
    "s_amp sigma sigma_a "
    "nominal_stress nominal_stress_amplitude spannung spannungsamplitude lastamplitude last",
    "cycles": "cycle n nf n_f cycles_n cycles_to_failure cycles_to_fracture number_of_cycles "
    "load_cycles life_cycles "
    "cycle_count fatigue_life lastspiele lastspielzahl schwingspiele schwingspielzahl",
    "failed": "failure fail fracture fractured broken broke event is_failure is_failed bruch "
    "gebrochen",
    "censored": "censor is_censored right_censored runout run_out runouts run_outs is_runout "
    "is_run_out suspended "
    "suspension survived survivor unbroken durchläufer durchlaeufer",
    "status": "result outcome end ending state ergebnis",
    "group": "series batch lot serie charge",
}
# words of a head behind the name that are a unit
UNITS_OF_HEADS = {
    "mpa": "MPa",
    "gpa": "GPa",
    "kpa": "kPa",
    "n_mm2": "N/mm2",
    "ksi": "ksi",
    "psi": "psi",
    "msi": "Msi",
}

YES = ("1", "1.0", "true", "yes", "y", "ja", "j", "x", "wahr")
NO = ("0", "0.0", "false", "no", "n", "nein", "none", "falsch")
FAILED = (
    "failed",
    "failure",
    "fail",
    "fracture",
    "fractured",
    "broken",
    "break",
    "bruch",
    "gebrochen",
    "crack",
)
WHOLE = (
    *("runout", "survived", "survivor", "suspended", "suspension", "censored", "unbroken"),
    *("unfailed", "notfailed", "nofailure", "durchläufer", "durchlaeufer", "intact"),
)
MARK = "x"  # the one code beside which an empty cell says the opposite


@dataclass(frozen=True)
class Head:
    """What the head of a column stands for: name of the column, and the unit that the head states,
    '' for none.
    """

    column: str
    unit: str = ""


def normal(text: str) -> str:
    """Return the words of a head in small letters with underscores between them."""
    return re.sub(r"[\W_]+", "_", unicodedata.normalize("NFC", text).lower()).strip("_")


def read_heads(
    heads: Iterable[str], known: Collection[str], names: Mapping[str, str]
) -> dict[str, Head]:
    """Return what heads stand for that are another name of a column; heads of columns themselves
    are left out.

    Parameters
    ----------
    heads : iterable of str
        The heads, maybe with a unit in brackets.
    known : collection of str
        Names of the columns.
    names : mapping of str to str
        Other names by column, with blanks between them.

    Raises
    ------
    InputError
        If two heads stand for one column.
    """
    columns = {
        other: column for column, others in names.items() for other in (column, *others.split())
    }
    renamed: dict[str, Head] = {}
    heads_of_columns: dict[str, str] = {}
    for head in map(str, heads):
        name, unit = split_head(head)
        if name in known:
            meaning = Head(name, unit)
        else:
            meaning = _read_head(name, unit, columns)
            if not meaning.column:
                continue
            renamed[head] = meaning
        if meaning.column in heads_of_columns:
            remedy = f"Remove one of the columns {heads_of_columns[meaning.column]} and {head}."
            wrong = f"stands for {meaning.column}, as {heads_of_columns[meaning.column]} does"
            raise InputError("column", head, f"one column for {meaning.column}", remedy, wrong)
        heads_of_columns[meaning.column] = head
    return renamed


def _read_head(name: str, unit: str, columns: Mapping[str, str]) -> Head:
    """Return what a name stands for; the column is '' for an unknown name."""
    words = normal(name)
    if words in columns:
        return Head(columns[words], unit)
    for ending, stated in UNITS_OF_HEADS.items():
        column = columns.get(words.removesuffix(f"_{ending}"), "")
        if column == "amplitude" and words.endswith(f"_{ending}") and not unit:
            return Head(column, stated)
    return Head("")


def says_how(text: str) -> bool:
    """Return whether a cell says in words how a test ended."""
    return _joined(text) in (*FAILED, *WHOLE)


def has_failed(text: str, column: str, marks: bool) -> bool | None:
    """Return whether a specimen failed by a cell; None for a cell that does not say it.

    Parameters
    ----------
    text : str
        The cell.
    column : str
        `failed`, or `censored`, whose yes and no have the opposite meaning. Words such as run-out
        mean the same under both.
    marks : bool
        Whether the column only marks cells, so that an empty one says no.
    """
    word = _joined(text)
    code = text.strip().lower()
    if word in FAILED or word in WHOLE:
        return word in FAILED
    if code in YES or code in NO or (not code and marks):
        return (code in YES) == (column == "failed")
    return None


def only_marks(cells: Iterable[str]) -> bool:
    """Return whether the filled cells of a column are all the mark x."""
    return {cell.strip().lower() for cell in cells} == {MARK, ""}


def _joined(text: str) -> str:
    """Return a cell in small letters without blanks, hyphens and underscores: 'runout' of
    'Run-out'.
    """
    return re.sub(r"[\s_-]+", "", text.lower())


def told_heads(heads: Mapping[str, str], units: Mapping[str, str]) -> str:
    """Return a sentence on heads, by column, that were read as another name of it; '' without such
    a head.
    """
    meaning = {"censored": "the opposite of failed"}
    parts = [
        f"'{head}' as {meaning.get(column, column)}{units.get(column, '')}"
        for column, head in heads.items()
    ]
    if parts:
        return f"Columns were read by other names: {listing(parts)}."
    return ""
