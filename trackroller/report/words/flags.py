"""What limits a result: its validity flags in words, and the known errors of the contact models."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trackroller.analysis.table import BODIES, StudyView
from trackroller.parameters import CONTACT_MODELS, REGIMES
from trackroller.report.numbers import capital, count, percent, plain, rounded
from trackroller.report.words.sentence import Sentence
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
SLIDING_ERROR = "Its friction forces differ from those of kalker by 38 % of mu F_N (median of 492 rollers)."
_ROLLING = REGIMES.index("rolling")
KNOWN_ERROR = 0.05  # a median model error above this is told beside every use of the quantity
FRICTION_OUTPUTS = ("friction_power", "friction_energy", "friction_energy_per_distance", "friction_energy_balance")


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


def friction_error(view: StudyView) -> Sentence | None:
    """Say how far friction energy is from the work put in, where the median difference exceeds 5 %."""
    residual = view.column("energy_residual")
    rows = view.rolling & np.isfinite(residual)
    if not rows.any() or np.median(residual[rows]) <= KNOWN_ERROR:
        return None
    middle, most = float(np.median(residual[rows])), float(residual[rows].max())
    text = (
        f"Known model error: friction energy and power differ from the work put in by {rounded(100 * middle)} % in the "
        f"median and {rounded(100 * most)} % at most of {count(int(rows.sum()))} rolling designs. Solve with "
        "`contact_model: kalker` before a decision rests on them."
    )
    return Sentence("friction_error", text, {"median": middle, "largest": most, "of": int(rows.sum())}, rows)


def full_sliding(view: StudyView) -> Sentence | None:
    """State the known error of full sliding if designs were solved by it.

    Return None if the study holds the friction work: another sentence then states the error measured in this study.
    """
    rows = view.rolling & (view.column("contact_model_used") == CONTACT_MODELS.index("sliding"))
    if not rows.any() or np.isfinite(view.column("energy_residual")).any():
        return None
    cases = int(rows.sum())
    text = (
        f"Known model error: full sliding solved {count(cases)} rolling designs. {SLIDING_ERROR} Solve with "
        "`contact_model: kalker` before a decision rests on them."
    )
    return Sentence("full_sliding", text, {"count": cases}, rows)


def accuracy(view: StudyView) -> list[Sentence]:
    """Say how well the peaks are resolved, and where the stress of the contact model is singular."""
    said = []
    for body in BODIES:
        error = view.column(f"error_estimate_{body}")
        rows = view.valid & np.isfinite(error)
        if rows.any():
            middle, most = float(np.median(error[rows])), float(error[rows].max())
            text = f"The peak stress of the {body} is resolved to {percent(middle)} in the median of the valid designs"
            values = {"body": body, "median": middle, "largest": most}
            said.append(Sentence("resolved", f"{text} and to {percent(most)} at worst.", values, rows))
            break
    if "split_pole" in view.flags and (hit := view.flagged("split_pole") & view.rolling).any():
        cases = int(hit.sum())
        text = f"In {count(cases)} rolling designs the stress of full sliding is singular: solve them with"
        values = {"count": cases}
        said.append(Sentence("singular", f"{text} `contact_model: kalker`.", values, view.rolling))
    return said
