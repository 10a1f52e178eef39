"""Declare the contact models: what each one can do, what it costs, and where its measured errors stand.

The option `contact_model` of `solve`, of study files and of the command line, the checks of other options, the expected
cost of a study and the promised accuracy follow from these declarations. Those of the built-in models stand here,
because help texts and plans need them without the classes, which load numba. A model from outside the package carries
its declaration in its class, see `trackroller.contact.models.register`.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from trackroller.errors import InputError

LEVELS = ("preview", "standard", "reference")
FILE = Path(__file__).with_name("costs.json")
# Seconds of one core of a complete case in sliding at standard, on a quiet machine of two cores. The measured costs are
# ratios to this case.
YARDSTICK = 1.9e-3


@cache
def _ratios() -> Any:
    """Return the measured costs of forces and of peaks, by friction law, contact model and accuracy.

    Each cost is a ratio to `YARDSTICK`.
    """
    return json.loads(FILE.read_text(encoding="utf-8"))


@dataclass(frozen=True)
class Cost:
    """Seconds of one core a case at the accuracies preview, standard and reference.

    Parameters
    ----------
    forces : tuple of float
        For the balance of the roller.
    peaks : tuple of float
        For the search of the peak stresses, in addition.
    tolerances : tuple of (float, float, float)
        Measured tolerances from large to small, each with its seconds for forces and peaks.
    """

    forces: tuple[float, float, float] = (1e-2, 1e-2, 1e-2)
    peaks: tuple[float, float, float] = (1e-2, 1e-2, 1e-2)
    tolerances: tuple[tuple[float, float, float], ...] = ()

    @classmethod
    def measured(cls, name: str, friction: str = "models") -> Cost:
        """Return the cost of a built-in model from the ratios of `validation.benchmarks.trade`."""
        spent = {word: [YARDSTICK * ratio for ratio in both] for word, both in _ratios()[friction][name].items()}
        forces, peaks = zip(*(spent[level] for level in LEVELS), strict=True)
        tolerances = sorted((float(word), *both) for word, both in spent.items() if word not in LEVELS)
        return cls(forces, peaks, tuple(tolerances[::-1]))

    def at(self, accuracy: str | float) -> tuple[float, float]:
        """Return the seconds for forces and peaks at a preset or tolerance; a power law joins measured tolerances."""
        if accuracy in LEVELS:
            return self.forces[LEVELS.index(accuracy)], self.peaks[LEVELS.index(accuracy)]
        tolerance = float(accuracy)
        if len(self.tolerances) < 2:
            level = 1 if tolerance >= 1e-3 else 2
            return self.forces[level], self.peaks[level]
        tolerance = min(tolerance, self.tolerances[0][0])
        last = len(self.tolerances) - 2
        k = next((i for i in range(last) if tolerance >= self.tolerances[i + 1][0]), last)
        (rough, *dear), (fine, *dearer) = self.tolerances[k : k + 2]
        share = math.log(rough / tolerance) / math.log(rough / fine)
        forces, peaks = (a * (b / a) ** share for a, b in zip(dear, dearer, strict=True))
        return forces, peaks


@dataclass(frozen=True)
class ModelDeclaration:
    """What the rest of the program has to know of a contact model without loading its class.

    Parameters
    ----------
    name : str
        Word of the option `contact_model`.
    meaning : str
        Explanation for documentation, schema and help.
    converged_up_to : float
        Largest residual of a converged row: of the balance of the roller and, where elements solve for the balance, of
        the friction law over mu p_max. Every accuracy has the same limit.
    rank : int
        Place among the models by exactness; the largest is the reference of comparisons.
    options : tuple of str
        Options that apply to some models only, and to this one.
    normals : tuple of str
        Words of the option `normal` that the model serves.
    slip_terms : tuple of str
        Words of the option `slip_terms` that the model takes.
    friction_laws : bool
        Whether friction may depend on the slip speed.
    remedy : str
        What to do where a word is refused.
    ladder : str
        Ladder of measured settings in `roller/accuracy.json` from which a tolerance is met: "forces" for quadrature,
        otherwise elements. Empty if the errors of the model were not measured; a tolerance is refused then.
    by_case : bool
        Whether the stages estimate the error of each case, so that a tolerance is met case by case.
    own_errors : bool
        Whether the errors of the forces are those that the method `errors` of the class returns.
    interpolates : bool
        Whether the model interpolates between its elements, so that `Accuracy.elements` serve; otherwise
        `Accuracy.grid_elements`.
    rough_peaks : bool
        Whether the errors of the forces outweigh those of the search for the peak stress, so that a preset takes the
        search and its elements from the next coarser preset.
    cheaper : str
        Model that stands in for this one at accuracy preview, and for forces within a tolerance that it keeps.
    cost : Cost
        Measured cost; orders of magnitude.
    falling : Cost, optional
        Measured cost where friction depends on the slip speed; by default `cost`.
    source : str
        Digest of the source of a model from outside, which `register` adds for the identity of its cases.
    """

    name: str
    meaning: str
    converged_up_to: float = 1e-7
    rank: int = 0
    options: tuple[str, ...] = ()
    normals: tuple[str, ...] = ("hertz",)
    slip_terms: tuple[str, ...] = ()
    friction_laws: bool = False
    remedy: str = "Take contact_model: kalker."
    ladder: str = ""
    by_case: bool = False
    own_errors: bool = False
    interpolates: bool = False
    rough_peaks: bool = False
    cheaper: str = ""
    cost: Cost = Cost()
    falling: Cost | None = None
    source: str = ""

    def check(self, option: str, value: str) -> None:
        """Refuse a word of `normal` or `slip_terms` that the model does not serve."""
        allowed = self.normals if option == "normal" else self.slip_terms
        if value not in allowed:
            words = ", ".join(allowed) or "no word"
            raise InputError(option, value, f"{words} only, with contact_model: {self.name}", self.remedy)


# The costs of the built-in models are measured on random designs, see `validation.benchmarks.trade`.
_BUILT_IN = (
    ModelDeclaration(
        "sliding",
        "Coulomb friction at every point against the local creepage, as published; no adhesion area",
        converged_up_to=1e-10,
        rank=1,
        options=("spin_model",),
        normals=("hertz", "halfspace"),
        slip_terms=("profile",),
        friction_laws=True,
        remedy="Take contact_model: kalker, or leave 'curve' out: in full sliding it changes no force, it only "
        "lengthens slip and friction work.",
        ladder="forces",
        cost=Cost.measured("sliding"),
        falling=Cost.measured("sliding", "falling"),
    ),
    ModelDeclaration(
        "kalker",
        "exact theory of rolling contact; by its table at accuracy preview or if it keeps the tolerance",
        converged_up_to=1e-4,
        rank=3,
        options=("slip_terms",),
        normals=("hertz", "halfspace"),
        slip_terms=("profile", "curve"),
        friction_laws=True,
        ladder="kalker",
        by_case=True,
        interpolates=True,
        cheaper="kalker_table",
        cost=Cost.measured("kalker"),
        falling=Cost.measured("kalker", "falling"),
    ),
    ModelDeclaration(
        "kalker_table",
        "table of solutions of the exact theory; the exact theory outside its range and beside a nearly lifted contact",
        converged_up_to=1e-4,
        rank=2,
        options=("slip_terms",),
        slip_terms=("curve",),
        ladder="kalker",
        own_errors=True,
        interpolates=True,
        rough_peaks=True,
        cost=Cost.measured("kalker_table"),
    ),
)
# Models of earlier versions, with what to take instead.
GONE = {"fastsim": "Take contact_model: kalker_table, which is cheaper and more accurate."}
# Cost of solved patches (`normal: halfspace`) by kalker; other models take less.
SOLVED_PATCHES = Cost((0.2, 0.4, 0.7), (0.03, 0.2, 2.8))

DECLARED: dict[str, ModelDeclaration] = {}
MEANINGS: dict[str, str] = {}  # values of the option `contact_model`
CONTACT_MODELS: list[str] = []  # in the order of the numbers in `contact_model_used`
EXACTNESS: list[str] = []  # the most exact model first


def declare(model: ModelDeclaration) -> None:
    """Add a contact model to the option `contact_model`; its number in results is the next free one."""
    if model.name in DECLARED:
        raise InputError("contact_model", model.name, "a name that no other contact model has")
    DECLARED[model.name] = model
    _derive()


def _derive() -> None:
    MEANINGS.clear()
    MEANINGS.update({name: model.meaning for name, model in DECLARED.items()})
    CONTACT_MODELS[:] = DECLARED
    EXACTNESS[:] = sorted(DECLARED, key=lambda name: -DECLARED[name].rank)


for _model in _BUILT_IN:
    declare(_model)
