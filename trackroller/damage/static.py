"""Static failure: the peak von Mises stress reaches the tensile strength."""

from __future__ import annotations

from trackroller.damage.limit import Limit, LimitUse, SolvedRollers, Values, worst


def limit_use(solved: SolvedRollers, results: Values) -> LimitUse:
    """Return the peak von Mises stress over R_m, (n, body) [1]; the limit has no time, and a body
    above it breaks.
    """
    used = worst(solved.values["peak_stress"]) / solved.materials["tensile_strength"]
    return LimitUse(used, None, used > 1.0)


LIMIT = Limit(
    name="static",
    title="static failure (peak stress over R_m)",
    short="static strength",
    group="peak_stress",
    evaluate=lambda solved: {},
    use=limit_use,
    needs=("peak_stress",),
    compares=("peak_stress", "tensile strength R_m"),
)
