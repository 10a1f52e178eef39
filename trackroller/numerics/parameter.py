"""Declare what a number that a user gives is: its unit, meaning and bounds."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from trackroller.errors import nearest
from trackroller.numerics.table_cells import plain_quantity

SMALLEST = 1e-6  # least size of a number that must not be 0


@dataclass(frozen=True)
class Parameter:
    """A number that describes a case or a material.

    Parameters
    ----------
    name, symbol, unit : str
        Name in Python and in files, symbol of the publication, unit ("-" for none).
    default : float
        Value of a case that does not give it; NaN if there is none.
    meaning : str
        Explanation for the documentation.
    lower, upper : float
        Bounds, which are allowed values themselves unless `open_lower` or `open_upper` is True.
    allow_infinite, allow_missing, nonzero : bool
        Whether +-inf is allowed, whether the value may be left out (None or NaN), and whether 0 is refused, with all
        numbers that are smaller than `SMALLEST`.
    label : str
        Name for figures and reports, if it differs from `name`.
    words : tuple of str
        Words that stand for a number of a database.
    role : str
        Who sets the value: the designer (`choice`) or the use of the roller (`condition`).
    afterwards : bool
        Whether the value only converts forces and stresses, to hours for example, and changes none of them.
    """

    name: str
    symbol: str
    unit: str
    default: float
    meaning: str
    lower: float = -math.inf
    upper: float = math.inf
    open_lower: bool = False
    open_upper: bool = False
    allow_infinite: bool = False
    allow_missing: bool = False
    nonzero: bool = False
    label: str = ""
    words: tuple[str, ...] = ()
    role: str = "choice"
    afterwards: bool = False

    @property
    def long_name(self) -> str:
        """Return the name for figures and reports."""
        return self.label or self.name.replace("_", " ")

    @property
    def units(self) -> str:
        """Return the unit as the CF conventions write it."""
        written = {"deg": "degree", "-": "1", "m/min": "m min-1", "1/h": "h-1", "m/s": "m s-1", "m/s2": "m s-2"}
        written |= {"1/mm": "mm-1", "mm3/N": "mm3 N-1"}
        return written.get(self.unit, self.unit)

    def allowed(self) -> str:
        """Return what is allowed, in words."""
        unit = f" {self.unit}"
        above, below = ">=", "<="
        last = "finite"
        if self.unit == "-":
            unit = ""
        if self.open_lower:
            above = ">"
        if self.open_upper:
            below = "<"
        if self.allow_infinite:
            last = "finite or inf"
        parts = []
        if math.isfinite(self.lower):
            parts.append(f"{above} {self.lower:g}{unit}")
        if math.isfinite(self.upper):
            parts.append(f"{below} {self.upper:g}{unit}")
        if self.nonzero:
            parts.append(f"not 0 (at least {SMALLEST:g}{unit} in size)")
        parts.append(last)
        number = f"a number for the {self.long_name} [{self.unit}], " + ", ".join(parts)
        if self.words:
            return f"{number}; or {', '.join(self.words[:-1])} or {self.words[-1]}"
        return number

    def remedy(self, value: float, written: object = None) -> str:
        """Return what to write instead of a value that is not allowed.

        Parameters
        ----------
        value : float
            The number that was read, NaN if it is none.
        written : object
            What the user wrote.
        """
        if math.isfinite(value) and self.accepts(-value):
            return f"Write {-value:g}." + (f" The sign means: {self.meaning}." if "0 " in self.meaning else "")
        if isinstance(written, str):
            if self.allow_infinite and nearest(written, ("straight",)):
                return "Write inf for a straight one."
            close = nearest(written, self.words)
            if close:
                return f"Did you mean '{close}'?"
            plain = plain_quantity(written)
            if plain:
                return f"Write {plain}."
        if math.isnan(self.default):
            example = ""
        else:
            example = f", such as {self.default:g}"
        left_out = ", or leave it out"
        if not self.allow_missing:
            left_out = ""
        return f"Write a number that is allowed{example}{left_out}."

    def accepts(self, value: np.ndarray | float) -> Any:
        """Return which values are allowed, elementwise, a bool array of the shape of `value`; a bool for a number."""
        if isinstance(value, (float, int)):  # arrays of one number would take most of the time of a case's checks
            return self._allows(value, math.isnan(value), not math.isinf(value))
        v = np.asarray(value, dtype=float)
        return self._allows(v, np.isnan(v), ~np.isinf(v))

    def _allows(self, v: Any, missing: Any, bounded: Any) -> Any:
        """Return whether a number, or which of an array of numbers, is allowed; see `accepts`."""
        if self.open_lower:
            good = v > self.lower
        else:
            good = v >= self.lower
        good = good & ((v < self.upper) if self.open_upper else (v <= self.upper))
        if self.nonzero:
            good = good & (abs(v) >= SMALLEST)
        if not self.allow_infinite:
            good = good & bounded
        return good | missing if self.allow_missing else good
