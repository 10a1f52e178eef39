"""Static failure: the peak von Mises stress reaches the tensile strength."""

from __future__ import annotations

from trackroller.damage.limit import Limit, SolvedRollers, Values, Verdict, worst


def verdict(solved: SolvedRollers, results: Values) -> Verdict:
    """Return the peak von Mises stress over R_m, (n, body) [1]; the limit has no time, and a body
    above it breaks.
    """
    used = worst(solved.values["peak_stress"]) / solved.materials["tensile_strength"]
    return Verdict(used, None, used > 1.0)


LIMIT = Limit(
    name="static",
    title="static failure (peak stress over R_m)",
    short="static strength",
    group="peak_stress",
    evaluate=lambda solved: {},
    verdict=verdict,
    needs=("peak_stress",),
    compares=("peak_stress", "tensile strength R_m"),
)
