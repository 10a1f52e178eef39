"""What limits a result: validity flags in words, known errors of the contact models, and the resolution of stresses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from trackroller.parameters import BODIES, CONTACT_MODELS, REGIMES
from trackroller.parameters.validity import VALIDITY
from trackroller.report.numbers import capital, level_text, number, percent
from trackroller.report.words.sentence import Sentence, say
from trackroller.results.lives import FIRST_LIMIT
from trackroller.roller.dataset import validity_bit
from trackroller.roller.record import friction_records

if TYPE_CHECKING:
    from trackroller.results.results import Results

SLIDING_ERROR = "38 % of mu F_N in friction forces against kalker (median of 492 rollers)"
SLIDING_WEAR = "41 % in friction energy and wear (median of 92 designs)"
KNOWN_ERROR = 0.05  # a larger median error of the model is stated
FRICTION_OUTPUTS = ("friction_power", "friction_energy_per_distance", "friction_energy_balance")


def friction_guess(results: Results) -> Sentence | None:
    """Name the friction coefficients from the database that are placeholders."""
    records = [record for record in friction_records(results.data.attrs) if record["placeholder"]]
    guesses = [(number(r["value"]), level_text("material_pair", r["material_pair"])) for r in records]
    return say("accuracy", "friction_guess", guesses=guesses) if guesses else None


def friction_error(results: Results) -> Sentence | None:
    """Say how far friction energy is from the work put in, where the median difference exceeds 5 %."""
    residual = results.column("energy_residual")[results.of_one_model(results.rolling)]
    residual = residual[np.isfinite(residual)]
    if not residual.size or np.median(residual) <= KNOWN_ERROR:
        return None
    values = {"median": float(np.median(residual)), "largest": float(residual.max()), "of": residual.size}
    return say("accuracy", "friction_error", **values, worn=_worn(results))


def _slid(results: Results) -> np.ndarray:
    """Mark the rolling cases that were solved by full sliding, shape (n,)."""
    return np.asarray(results.rolling & (results.column("contact_model_used") == CONTACT_MODELS.index("sliding")))


def _worn(results: Results) -> bool:
    """Return whether a result rests on the wear that full sliding computes."""
    found = results.verdict
    checked = found is not None and found.goal == FIRST_LIMIT and "wear" not in found.not_checked
    return bool((_slid(results) & (checked | np.isfinite(results.column("run_in_distance")))).any())


def full_sliding(results: Results) -> Sentence | None:
    """State the known errors of full sliding, in forces and in wear, if cases were solved by it.

    Return None where `friction_error` states the error that was measured in this study.
    """
    if friction_error(results) is not None:
        return None
    # a study of several models, or one with the friction work, measures the errors of the forces itself
    measured = "contact_model" in results.factors or np.isfinite(results.column("energy_residual")).any()
    known = [SLIDING_ERROR] * bool(_slid(results).any() and not measured) + [SLIDING_WEAR] * _worn(results)
    return say("accuracy", "full_sliding", known=known) if known else None


def accuracy(results: Results) -> list[Sentence]:
    """Say how well the peaks are resolved, and where the stress of the contact model is singular."""
    said = []
    errors = {body: results.column(f"error_estimate_{body}")[results.valid] for body in BODIES}
    for body, error in [(body, own[np.isfinite(own)]) for body, own in errors.items() if np.isfinite(own).any()][:1]:
        said.append(say("accuracy", "resolved", body=body, largest=float(error.max())))
    if cases := int((results.flagged("split_pole") & results.rolling).sum()):
        said.append(say("accuracy", "singular", count=cases))
    return said


_ROLLING = REGIMES.index("rolling")
OUTSIDE = {  # flags of cases that the model does not judge, as the head of a verdict
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
    flags = int(ds["validity"]) if "validity" in ds else 0
    reasons = [words for name, words in OUTSIDE.items() if flags & validity_bit(name)]
    return reasons + ["not converged"] * ("converged" in ds and int(ds["converged"]) != 1)


def bodies_of(flag: str, by_body: bool) -> tuple[str, ...]:
    """Return the bodies that a flag is counted for: both, or '' for a flag of the pair or flags that no body has."""
    return BODIES if by_body and VALIDITY[flag].of_body else ("",)


def of_body(flag: str, body: str) -> str:
    """Name the body that a flag holds for, as the words of the flag go on; an empty text without a body."""
    return f"{'at' if flag == 'half_space' else 'of'} the {body}" if body else ""


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
    bits, flags = int(ds["validity"]), []
    by_body = dict(zip(ds["body"].values, ds["validity_body"].values, strict=True)) if "validity_body" in ds else {}
    for name, flag in VALIDITY.items():
        if bits & validity_bit(name):
            own = [body for body, mask in by_body.items() if flag.of_body and mask & validity_bit(name)]
            words = f"{flag.words} {of_body(name, ' and the '.join(own))}".rstrip()
            flags.append(Flag(name, f"{capital(words)}.", flag.remedy))
    residual = float(ds["energy_residual"]) if "energy_residual" in ds else 0.0
    exact = "Solve it with contact_model: kalker."
    if residual > KNOWN_ERROR:
        text = f"Friction energy and power differ from the work put in by {percent(residual)}."
        flags.append(Flag("energy_residual", text, exact))
    if {"run_in_distance", "groove_depth"} & set(ds) and ds.attrs.get("contact_model") == "sliding":
        flags.append(Flag("wear_of_sliding", f"Known error of full sliding: {SLIDING_WEAR}.", exact))
    if "energy_residual" not in ds and ds.attrs.get("contact_model") == "sliding" and int(ds["regime"]) == _ROLLING:
        flags.append(Flag("full_sliding", f"Known error of full sliding: {SLIDING_ERROR}.", exact))
    return flags
