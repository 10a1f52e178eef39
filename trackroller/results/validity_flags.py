"""What limits the result of one case: validity flags in words, and known errors of the contact
models.
"""

from __future__ import annotations

from dataclasses import dataclass

import xarray as xr

from trackroller.parameters import BODIES, REGIMES
from trackroller.parameters.validity import VALIDITY
from trackroller.roller.dataset import validity_bit

SLIDING_ERROR = "38 % of mu F_N in friction forces against kalker (median of 492 rollers)"
SLIDING_WEAR = "41 % in friction energy and wear (median of 92 designs)"
KNOWN_ERROR = 0.05  # a larger median error of the model is stated
_ROLLING = REGIMES.index("rolling")
OUTSIDE = {  # flags of cases that the model does not judge, as a headline says them
    "half_space": "outside the half-space",
    "conformal": "patch at the edge of the groove",
    "steep_friction": "friction that falls too steeply",
}


def not_judged(ds: xr.Dataset) -> list[str]:
    """Return why the model does not judge a solved case, in a few words each; nothing if it does.

    A roller that skids or lifts off, or a case without a solution, is judged: it is not met.
    """
    if int(ds["regime"]) != _ROLLING:
        return []
    flags = 0
    if "validity" in ds:
        flags = int(ds["validity"])
    reasons = [words for name, words in OUTSIDE.items() if flags & validity_bit(name)]
    if "converged" in ds and int(ds["converged"]) != 1:
        reasons.append("not converged")
    return reasons


def bodies_of(flag: str, by_body: bool) -> tuple[str, ...]:
    """Return the bodies that a flag is counted for: both, or '' for a flag of the pair or flags
    that no body has.
    """
    if by_body and VALIDITY[flag].of_body:
        return BODIES
    return ("",)


def of_body(flag: str, body: str) -> str:
    """Name the body that a flag holds for, as the words of the flag go on; an empty text without a
    body.
    """
    if body:
        preposition = "of"
        if flag == "half_space":
            preposition = "at"
        return f"{preposition} the {body}"
    return ""


@dataclass(frozen=True)
class Flag:
    """A flag that is set: its name, its meaning in a sentence, and the advice to the user."""

    name: str
    sentence: str
    remedy: str


def flags_of(ds: xr.Dataset) -> list[Flag]:
    """Return the flags of a solved case in words; those of a roller that wears once each, as the
    last state says them.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of one case, or of a roller that wears.
    """
    if "travel" in ds.dims:
        states = (ds.isel(travel=place) for place in range(ds.sizes["travel"]))
        return list({flag.name: flag for state in states for flag in flags_of(state)}.values())
    bits = int(ds["validity"])
    flags = []
    by_body = {}
    if "validity_body" in ds:
        by_body = dict(zip(ds["body"].values, ds["validity_body"].values, strict=True))
    for name, flag in VALIDITY.items():
        # there is no life to extrapolate
        lifeless = name == "deep_life" and int(ds["regime"]) != _ROLLING
        if bits & validity_bit(name) and not lifeless:
            own = [
                body for body, mask in by_body.items() if flag.of_body and mask & validity_bit(name)
            ]
            words = f"{flag.words} {of_body(name, ' and the '.join(own))}".rstrip()
            flags.append(Flag(name, f"{words[0].upper()}{words[1:]}.", flag.remedy))
    residual = 0.0
    if "energy_residual" in ds:
        residual = float(ds["energy_residual"])
    exact = "Solve it with contact_model: kalker."
    if residual > KNOWN_ERROR:
        text = f"Friction energy and power differ from the work put in by {100 * residual:.0f} %."
        flags.append(Flag("energy_residual", text, exact))
    if {"run_in_distance", "groove_depth"} & set(ds) and ds.attrs.get("contact_model") == "sliding":
        flags.append(
            Flag("wear_of_sliding", f"Known error of full sliding: {SLIDING_WEAR}.", exact)
        )
    if (
        "energy_residual" not in ds
        and ds.attrs.get("contact_model") == "sliding"
        and int(ds["regime"]) == _ROLLING
    ):
        flags.append(Flag("full_sliding", f"Known error of full sliding: {SLIDING_ERROR}.", exact))
    return flags
