"""Sentences on the design points of an inner/outer design."""

from __future__ import annotations

import numpy as np
import xarray as xr

from trackroller.analysis.ranking import estimate
from trackroller.report.numbers import Life, chance, lasting, rounded, setting
from trackroller.report.words.sentence import Sentence


def best_point(table: xr.Dataset, output: str) -> Sentence:
    """Name the best design point by B10 and how often designs slip or lift off there."""
    part = table.sel(output=output)
    words, safe = str(part["output_name"].item()), part["b10_safe"].values
    if not (np.isfinite(safe) | np.isposinf(safe)).any():
        return Sentence("no_b10", f"No B10 can be given for {words}.", {"output": output})
    b10s = np.nan_to_num(part["b10"].values, nan=-1.0)
    key = np.lexsort((-b10s, -np.nan_to_num(safe, nan=-1.0)))
    best = int(key[0])
    slip, lift = (table["probability"].sel(regime=r).values for r in ("full_slip", "lift_off"))
    b10, low, high = map(float, estimate(part, "b10")[:, best])
    unit = "overrollings" if words.endswith("overrollings") else str(part["output_units"].item())
    limited = bool(table.attrs.get("constrained", 0))
    still = float(table["probability"].sel(regime="rolling").values[best]) == 1.0 and not limited
    kind = "rolling cases that meet the constraints" if limited else "cases" if still else "rolling cases"
    text = (
        f"Best B10 of the {words}: at {point_words(table, best)} nine of ten {kind} "
        f"reach {lasting(b10, unit, life_at(part, best, b10).beyond)} (95 % interval {rounded(low)} to {rounded(high)})"
    )
    if not still and safe[best] > 0:
        whole = life_at(part, best, safe[best])
        text += f"; with every other case counted as life 0 it is {lasting(whole, unit, whole.beyond)}"
    elif not still:
        missed = " or miss a constraint" if limited else ""
        text += (
            f"; one in ten or more of all cases do not roll{missed}, and with these counted as life 0 there is no B10"
        )
    text += f"; full slip there in {chance(slip[best])} and lift-off in {chance(lift[best])} of the cases"
    values = {"output": output, "point": best, "b10": b10, "safe": float(safe[best])}
    worst = int(np.argmax(slip + lift))
    if slip[worst] + lift[worst] > slip[best] + lift[best]:
        text += f", at most in {chance(slip[worst] + lift[worst])} ({point_words(table, worst)})"
        values["worst"] = worst
    return Sentence("robust", f"{text}.", values)


def life_at(part: xr.Dataset, point: int, value: float) -> Life:
    """Return a life of a design point, marked if lives beyond the S-N data enter it.

    With the material's own scatter B10 lies below the lives that it rests on: then the life that nine of ten conditions
    reach decides.
    """
    least = float(part["percentile_value"].sel(percentile=10.0)[point]) if value > 0 else 0.0
    value = float(value)
    rests = max(value, least) if value == float(part["b10"][point]) else value
    return Life(value, bool(rests >= float(part["beyond_data"][point])))


def point_words(table: xr.Dataset, point: int) -> str:
    """Name a design point: 'profile ratio 1.1, contact angle 30°'."""
    names = [n for n in str(table.attrs.get("outer_factors", "")).split(", ") if n]
    values = [table[name].values[point] for name in names]
    said = [setting(n, v if isinstance(v, str) else float(v)) for n, v in zip(names, values, strict=True)]
    return ", ".join(said) or "the one design point"
