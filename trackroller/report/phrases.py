"""Numbers, shares, units and lists as people write them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def percent(value: float, low: float = np.nan, high: float = np.nan) -> str:
    """A share as '61 ± 3 %', or '61 %' without an interval."""
    if np.isfinite(low) and np.isfinite(high):
        return f"{max(0.0, value) * 100:.0f} ± {max(1.0, round((high - low) * 50)):.0f} %"
    return f"{max(0.0, value) * 100:.0f} %"


def number(value: float) -> str:
    """A number in three figures."""
    if not np.isfinite(value):
        return "unlimited" if value > 0 else "unknown"
    short = float(f"{value:.3g}")
    if value != 0 and not 1e-3 <= abs(value) < 1e7:
        mantissa, exponent = f"{value:.2e}".split("e")
        text = f"{float(mantissa):g}·10{str(int(exponent)).translate(_RAISED)}"
    else:
        text = f"{short:,.0f}".replace(",", "\u00a0") if abs(short) >= 1e4 else f"{short:g}"
    return text.replace("-", "−")


_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def within(value: float, half: float) -> str:
    """A number with half its interval, both to the half's two figures: '2.04 ± 0.19'."""
    if not np.isfinite(half) or half <= 0:
        return number(value)
    digits = 1 - int(np.floor(np.log10(half)))
    if digits <= 0 or digits > 4:
        return f"{number(value)} ± {number(float(f'{half:.2g}'))}"
    return f"{value:.{digits}f} ± {half:.{digits}f}".replace("-", "−")


def upper(text: str) -> str:
    """First letter large, the others as they are."""
    return text[:1].upper() + text[1:]


def unit_words(units: str) -> str:
    """A CF unit as people write it; nothing for pure numbers."""
    return {"1": "", "-": "", "–": "", "degree": "°", "J m-1": "J/m", "N mm": "N·mm"}.get(units, units)


def with_unit(value: float, units: str) -> str:
    """A number with its unit; pure numbers stand alone."""
    return f"{number(value)} {unit_words(units)}".strip()


def listing(words: Sequence[str]) -> str:
    """'a', 'a and b', 'a, b and c'."""
    return words[0] if len(words) == 1 else ", ".join(words[:-1]) + " and " + words[-1] if words else "none"
