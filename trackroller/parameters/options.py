"""Declare the options of the solver, which `trackroller.solve` takes beside the cases."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from trackroller.damage import LIMITS, first_limit
from trackroller.damage.own import hint
from trackroller.errors import InputError, unknown_name
from trackroller.parameters.accuracy import QUANTITIES
from trackroller.parameters.contact_models import DECLARED, MEANINGS


@dataclass(frozen=True)
class Option:
    """A choice that `trackroller.solve` offers beside the cases.

    Parameters
    ----------
    name : str
        Keyword of `solve`, key of a study file and of `--set`.
    default : object
        Value if it is not given.
    meaning : str
        Explanation for the documentation, the JSON schema and the help.
    values : dict of str
        Allowed words with their meanings; empty for numbers, conditions and switches.
    kind : str
        "word" (one of `values`), "words" (several of them), "number" (within `bounds`), "accuracy"
        (a word, such a number, or numbers by quantity), "condition" (see `trackroller.roller.stop`)
        or "switch" (true or false).
    bounds : tuple of float
        Numbers between which a number must lie; the bounds themselves are not allowed.
    by_model : bool
        Whether only those contact models take the option that declare it, see
        `contact_models.ModelDeclaration`.
    required : bool
        Whether at least one word has to be given (kind "words").
    factor : bool
        Whether a study file may give a list of values, which makes the option a factor of the
        study.
    identity : bool
        Whether the option is part of a case's identity, where it applies. False if it cannot change
        a number.
    recorded : bool
        Whether a result names the option among its attributes.
    files : tuple of str
        Files that may give the option beside a case: "study", "spectrum".
    """

    name: str
    default: Any
    meaning: str
    values: Mapping[str, str] = field(default_factory=dict)
    kind: str = "word"
    bounds: tuple[float, float] = (0, 1)
    by_model: bool = False
    required: bool = False
    factor: bool = False
    identity: bool = True
    recorded: bool = True
    files: tuple[str, ...] = ("study", "spectrum")

    @property
    def models(self) -> tuple[str, ...]:
        """Return the contact models to which the option applies; empty for all of them."""
        return tuple(
            name for name, model in DECLARED.items() if self.by_model and self.name in model.options
        )

    def applies(self, contact_model: str) -> bool:
        """Return whether the option has a meaning for a contact model."""
        return not self.by_model or contact_model in self.models

    def allowed(self) -> str:
        """Return what is allowed, in words."""
        words = ", ".join(self.values)
        number = f"in ({self.bounds[0]:g}, {self.bounds[1]:g})"
        return {
            "word": f"one of {words}",
            "words": f"a list of {words}"
            + (", at least one" if self.required else ", which may be empty"),
            "accuracy": f"one of {words} or a relative tolerance {number}, also by quantity: "
            f"{', '.join(QUANTITIES)}",
            "number": f"a number {number}",
            "condition": "a condition such as peak_stress > R_m",
            "switch": "true or false",
        }[self.kind]

    def check(self, value: Any, where: str = "") -> Any:
        """Return a value in its canonical form.

        Parameters
        ----------
        value : object
            Value that a user gave. A single word stands for a list of one word.
        where : str
            Name of the field for messages; the name of the option if it is not given.

        Raises
        ------
        InputError
            If the value is not allowed. Conditions are checked where they are parsed.
        """
        where = where or self.name
        if self.kind == "words":
            return self._words(value, where)
        if (
            self.kind in ("accuracy", "number")
            and isinstance(value, str)
            and value not in self.values
        ):
            from trackroller.numerics.numbers import number_or_nan  # noqa: PLC0415 - numpy, which --help does not need

            number = number_or_nan(value, "-", where)  # a text such as 10 %
            if not math.isnan(number):
                value = number
        if self.kind == "word" or (self.kind == "accuracy" and isinstance(value, str)):
            return self._word(value, where)
        if self.kind == "condition" and not isinstance(value, (str, type(None))):
            raise InputError(where, value, self.allowed())
        if self.kind == "switch" and not isinstance(value, bool):
            raise InputError(where, value, self.allowed())
        if self.kind == "accuracy" and isinstance(value, Mapping):
            return self._by_quantity(value, where)
        if self.kind in ("accuracy", "number"):
            return self._number(value, where)
        return value

    def _words(self, value: Any, where: str) -> tuple[str, ...]:
        """Return a list of words; those of an option that may be empty are put in the order of its
        declaration.
        """
        if not isinstance(value, (str, list, tuple, set, frozenset)) or (
            self.required and not value
        ):
            raise InputError(where, value, self.allowed())
        listed = value
        if isinstance(value, str):
            listed = [value]
        words = [self._word(word, where) for word in listed]
        if self.required:
            return tuple(dict.fromkeys(words))
        return tuple(w for w in self.values if w in words)

    def _number(self, value: Any, where: str) -> float:
        """Return a number inside the bounds."""
        is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
        if is_number and self.bounds[0] < value < self.bounds[1]:
            return float(value)
        remedy = ""
        if is_number and self.bounds == (0.0, 1.0) and 1.0 < value < 100.0:
            remedy = f"Give {value / 100.0:g} for {value:g} %."
        raise InputError(where, value, self.allowed(), remedy)

    def _by_quantity(self, value: Mapping[str, Any], where: str) -> dict[str, float]:
        """Return tolerances by quantity in the order of QUANTITIES."""
        if not value:
            raise InputError(where, value, self.allowed())
        for name, number in value.items():
            if name not in QUANTITIES:
                raise unknown_name(f"{where}.{name}", str(name), QUANTITIES)
            if isinstance(number, (str, Mapping)):
                raise InputError(
                    f"{where}.{name}", number, "a number in ({:g}, {:g})".format(*self.bounds)
                )
        return {
            name: self.check(value[name], f"{where}.{name}") for name in QUANTITIES if name in value
        }

    def _word(self, value: Any, where: str) -> str:
        if not isinstance(value, str) or value not in self.values:
            remedy = ""
            if self.name == "outputs":
                remedy = hint(value)
            if remedy:
                raise InputError(where, value, self.allowed(), remedy)
            allowed = tuple(self.values)
            if self.kind == "accuracy":
                allowed = (*self.values, "a relative tolerance such as 0.01")
            raise unknown_name(where, value, allowed)
        return value

    def attribute(self, value: Any, contact_model: str) -> Any:
        """Return the value as an attribute of a result, or None where there is nothing to
        record.
        """
        if not self.recorded:
            return None
        if self.kind == "words":
            return ", ".join(value) or "none"
        if self.kind == "word":
            return value if self.applies(contact_model) else ""
        if self.kind == "switch":
            return str(value).lower()
        if isinstance(value, Mapping):
            return ", ".join(f"{name} {number:g}" for name, number in value.items())
        if self.kind in ("accuracy", "number"):
            if hasattr(value, "name"):
                return value.name
            return str(value)
        return value if self.applies(contact_model) else None


_OPTIONS = (
    Option(
        "outputs",
        ("forces", "contact", "peak_stress", "life", first_limit.GROUP),
        "groups of results; a group is computed only if it is asked for",
        {
            "forces": "forces, moments and longitudinal creepage",
            "contact": "size of the patches, largest pressure and shear, spin pole, adhesion area",
            "friction_work": "friction power and energy",
            "peak_stress": "largest von Mises stress of each body and its place",
            "tractions": "pressure, shear and creepage over each patch",
            "subsurface": "stresses on two sections through the peak",
            **{limit.group: limit.meaning for limit in LIMITS.values() if limit.meaning},
            first_limit.GROUP: first_limit.MEANING,
        },
        kind="words",
        required=True,
        recorded=False,
        files=("study",),
    ),
    Option(
        "contact_model",
        "kalker",
        "how friction is distributed over the patch",
        MEANINGS,
        factor=True,
    ),
    Option(
        "spin_model",
        "skewed",
        "position of the spin pole, assumptions 0, 1 and 2 of the publication",
        {
            "concentric": "v_x vanishes on the line y = 0",
            "edge": "v_x vanishes on a line through the trailing edge at the pole",
            "skewed": "v_x vanishes on two skewed lines, eqs (24)-(25)",
        },
        by_model=True,
        factor=True,
    ),
    Option(
        "accuracy",
        "standard",
        "discretisation: one of three rungs, or a relative tolerance, met case by case on the "
        "first rung that keeps it",
        {
            "preview": "for a first look",
            "standard": "for studies",
            "reference": "for single cases, and to check standard",
        },
        kind="accuracy",
    ),
    Option(
        "hertz",
        "exact",
        "how the Hertzian ellipse is found",
        {"exact": "by elliptic integrals", "published": "by the table of the published program"},
    ),
    Option(
        "stress_bodies",
        "both",
        "bodies whose stresses are computed",
        {
            "both": "each body with its own Poisson's ratio",
            "published": "one body with the mean Poisson's ratio",
        },
    ),
    Option(
        "life_rule",
        "elementary",
        "S-N curve below the fatigue limit",
        {
            "elementary": "the curve runs on (Miner elementary), with its second exponent if the "
            "material gives one",
            "haibach": "slope 2k - 1 (Haibach), or the second exponent if the material gives one",
            "unlimited": "no failure (Miner original)",
        },
    ),
    Option(
        "life_criterion",
        "von_mises_peak",
        "stress that enters the S-N curve as the fully reversed amplitude",
        {
            "von_mises_peak": "the largest von Mises stress (as published)",
            "von_mises_amplitude": "half the longest chord of the path in the deviatoric space",
            "goodman": "von Mises amplitude of the path, corrected for its mean by Goodman's line "
            "to R_m",
            "findley": "Findley's stress, as a share of its limit",
            "dang_van": "Dang Van's stress, as a share of its limit",
        },
    ),
    Option(
        "credit_pressure",
        True,
        "whether hydrostatic pressure lowers Dang Van's stress",
        kind="switch",
    ),
    Option(
        "wear_law",
        "archard",
        "how friction wears a surface",
        {
            "archard": "depth by pressure times slip (wear_coefficient of the pair)",
            "energy": "loss of mass by frictional work (wear_table of the case, or energy_wear of "
            "both materials; density of the material)",
        },
    ),
    Option(
        "failure_probability",
        0.5,
        "failure probability at which the group limits states each life",
        kind="number",
    ),
    Option(
        "not_checked",
        (),
        "limits that the group limits leaves out",
        {own.name: own.title for own in LIMITS.values() if own.use is not None},
        kind="words",
    ),
    Option(
        "at_most",
        (),
        "limits whose utilisation is told by a bound where the bound is below 1, also at the worse "
        "ends of placeholders; a study takes all of them, but those whose group is among its "
        "outputs or whose utilisation it names",
        {own.name: own.title for own in LIMITS.values() if own.bound is not None},
        kind="words",
        files=(),
    ),
    Option(
        "normal",
        "hertz",
        "how patch and pressure are found",
        {
            "hertz": "Hertzian",
            "halfspace": "non-Hertzian, by boundary elements; needed for drawn profiles",
        },
        factor=True,
    ),
    Option(
        "stop_if",
        None,
        "condition; where it holds, no peak stress is searched for and the case is marked stopped",
        kind="condition",
        files=("study",),
    ),
    Option(
        "shortcuts",
        True,
        "use symmetry and repetition among the cases; mirrored rollers then have mirrored numbers",
        kind="switch",
        identity=False,
        recorded=False,
        files=(),
    ),
    Option(
        "slip_terms",
        (),
        "additional terms of the rigid slip, beyond that of the tangent of a straight guide",
        {
            "profile": "the rolling slip of the guide's profile, eq. (20), instead of its tangent",
            "curve": "the roller turns with the curve of the guide, which adds to its spin",
        },
        kind="words",
        by_model=True,
    ),
)

OPTIONS: dict[str, Option] = {option.name: option for option in _OPTIONS}


def words_of(option: str) -> tuple[str, ...]:
    """Return the words that an option allows."""
    return tuple(OPTIONS[option].values)


def options_text() -> str:
    """Return the options with their values and defaults, for the help of a command."""
    entries = []
    for option in OPTIONS.values():
        kinds = {
            "number": "{:g}..{:g}".format(*option.bounds),
            "condition": "CONDITION",
            "switch": "true|false",
        }
        values = " | ".join(option.values) or kinds[option.kind]
        if isinstance(option.default, tuple):
            default = ",".join(option.default) or "none"
        else:
            default = option.default
        entries.append(f"{option.name}={values} ({default})")
    return ", ".join(entries)
