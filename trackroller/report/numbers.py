"""Numbers, shares, intervals, units, names and levels as an engineer writes them: the only
formatting module.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

from trackroller.errors import listing
from trackroller.parameters import MAPPING_FIELDS
from trackroller.parameters.carriage_fields import long_name_of, parameter_of
from trackroller.roller.duty import duty_of, years
from trackroller.study.design.levels import NAMED, short

UNITS = {"1": "–", "-": "–", "degree": "°", "deg": "°"}
UNITS |= {
    "m min-1": "m/min",
    "m s-1": "m/s",
    "m s-2": "m/s²",
    "m/s2": "m/s²",
    "h-1": "1/h",
    "J m-1": "J/m",
    "N mm": "N·mm",
    "mm km-1": "mm/km",
    "mm3 km-1": "mm³/km",
}
UNITS |= {"mm3/(N m)": "mm³/(N m)", "degC": "°C", "mm2": "mm²", "W/(m2 K)": "W/(m² K)"}
UNITS |= {"mm-1": "1/mm", "mm3 N-1": "mm³/N", "mm3/N": "mm³/N"}
SMALL_NUMBERS = {
    2: "two",
    3: "three",
    4: "four",
    5: "five",
    6: "six",
    7: "seven",
    8: "eight",
    9: "nine",
}
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")

BEYOND = "beyond the S-N data"
NO_FAILURE = "no failure"
LEAST_YEARS = 1.0  # of a life that is said in years
MOST_YEARS = 1000
LEAST_CHANCE = 1e-4  # a probability nearer to 0 or 1 is written as a bound
GUIDE_UNKNOWN = (
    "the roller stands for the pair, because the guide's hours are unknown: give "
    "`guide_overrollings_per_hour`"
)


def number(value: float, figures: int = 0) -> str:
    """Write a number, rounded once: 12,300 for thousands, 1.2·10⁹ for large numbers.

    Parameters
    ----------
    value : any float; NaN becomes a dash and infinity its sign
    figures : significant figures; 0 for four, but three from 10,000 on and below 0.001

    Examples
    --------
    >>> number(12345.0), number(0.25), number(-7.0), number(288549.0, 4)
    ('12,300', '0.25', '−7', '288,500')
    """
    if math.isnan(value):
        return "–"
    if math.isinf(value):
        if value > 0:
            return "∞"
        return "−∞"
    if figures == 0:
        figures = 3
        if 1e-3 <= abs(value) < 1e4 or value == 0:
            figures = 4
    value = float(f"{value:.{figures}g}") + 0.0  # -0 is 0
    size = abs(value)
    if size >= 1e7 or (0 < size < 1e-3):
        mantissa, exponent = f"{value:e}".split("e")
        return f"{float(mantissa):g}·10{str(int(exponent)).translate(_RAISED)}".replace("-", "−")
    if size >= 1e4:
        text = f"{value:,.0f}"
    else:
        text = f"{value:.10g}"
    return text.replace("-", "−")


def rounded(value: float, figures: int = 3) -> str:
    """Return a number as text, rounded to `figures` significant figures."""
    return number(value, figures)


def near(value: float, span: float) -> str:
    """Write a value rounded to a thousandth of the span it lies in.

    In a span of 0.25 the value 0.2498 becomes 0.25, and 1.6e-5 becomes 0.
    """
    if not (span > 0 and math.isfinite(span) and math.isfinite(value)):
        return number(value)
    digits = 2 - math.floor(math.log10(span))
    return rounded(round(value, digits) + 0.0)


NOT_HELD = "not held"
UNITS_OF_LIVES = ("h", "overrollings", "km")


def may_be_lost(question: str, units: str) -> bool:
    """Return whether an infinite number of candidates is that of a condition that is not held: no
    life, which may be unlimited.
    """
    return question in ("decide", "how sure") and units not in UNITS_OF_LIVES


def held_text(value: float) -> str:
    """Write a value of a candidate; an infinite one is that of a condition that is not held."""
    if math.isinf(value):
        return NOT_HELD
    return carried(value)


def life(value: float) -> str:
    """Write a life: three figures, 'unlimited', or 'unknown'."""
    if math.isnan(value):
        return "unknown"
    if value == math.inf:
        return "unlimited"
    return rounded(value)


_duty: ContextVar[Mapping[str, float] | None] = ContextVar("duty", default=None)


@contextmanager
def on_duty(duty: Mapping[str, float] | None) -> Iterator[None]:
    """Write lives in hours with their years on a duty, see `trackroller.roller.duty`, while this
    context lasts.
    """
    token = _duty.set(duty)
    try:
        yield
    finally:
        _duty.reset(token)


def lives_in_years(function: Callable[..., Any]) -> Callable[..., Any]:
    """Let a function of `Results` or of the result of one case write lives with their years, if a
    duty is known.
    """

    @functools.wraps(function)
    def on_its_duty(result: Any, *args: Any, **settings: Any) -> Any:
        if hasattr(result, "data_vars"):
            duty = duty_of(result)
        else:
            duty = result.config.duty
        with on_duty(duty):
            return function(result, *args, **settings)

    return on_its_duty


def hour_unit(hours: float) -> str:
    """Return the unit behind a life: 'h', or with its years if the duty of the roller is known: 'h
    (4.2 years)'.

    A life below a year is said in hours alone, and more than 1,000 years are no number that a
    person says.
    """
    duty = _duty.get()
    if not duty or not math.isfinite(hours):
        return "h"
    lasts = years(hours, duty)
    if lasts < LEAST_YEARS:
        return "h"
    if lasts > MOST_YEARS:
        return f"h (over {count(MOST_YEARS)} years)"
    return f"h ({_year_words(rounded(lasts, 2))})"


def year_text(lasts: float) -> str:
    """Write years as a person says them: two figures, from one year on; a shorter life is said in
    hours alone.

    Examples
    --------
    >>> year_text(1.263), year_text(131.0), year_text(7e-4), year_text(2e5)
    ('1.3', '130', '–', '> 1,000')
    """
    if not lasts >= LEAST_YEARS:
        return "–"
    if lasts > MOST_YEARS:
        return f"> {count(MOST_YEARS)}"
    return rounded(lasts, 2)


def _year_words(*ends: str) -> str:
    """Write years, or a range of them: '1 year', '1 to 4.2 years'."""
    unit = "years"
    if set(ends) == {"1"}:
        unit = "year"
    return f"{' to '.join(dict.fromkeys(ends))} {unit}"


def life_unit(unit: str, value: float) -> str:
    """Return the unit behind a life, with its years if it is in hours; see `hour_unit`."""
    if unit == "h":
        return hour_unit(value)
    return unit


def lasting(value: float, unit: str = "", beyond: bool = False) -> str:
    """Write a life, with the remark that it lies beyond the S-N data; an unlimited life is no
    number of hours.
    """
    if value == math.inf:
        return f"{NO_FAILURE} ({BEYOND})"
    return _with_beyond(f"{rounded(value)} {life_unit(unit, value)}".strip(), beyond)


def _with_beyond(text: str, beyond: bool) -> str:
    """Return a life with the words for one that lies beyond the data of its rule."""
    if beyond:
        return f"{text} ({BEYOND})"
    return text


def between(low: float, high: float, beyond: bool = False) -> str:
    """Write a life in hours that is known within a range: '26 to 860 h'; one number where the ends
    round alike.
    """
    if rounded(low) == rounded(high) or math.isinf(low):
        return lasting(low, "h", beyond)
    if math.isinf(high):
        return f"{lasting(low, 'h')} or more ({BEYOND})"
    return _with_beyond(f"{rounded(low)} to {rounded(high)} {range_unit(low, high)}", beyond)


def years_of(low: float, high: float | None = None) -> str:
    """Return a life in hours, or a range of lives, in years: '4.2 years'; '' without a duty or
    below a year.
    """
    if high is None or high == low:
        unit = hour_unit(low)
    else:
        unit = range_unit(low, high)
    return unit.removeprefix("h").strip(" ()")


def range_unit(low: float, high: float) -> str:
    """Return the unit behind a range of lives: 'h', or with its years where an end lasts at least
    one.
    """
    duty = _duty.get()
    if not duty or not (math.isfinite(low) and math.isfinite(high)):
        return "h"
    first, last = (years(end, duty) for end in (low, high))
    if last < LEAST_YEARS or last > MOST_YEARS:
        return "h"
    if first < LEAST_YEARS:
        return f"h (up to {_year_words(rounded(last, 2))})"
    return f"h ({_year_words(rounded(first, 2), rounded(last, 2))})"


class Life(float):
    """A life for a table: a number that is written with the remark that it lies beyond the S-N
    data.
    """

    beyond: bool

    def __new__(cls, value: float, beyond: bool = False) -> Life:
        """Return the life, marked if it lies beyond the S-N data."""
        life = super().__new__(cls, value)
        life.beyond = bool(beyond)
        return life


def count(cases: int) -> str:
    """Write a number of cases with commas: 5,400."""
    return f"{cases:,}"


def part_of(part: float, whole: float) -> str:
    """Write how many cases of all of them: '3 of 1,200'."""
    return f"{count(int(part))} of {count(int(whole))}"


def share(part: int, whole: int) -> str:
    """Write a share of cases in percent.

    The result is 100 % only if all cases count, and 0 % only if no case counts.

    Parameters
    ----------
    part, whole : numbers of cases, 0 <= part <= whole and whole > 0

    Examples
    --------
    >>> share(1, 3), share(5399, 5400), share(3, 3)
    ('33 %', '99.98 %', '100 %')
    """
    if part in (0, whole):
        if part:
            return "100 %"
        return "0 %"
    exact = 100 * part / whole
    digits = 0
    while not 0.5 * 10**-digits < exact < 100 - 10**-digits:
        digits += 1
    return f"{exact:.{digits}f} %"


def plus_minus(value: float, low: float, high: float) -> str:
    """Write a value with half its 95 % interval, as '2.04 ± 0.19'.

    Both numbers have two figures of the half.

    An interval that is not known (NaN) is left out. Every ± of the report is this half width.
    """
    half = (high - low) / 2
    if not math.isfinite(value):
        return "–"
    if not math.isfinite(half) or half <= 1e-9 * abs(value):  # of rounding alone
        return rounded(value)
    digits = 1 - math.floor(math.log10(half))
    if digits <= 0 or digits > 4:
        return f"{rounded(value)} ± {rounded(half, 2)}"
    return f"{value:.{digits}f} ± {half:.{digits}f}".replace("-", "−")


# share of the half of an interval that its shorter side must have to be written as ±
LOPSIDED = 0.3


def percent(value: float, low: float = math.nan, high: float = math.nan) -> str:
    """Write a share of variance or a probability as '61 ± 3 %', or '61 %' without an interval;
    never below 0.

    An interval that reaches much farther on one side is written with its ends: '100 % (98.2 to 100
    %)'.
    """
    if math.isinf(value):
        return "unlimited"
    exact = 100 * max(0.0, value)
    half = 50 * (high - low)
    if math.isfinite(half):
        if 100 * min(value - low, high - value) < LOPSIDED * half:
            return f"{percent(value)} ({percent(low).removesuffix(' %')} to {percent(high)})"
        if half >= 0.5 or exact >= 1:
            return f"{exact:.0f} ± {max(1.0, half):.0f} %"
        return f"{exact:.1f} ± {half:.1f} %"
    if exact == 0 or 1 <= exact <= 99 or exact > 100:
        return f"{exact:.0f} %"
    if exact < 1:
        return f"{exact:.2g} %"
    return f"{exact:.4g} %"


def percent_up(error: float) -> str:
    """Write an error in percent with two figures, rounded up, so that no error is larger: '1.5 %'
    for 0.01482.
    """
    step = 1.0
    if error > 0:
        step = 10.0 ** (math.floor(math.log10(100 * error)) - 1)
    return f"{rounded(math.ceil(100 * error / step - 1e-9) * step, 2)} %"


def times(ratio: float) -> str:
    """Write a ratio, or the inverse of one below 1, as '26-fold'; below 10 in three figures:
    '2.64-fold'.
    """
    ratio = max(ratio, 1 / ratio)
    figures = 2
    if ratio < 10:
        figures = 3
    return f"{rounded(ratio, figures)}-fold"


def capital(text: str) -> str:
    """Write the first letter large, the others as they are."""
    return text[:1].upper() + text[1:]


def lowered(text: str) -> str:
    """Write the first letter small, unless the word is a symbol or a name such as POM."""
    if text[1:2].islower():
        return text[:1].lower() + text[1:]
    return text


def shortened(words: Sequence[str], most: int = 4) -> str:
    """Join words; of more than `most` words the last stand as 'and three more', 'and 12 more'."""
    if len(words) <= most:
        return listing(words)
    left = len(words) - most + 1
    return f"{', '.join(words[: most - 1])} and {SMALL_NUMBERS.get(left, str(left))} more"


def unit_text(units: str) -> str:
    """Write a CF unit as a reader expects it, '–' for a pure number."""
    return UNITS.get(units, units)


def row_unit(units: str) -> str:
    """Write a CF unit behind a number in a row; a pure number has none."""
    return unit_text(units).replace("–", "")


def year_words() -> str:
    """Return the hours of a year on the duty: '4,000 h are 1 year'; '' without a duty."""
    duty = _duty.get()
    if duty:
        return f"{grouped(1 / years(1.0, duty), 3)} h are 1 year"
    return ""


def head_unit(units: str) -> str:
    """Return the unit at the head of a column or axis; behind hours the hours of a year, if the
    duty is known.
    """
    duty = None
    if units == "h":
        duty = _duty.get()
    if duty:
        return f"h; {rounded(1 / years(1.0, duty))} h = 1 year"
    return unit_text(units)


def with_unit(text: str, units: str) -> str:
    """Write an axis label: the quantity and its unit in brackets."""
    return f"{text} [{head_unit(units)}]"


def quantity(value: float, units: str, figures: int = 3) -> str:
    """Write a number with its unit, for running text; pure numbers stand alone."""
    if units == "h":
        unit = hour_unit(value)
    else:
        unit = unit_text(units)
    if unit == "–":
        unit = ""
    return f"{rounded(value, figures)} {unit}".strip().replace(" °", "°")


def as_given(value: float, units: str) -> str:
    """Write a value that a user requires, with its unit: as it was given, up to six figures."""
    return quantity(value, units, 6)


def plain(name: str) -> str:
    """Write a name without underscores."""
    return name.replace("_", " ")


def long_name(name: str) -> str:
    """Name a factor in running text."""
    if name == "normal":  # the word "normal" alone would not be understood
        return "normal problem"
    return long_name_of(name)


def symbol(text: str) -> str:
    """Write a symbol such as r_C,TR or h/G_3 for a figure, with its index below the line; an empty
    text for none. A formula stays as it is.
    """
    if not text or any(sign in text for sign in " ()^"):
        return text
    if "/" in text:
        return "/".join(symbol(part) for part in text.split("/"))
    letter, _, index = text.partition("_")
    if len(letter) > 1 and letter.islower():  # alpha, mu
        letter = f"\\{letter}"
    if index:
        return f"${letter}_\\mathrm{{{index}}}$"
    return f"${letter}$"


def factor_label(name: str) -> str:
    """Label the axis of a factor: long name, symbol, unit."""
    parameter = parameter_of(name)
    if parameter is None:
        return capital(plain(name))
    return with_unit(
        f"{capital(long_name(name))} {symbol(parameter.symbol)}".rstrip(), parameter.unit
    )


def level_text(name: str, value: Any, unit: bool = True, words: bool = True) -> str:
    """Write a level of a factor: 'straight' for an infinite curve, 'driven −30 N' for a motor
    force.

    Without `words`, as for the ends of a range, a number with its unit; without `unit` the number
    alone.
    """
    if isinstance(value, str):
        if name in MAPPING_FIELDS:
            return short(name, value)
        return _pair(value)
    value = float(value)
    words = words and unit
    if name == "motor_force" and words:
        if value == 0:
            return "free rolling"
        drive = "braked"
        if value < 0:
            drive = "driven"
        return f"{drive} {number(value)} N"
    if name == "guide_curve_radius" and words:
        if math.isinf(value):
            return "straight"
        side = "inner"
        if value > 0:
            side = "outer"
        return f"{side} curve {number(abs(value))} mm"
    parameter = parameter_of(name)
    if not unit or parameter is None or parameter.unit == "-":
        return number(value)
    return f"{number(value)} {unit_text(parameter.unit)}".replace(" °", "°")


def setting(name: str, value: Any) -> str:
    """Write a factor and its level, as 'friction coefficient 0.3' or 'driven −30 N'."""
    text = level_text(name, value)
    spoken = name in NAMED and not (name == "guide_curve_radius" and text == "straight")
    if spoken:
        return text
    if name == "guide_curve_radius":
        return "straight track"
    return f"{long_name(name)} {text}"


def _pair(label: str) -> str:
    parts = label.split(" / ")
    if len(parts) == 2 and parts[0] == parts[1]:
        return f"{parts[0]} on itself"
    return " on ".join(parts)


def _bounded(part: int, whole: int) -> str:
    """Write a probability as a share; nearer to 0 or 1 than `LEAST_CHANCE`, as a bound."""
    if 0 < whole - part < LEAST_CHANCE * whole:
        return f"over {100 * (1 - LEAST_CHANCE):g} %"
    if 0 < part < LEAST_CHANCE * whole:
        return f"below {100 * LEAST_CHANCE:g} %"
    return share(part, whole)


def chance(value: float, low: float = math.nan, high: float = math.nan, words: str = "") -> str:
    """Write a probability: '97 %' or '97 % (95 % to 98 %)', with more figures near 0 (never) and
    100 % (always).
    """
    whole = 10**9
    if math.isnan(value):
        return "–"
    text, *ends = (
        _bounded(round(v * whole), whole) for v in (value, low, high) if math.isfinite(v)
    )
    if ends:
        return f"{text} ({words}{' to '.join(ends)})"
    return text


COARSE = 0.1  # error from which two figures are written
MOST_FIGURES = 6  # that tell a number from the one beside it


def carried(value: float, error: float = math.nan, beside: Sequence[float] = ()) -> str:
    """Write a result with the figures that its error carries: three, or two from an error of 10 %
    on.

    Parameters
    ----------
    value : any float
    error : its told relative error [1]; NaN if none is told
    beside : numbers that it is compared with; more figures are written where it would read like one
        of them

    Examples
    --------
    >>> carried(211634.0, 0.48), carried(211634.0, 0.02), carried(419.96, 0.002, [420.0])
    ('210,000', '212,000', '419.96')
    """
    figures = 3
    if error >= COARSE:
        figures = 2
    others = [
        grouped(other, MOST_FIGURES) for other in beside if math.isfinite(other) and other != value
    ]
    while figures < MOST_FIGURES and grouped(value, figures) in others:
        figures += 1
    return grouped(value, figures)


def grouped(value: float, figures: int = 0) -> str:
    """Write a number as `number` does, but thousands with a comma from 1,000 on, as those beside it
    in a column.

    Examples
    --------
    >>> grouped(8970.0, 3), grouped(212000.0, 3), grouped(-1999.96, 4)
    ('8,970', '212,000', '−2,000')
    """
    text = number(value, figures)
    whole = text.replace("−", "-")
    if len(whole.lstrip("-")) == 4 and whole.lstrip("-").isdigit():
        return f"{int(whole):,}".replace("-", "−")
    return text


def carried_range(
    low: float, high: float, error: float = math.nan, beside: Sequence[float] = ()
) -> str:
    """Write a range as `carried` does; one number where both ends read alike."""
    ends = (carried(low, error, beside), carried(high, error, beside))
    return " to ".join(dict.fromkeys(ends))


def as_required(value: float) -> str:
    """Write a required value: as it was given, up to six figures; one that was computed in three.

    Examples
    --------
    >>> as_required(10500.0), as_required(1500 / 3.6)
    ('10,500', '417')
    """
    given = math.isclose(value, float(f"{value:.6g}"), rel_tol=1e-12)
    figures = 3
    if given:
        figures = 6
    return grouped(value, figures)
