"""The validity flags of one roller in words, each with the body it holds for and what to do about it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.roller.dataset import VALIDITY_BITS, validity_bit

if TYPE_CHECKING:
    from collections.abc import Mapping

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


def flags_of(ds: xr.Dataset, materials: Mapping[str, Mapping[str, Any]]) -> list[Flag]:
    """Return the flags of a solved case in words.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of one case.
    materials : mapping
        Values of `roller_material` and `guide_material`, see `trackroller.roller.record.materials_of`.
    """
    bits = int(ds["validity"])
    found = []
    for name in VALIDITY_BITS:
        if bits & validity_bit(name):
            sentence, remedy = WORDS[name]
            bodies = " and ".join(f"the {body}" for body in _bodies(name, ds, materials)) or "a body"
            found.append(Flag(name, sentence.format(body=bodies), remedy))
    return found


def _bodies(name: str, ds: xr.Dataset, materials: Mapping[str, Mapping[str, Any]]) -> list[str]:
    """Return the bodies for which a flag of strength holds."""
    found = []
    for body in ("roller", "guide"):
        values = materials[f"{body}_material"]
        strength = values["tensile_strength"]
        stress = _largest(ds, "peak_stress", body)
        holds = {
            "static": stress > strength,
            "yield": _largest(ds, "max_pressure", None) > 1.6 * strength,
            "deep_life": _smallest(ds, body) < values["fatigue_strength_ratio"] * strength,
        }
        if holds.get(name, False):
            found.append(body)
    return found


def _largest(ds: xr.Dataset, name: str, body: str | None) -> float:
    if name not in ds:
        return np.nan
    values = ds[name].values if body is None else ds[name].sel(body=body).values
    return float(np.nanmax(values)) if np.isfinite(values).any() else np.nan


def _smallest(ds: xr.Dataset, body: str) -> float:
    if "peak_stress" not in ds:
        return np.nan
    values = ds["peak_stress"].sel(body=body).values
    return float(np.nanmin(values)) if np.isfinite(values).any() else np.nan
