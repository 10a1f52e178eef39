"""Errors for bad input; each message says what is wrong, what is allowed and what to do."""

from __future__ import annotations

import difflib
import re
import unicodedata
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from typing import Any


class InputError(ValueError):
    """Bad input: says what is wrong with which value of which field, what is allowed, and what to
    do.

    Parameters
    ----------
    field : str
        Name of the field as the user wrote it, dotted for nested fields.
    value : object
        Value that was refused.
    allowed : str
        Values that are allowed, in words.
    remedy : str
        What the user can do about it.
    wrong : str
        What is wrong with the value, as the end of a sentence that begins with field and value; by
        default that it is not usable, or missing if the value is None.

    Examples
    --------
    >>> print(InputError("slip", -1, "a number >= 0", "Leave slip out."))
    slip = -1 is not usable. Allowed: a number >= 0. Leave slip out.
    >>> wrong = "does not exist"
    >>> print(InputError("case file", "x.yaml", "the path of a file", "Check the path.", wrong))
    case file = 'x.yaml' does not exist. Allowed: the path of a file. Check the path.
    """

    def __init__(
        self, field: str, value: object, allowed: str, remedy: str = "", wrong: str = ""
    ) -> None:
        self.field = field
        self.value = value
        self.allowed = allowed
        self.remedy = remedy
        self.wrong = wrong
        self.file: str | None = None  # a file that another file or the command names
        self.line: int | None = None  # of the file, the first line being 1
        # of the entry in the file, as far as `field` does not say it
        self.path: tuple[str, ...] = ()
        if value is None:
            parts = [
                f"{field} {wrong or 'is missing or empty'}",
                allowed and f"Needed: {allowed}",
                remedy,
            ]
        else:
            plain = value.tolist() if hasattr(value, "tolist") else value  # without NumPy's names
            shown = f"{field} = {shortened(repr(plain))}"
            parts = [
                f"{shown} {wrong or 'is not usable'}",
                allowed and f"Allowed: {allowed}",
                remedy,
            ]
        super().__init__(escaped(". ".join(part for part in parts if part)))

    @property
    def errors(self) -> tuple[InputError, ...]:
        """Return the single errors, of which `InputErrors` has several."""
        return (self,)

    @property
    def shown(self) -> list[str]:
        """Return the messages to print, one a line."""
        return [str(self)]

    def named(self, field: str) -> InputError:
        """Return this error with another name of the field."""
        other = type(self)(field, self.value, self.allowed, self.remedy, self.wrong)
        other.file, other.line, other.path = self.file, self.line, self.path
        return other

    def at(self, file: object, line: int) -> InputError:
        """Return this error after noting the file and the line in which the value stands."""
        self.file, self.line = str(file), line
        return self

    def __str__(self) -> str:
        places = []
        if self.file:
            places.append(self.file)
        if self.line:
            places.append(f"line {self.line}")
        if not places:
            return super().__str__()
        return f"{escaped(', '.join(places))}: {super().__str__()}"

    def __reduce__(self):  # another process rebuilds the error from its parts
        parts = (self.field, self.value, self.allowed, self.remedy, self.wrong)
        return type(self), parts, {"file": self.file, "line": self.line, "path": self.path}


MOST_CHARACTERS = 200  # of a value that a message shows


def shortened(text: str) -> str:
    """Return a text as a message shows it: of a long one the beginning and the end."""
    if len(text) <= MOST_CHARACTERS:
        return text
    return f"{text[:100]}...{text[-60:]}"


_CONTROL = r"\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\ud800-\udfff"  # also halves of surrogate pairs
_MARKS = r"\u061c\u200e\u200f\u2028\u2029\u202a-\u202e\u2066-\u2069"  # directions, and line ends
# characters without a picture: two names that differ by one look the same
_INVISIBLE = (
    r"\xad\u034f\u115f\u1160\u17b4\u17b5\u180b-\u180f\u200b\u2060-\u2065\u206a-\u206f\u2800"
    r"\u3164\ufeff\uffa0\ufff0-\ufffb\U000e0000-\U000e0fff"
)
_JOINERS = r"\u200c\u200d\ufe00-\ufe0f"  # shape letters of some scripts and emoji, no others
_UNSEEN = rf"{_CONTROL}{_MARKS}{_INVISIBLE}]|(?<![^\x00-\x7f])[{_JOINERS}]"
_INVISIBLE_ONE = re.compile(f"[{_INVISIBLE}{_JOINERS}]")
_REFUSED_IN = {True: re.compile(f"[{_UNSEEN}"), False: re.compile(f"[\t\n\r{_UNSEEN}")}


def checked_text(text: str, field: str, lines: bool = False) -> str:
    r"""Return a text of a user as it is: the one check of names, descriptions and cells where they
    are read.

    Parameters
    ----------
    text : str
        The text.
    field : str
        What it stands for, for the message.
    lines : bool
        Whether it may have line ends and tabs, as a description has.

    Raises
    ------
    InputError
        If the text holds a control character, which a terminal obeys, a mark of direction, with
        which a text shows another one than it is, or an invisible character; and if an accent
        stands without its letter, or a name consists of blanks. The message shows such a character
        escaped.

    Examples
    --------
    >>> checked_text("Förderer 7", "name"), checked_text("two\nlines", "description", lines=True)
    ('Förderer 7', 'two\nlines')
    """
    allowed = "a text of letters, digits, signs and spaces"
    refused = _REFUSED_IN[lines].search(text)
    if refused is not None:
        wrong = "holds a control character or a mark of direction"
        if _INVISIBLE_ONE.search(refused[0]):
            wrong = "holds an invisible character"
        raise InputError(field, text, allowed, f"Remove the character {_code(refused[0])}.", wrong)
    accent = _lone_accent(text)
    if accent:
        wrong = "holds an accent without its letter"
        raise InputError(field, text, allowed, f"Remove the character {_code(accent)}.", wrong)
    if not lines and text and not text.strip():
        raise InputError(field, text, allowed, "Write a name.", "consists of blanks")
    return text


def text_of(value: Any, field: str, default: str = "", lines: bool = False) -> str:
    """Return the text of an entry of a file, checked by `checked_text`, and `default` for an empty
    one.

    Raises
    ------
    InputError
        For a value that is neither a text nor a whole number: a file says 1.50 where 1.5 is read.

    Examples
    --------
    >>> text_of(None, "name", "cart"), text_of(7, "name", "cart")
    ('cart', '7')
    """
    if value is None or (isinstance(value, str) and not value):
        return default
    if isinstance(value, bool) or not isinstance(value, (str, int)):
        raise InputError(field, value, "a text, or a whole number", "Put the text in quotes.")
    return checked_text(str(value), field, lines)


def _code(character: str) -> str:
    """Return a character as an escape, such as \\x1b."""
    return ascii(character)[1:-1]


def _lone_accent(text: str) -> str:
    """Return the first combining mark that no letter stands before, '' if there is none."""
    if text.isascii():
        return ""
    for before, character in zip(f" {text}", text, strict=False):
        if before.isspace() and unicodedata.category(character).startswith("M"):
            return character
    return ""


def escaped(text: str) -> str:
    r"""Return a text in which the characters that `checked_text` refuses stand as escapes, such as
    \x1b.

    Examples
    --------
    >>> escaped("a\x1b[2J")
    'a\\x1b[2J'
    """
    return _REFUSED_IN[True].sub(lambda match: _code(match[0]), text)


MOST_SHOWN = 30  # errors of a file that a message names


class InputErrors(InputError):
    """All errors of one file or mapping; field, value, what is allowed and remedy are those of the
    first.
    """

    def __init__(self, errors: Iterable[InputError]) -> None:
        self._errors = tuple(errors)
        first = self._errors[0]
        super().__init__(first.field, first.value, first.allowed, first.remedy, first.wrong)

    @property
    def errors(self) -> tuple[InputError, ...]:
        """Return the single errors in the order of the file."""
        return self._errors

    def named(self, field: str) -> InputError:
        """Return these errors with another name of the field; one of another field keeps its name
        behind it.
        """
        new = {self.field: field}
        return InputErrors(
            [one.named(new.get(one.field, f"{field}: {one.field}")) for one in self._errors]
        )

    @property
    def shown(self) -> list[str]:
        """Return the messages of the first errors, and how many there are further."""
        messages = [str(error) for error in self._errors[:MOST_SHOWN]]
        further = len(self._errors) - MOST_SHOWN
        if further > 0:
            messages.append(f"{further} further errors are not shown.")
        return messages

    def __str__(self) -> str:
        return "\n".join(self.shown)

    def __reduce__(self):
        return type(self), (self._errors,)


class _Part:
    """Keeps the input errors of one part of a file, see `Collector.part`.

    A generator in its place would take a third of the time of making a case.
    """

    __slots__ = ("errors", "path")

    def __init__(self, errors: list[InputError], path: tuple[str, ...]) -> None:
        self.errors = errors
        self.path = path

    def __enter__(self) -> None:
        pass

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> bool:
        if not isinstance(error, InputError):
            return False
        for one in error.errors:
            one.path = (*self.path, *one.path)
        self.errors += error.errors
        return True


class Collector:
    """Collect the errors of the parts of a file, and raise them together.

    Examples
    --------
    >>> wrong = Collector()
    >>> for value in (-1, -2):
    ...     with wrong.part():
    ...         raise InputError("slip", value, "a number >= 0")
    >>> len(wrong.errors)
    2
    """

    def __init__(self) -> None:
        self.errors: list[InputError] = []

    def part(self, *path: str) -> _Part:
        """Keep the input errors of one part, which stands at `path` in its file, instead of raising
        them.
        """
        return _Part(self.errors, path)

    def check(self) -> None:
        """Raise the errors that were collected, see `raise_all`."""
        raise_all(self.errors)


def raise_all(errors: Iterable[InputError]) -> None:
    """Raise errors together, if there are any; a single one as it is, and equal ones once."""
    # two checks may read one table
    different = list({str(error): error for error in errors}.values())
    if different:
        raise different[0] if len(different) == 1 else InputErrors(different)


def collected(entries: Any, checked: Callable[[Any, Any], Any]) -> Any:
    """Return the checked value of each entry of a mapping; raise the errors of all of them
    together.

    What is no mapping is returned as it is: the type of the field refuses it.
    """
    if not isinstance(entries, Mapping):
        return entries
    out = {}
    wrong = Collector()
    for key, entry in entries.items():
        with wrong.part():
            out[key] = checked(key, entry)
    wrong.check()
    return out


class ShapeError(InputError):
    """A valid profile whose shape cannot make contact in this case.

    `solve` marks such a case as failed and goes on with the other cases.
    """


class WorkError(RuntimeError):
    """Report that the work failed for a reason outside the input, and what to do about it."""


# similarity from which on a name, or one of at most four letters, counts as misspelt
CLOSE, CLOSE_SHORT = 0.8, 0.6
MEANS = {  # names that a word of a designer stands for, the likeliest first
    "outer diameter": "outer_radius axis_distance guide_profile_radius roller_profile_radius",
    "groove": "roller_profile_radius groove_depth",
    "rail track": "guide_profile_radius guide_curve_radius guide_material",
    "speed rpm": "velocity guide_overrollings_per_hour",
    "drive driving torque traction braking": "motor_force",
    "load weight preload mass": "radial_force axial_force permissible_radial_force blocks",
    "rad fr frad": "radial_force",
    "thrust lateral side ax fa fax": "axial_force",
    "alpha": "contact_angle",
    "v": "velocity",
    "clearance gap play": "roller_profile_radius groove_depth axis_distance",
    "width": "roller_profile groove_depth",
    "lubrication lubricant oil grease": "friction_law friction_coefficient",
    "mu mü mue µ μ": "friction_coefficient",
    "reliability survival confidence b10": "failure_probability failure_probabilities",
    "life lifetime": "pair_life_hours roller_life_hours guide_life_hours life_rule",
    "steel": "roller_material guide_material material_pair",
    "pressure hertzian": "max_pressure outputs",
    "modulus stiffness": "youngs_modulus roller_material guide_material",
    "tensile strength": "tensile_strength roller_material guide_material",
    "hardness": "hardness roller_material guide_material",
    "goal target objective optimise": "pareto analysis constraints",
    "case count number run": "samples table",
    "limit": "constraints analysis stop_if",
    "variable parameter": "factors base",
    "tolerance resolution mesh": "accuracy",
    "stress": "peak_stress peak_stress_roller peak_stress_guide stress_bodies",
    "hours days years shift": "duty guide_overrollings_per_hour",
}
_MEANS = {word: names.split() for words, names in MEANS.items() for word in words.split()}


def nearest(name: str, options: Iterable[str]) -> str | None:
    """Return the option that a name misspells or abbreviates by whole words, or None if there is no
    such option.
    """
    options = list(options)
    longer = [option for option in options if _words(name) <= _words(option)]
    other = [option for word in _words(name) for option in _MEANS.get(word, ())]
    if longer and other and not set(longer) & set(other):  # the word means something else
        return None
    if longer:  # of several abbreviated names none is meant for sure
        return longer[0] if len(longer) == 1 else None
    by_lower = {option.lower(): option for option in options}
    cutoff = CLOSE_SHORT
    if len(str(name)) > 4:
        cutoff = CLOSE
    hit = difflib.get_close_matches(str(name).lower(), list(by_lower), n=1, cutoff=cutoff)
    if not hit:
        return None
    return by_lower[hit[0]]


def _words(name: object) -> set[str]:
    return set(str(name).lower().split("_"))


def likeliest(name: str, options: Iterable[str]) -> list[str]:
    """Return at most three options that a name stands for by the meaning of its words, the
    likeliest first.
    """
    options = list(options)
    words = str(name).lower().split("_")
    plain = [word if word in _MEANS else word.removesuffix("s") for word in words]
    meant = [option for word in plain for option in _MEANS.get(word, ()) if option in options]
    akin = [
        o
        for o in options
        if any(difflib.get_close_matches(word, _words(o), cutoff=CLOSE) for word in words)
    ]
    return list(dict.fromkeys([*meant, *akin]))[:3]


MOST_LISTED = 16  # names that a message lists; of more names it proposes three


def unknown_name(
    kind: str, name: str, options: Iterable[str], elsewhere: Iterable[str] = ()
) -> InputError:
    """Return the error for a name that is not among `options`; it proposes the names that are meant
    most likely.

    Names `elsewhere` in the file are proposed, too, if the name means one of them.
    """
    options = list(options)
    close = nearest(name, options)
    akin = likeliest(name, [*options, *elsewhere])
    allowed = ""
    remedy = "The page 'Parameters, options and results' lists the names."
    if len(options) <= MOST_LISTED:
        allowed = ", ".join(map(str, options))
        remedy = "Use one of these names."
    if akin:
        remedy = f"Names with a similar meaning: {', '.join(akin)}."
    if close:
        remedy = f"Did you mean '{close}'?"
    return InputError(kind, name, allowed, remedy, wrong="is not known")


def contained(name: str, options: Iterable[str]) -> list[str]:
    """Return the options that a longer or otherwise written name contains, or stands for by one of
    its words.

    Examples
    --------
    >>> contained("Radial_Force (measured)", ["radial_force", "axial_force"])
    ['radial_force']
    >>> contained("F_a", ["axial_force"])
    ['axial_force']
    """
    words = [word for word in re.split(r"[^\w]|_", name.lower()) if word]
    whole = "_".join(words)
    options = list(options)
    meant = [
        option
        for word in (*words, "".join(words))
        for option in _MEANS.get(word, ())
        if option in options
    ]
    return list(dict.fromkeys([*(o for o in options if f"_{o}_" in f"_{whole}_"), *meant]))[:3]


def listing(words: Sequence[str], last: str = "and") -> str:
    """Join words: 'a', 'a and b', 'a, b and c'; 'none' for an empty list."""
    if len(words) == 1:
        return words[0]
    if words:
        return f"{', '.join(words[:-1])} {last} {words[-1]}"
    return "none"


def check_names(kind: str, names: Iterable[object], options: Iterable[str]) -> None:
    """Raise the errors `unknown_name` for those of `names` that are not among `options`.

    Parameters
    ----------
    kind : str
        What the names stand for, such as "case field".
    names : iterable
        Names as the user wrote them.
    options : iterable of str
        Known names.

    Raises
    ------
    InputError
        If a name is unknown.
    """
    known = tuple(options)
    # an array compares by its elements, and no known name is an array or a list
    unknown = [name for name in names if not isinstance(name, Hashable) or name not in known]
    raise_all(unknown_name(kind, str(name), known) for name in unknown)
