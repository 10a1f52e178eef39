"""What limits a result: its validity flags in words, and the known errors of the contact models."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from trackroller.parameters import REGIMES
from trackroller.report.numbers import capital, percent, plain
from trackroller.report.words.accuracy import KNOWN_ERROR, SLIDING_ERROR
from trackroller.roller.dataset import VALIDITY_BITS, validity_bit

if TYPE_CHECKING:
    import xarray as xr
# flag -> its meaning, and the advice to the user
WORDS: dict[str, tuple[str, str]] = {
    "half_space": (
        "the patch is too large for a half-space",
        "A semi-axis exceeds 0.3 of the smallest radius: take pressure and stress as estimates, or choose a less close "
        "fit.",
    ),
    "yield": (
        "the contact pressure exceeds the yield limit",
        "The body yields below the surface: choose a closer fit, a stronger material or less load.",
    ),
    "static": (
        "the peak stress exceeds the tensile strength",
        "The body fails at once and has no fatigue life: choose a closer fit, a stronger material or less load.",
    ),
    "conformal": (
        "the patch reaches the edge of the groove or the middle of the guide",
        "Choose a less close fit, or solve drawn profiles with normal: halfspace.",
    ),
    "jamming": (
        "friction alone can carry the lateral load of a contact, and the wedge may lock",
        "Choose a larger contact angle or less friction.",
    ),
    "large_slip": (
        "the longitudinal creepage exceeds 10 %",
        "Friction heat and wear decide the life: choose less motor force or more radial force.",
    ),
    "deep_life": (
        "the peak stress lies below the fatigue limit",
        "The life rests on the rule beyond the limit: state the rule with the life (life_rule), and do not trust more "
        "than its order of magnitude.",
    ),
    "split_pole": ("the stress of full sliding is singular", "Solve it with contact_model: kalker."),
    "steep_friction": (
        "friction falls faster with the slip speed than the surfaces follow",
        "The roller may not roll steadily: use a friction law that falls less steeply.",
    ),
}
OF_BODY = ("yield", "static", "deep_life", "half_space")  # flags that may hold for one body alone
_ROLLING = REGIMES.index("rolling")


def of_body(flag: str, body: str) -> str:
    """Name the body that a flag holds for, as the words of the flag go on; an empty text without a body."""
    return f"{'at' if flag == 'half_space' else 'of'} the {body}" if body else ""


def words_of(flag: str) -> str:
    """Say what a flag means, in a clause; a flag of another solver stands for itself."""
    return WORDS[flag][0] if flag in WORDS else plain(flag)


@dataclass(frozen=True)
class Flag:
    """A flag that is set: its name, its meaning in a sentence, and the advice to the user."""

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
        if bits & validity_bit(name):
            own = [body for body, mask in by_body.items() if name in OF_BODY and mask & validity_bit(name)]
            words = f"{words_of(name)} {of_body(name, ' and the '.join(own))}".rstrip()
            found.append(Flag(name, f"{capital(words)}.", WORDS[name][1]))
    residual = float(ds["energy_residual"]) if "energy_residual" in ds else 0.0
    exact = "Solve it with contact_model: kalker."
    if residual > KNOWN_ERROR:
        text = f"Friction energy and power differ from the work put in by {percent(residual)}."
        found.append(Flag("energy_residual", text, exact))
    if "energy_residual" not in ds and ds.attrs.get("contact_model") == "sliding" and int(ds["regime"]) == _ROLLING:
        found.append(Flag("full_sliding", f"Full sliding solved this roller. {SLIDING_ERROR}", exact))
    return found
