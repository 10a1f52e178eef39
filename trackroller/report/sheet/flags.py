"""The validity flags of one roller in words, each with the body it holds for and what to do about it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from trackroller.report.known_errors import KNOWN_ERROR
from trackroller.report.numbers import percent
from trackroller.roller.dataset import VALIDITY_BITS, validity_bit

if TYPE_CHECKING:
    import xarray as xr

# what a flag says of a roller, and what its user can do
WORDS: dict[str, tuple[str, str]] = {
    "half_space": (
        "The contact patch is larger than 0.3 of the smallest radius: the bodies are no half-spaces.",
        "Take pressure and stress as estimates, or choose a less close fit.",
    ),
    "yield": (
        "The contact pressure exceeds 1.6 times the tensile strength of {body}: it yields below the surface.",
        "Choose a closer fit, a stronger material or less load.",
    ),
    "static": (
        "The peak stress exceeds the tensile strength of {body}: it fails at once and has no fatigue life.",
        "Choose a closer fit, a stronger material or less load.",
    ),
    "conformal": (
        "The patch reaches the edge of the groove or the middle of the guide.",
        "Choose a less close fit, or solve drawn profiles with normal: halfspace.",
    ),
    "jamming": (
        "Friction alone can carry the lateral load of a contact: the wedge may lock.",
        "Choose a larger contact angle or less friction.",
    ),
    "large_slip": (
        "The longitudinal creepage exceeds 10 %: friction heat and wear decide the life.",
        "Choose less motor force or more radial force.",
    ),
    "deep_life": (
        "The peak stress lies below the fatigue limit of {body}: its life rests on the rule beyond the limit.",
        "State the rule with the life (life_rule), and do not trust more than its order of magnitude.",
    ),
    "split_pole": (
        "The stress of full sliding is singular in this patch.",
        "Solve it with contact_model: kalker.",
    ),
    "steep_friction": (
        "Friction falls faster with the slip speed than the surfaces follow: the roller may not roll steadily.",
        "Use a friction law that falls less steeply.",
    ),
}


@dataclass(frozen=True)
class Flag:
    """A flag that is set: its name, what it says, and what to do."""

    name: str
    sentence: str
    remedy: str


def flags_of(ds: xr.Dataset) -> list[Flag]:
    """Return the flags of a solved case in words.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of one case.
    """
    bits, found = int(ds["validity"]), []
    by_body = dict(zip(ds["body"].values, ds["validity_body"].values, strict=True)) if "validity_body" in ds else {}
    for name in VALIDITY_BITS:
        bit = validity_bit(name)
        if bits & bit:
            sentence, remedy = WORDS[name]
            bodies = " and ".join(f"the {body}" for body, own in by_body.items() if own & bit) or "a body"
            found.append(Flag(name, sentence.format(body=bodies), remedy))
    residual = float(ds["energy_residual"]) if "energy_residual" in ds else 0.0
    if residual > KNOWN_ERROR:
        text = f"Friction energy and power differ from the work put in by {percent(residual)}."
        found.append(Flag("energy_residual", text, "Solve it with contact_model: kalker."))
    return found
