"""Declare the contact models: what each one can do, what it costs, and where its measured errors
stand.

The option `contact_model` of `solve`, of study files and of the command line, the checks of other
options, the expected cost of a study and the promised accuracy follow from these declarations.
Those of the built-in models stand here, because help texts and plans need them without the classes,
which load numba. A model from outside the package carries its declaration in its class, see
`trackroller.contact.models.register`.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

from trackroller.errors import InputError

LEVELS = ("preview", "standard", "reference")
FILE = Path(__file__).with_name("costs.json")
# Seconds of one core of a complete case in sliding at standard, on a quiet machine of two cores.
# The measured costs are ratios to this case.
YARDSTICK = 0.95e-3


@cache
def measured_costs() -> Any:
    """Return the measured costs of forces and of peaks, by friction law, contact model and rung,
    those of limits, and shares of rungs.

    Each cost is a ratio to `YARDSTICK`.
    """
    return json.loads(FILE.read_text(encoding="utf-8"))


@dataclass(frozen=True)
class Cost:
    """Seconds of one core a case on the rungs preview, standard and reference.

    Parameters
    ----------
    forces : tuple of float
        For the balance of the roller.
    peaks : tuple of float
        For the search of the peak stresses, in addition.
    shares : mapping
        Measured shares of the cases that a tolerance solves on each rung: by quantity, `forces` or
        `peak`, and by tolerance. Without them every case counts on every rung.
    """

    forces: tuple[float, float, float] = (1e-2, 1e-2, 1e-2)
    peaks: tuple[float, float, float] = (1e-2, 1e-2, 1e-2)
    shares: Mapping[str, Mapping[float, tuple[float, float, float]]] = field(default_factory=dict)

    @classmethod
    def measured(cls, name: str, friction: str = "models") -> Cost:
        """Return the cost of a built-in model from the ratios of `validation.tradeoff`."""
        ratios = measured_costs()
        spent = [[YARDSTICK * ratio for ratio in ratios[friction][name][level]] for level in LEVELS]
        shares = {
            quantity: {float(tolerance): tuple(own) for tolerance, own in by_tolerance.items()}
            for quantity, by_tolerance in ratios["shares"][name].items()
        }
        forces, peaks = zip(*spent, strict=True)
        return cls(forces, peaks, shares)

    def at(self, accuracy: str | Mapping[str, float]) -> tuple[float, float]:
        """Return the seconds for forces and peaks on a rung, or within tolerances by quantity."""
        shares = self.shares_of(accuracy)
        forces, peaks = (
            sum(map(math.prod, zip(shares, own, strict=True))) for own in (self.forces, self.peaks)
        )
        return forces, peaks

    def shares_of(self, accuracy: str | Mapping[str, float]) -> tuple[float, float, float]:
        """Return the expected shares of the cases that are solved on each rung.

        A case is solved at `preview` if that may keep all of its tolerances, and on a finer rung if
        one tolerance needs it.
        """
        if isinstance(accuracy, str):
            at = [float(level == accuracy) for level in LEVELS]
            return at[0], at[1], at[2]
        known = [
            self._between(self.shares[name], number)
            for name, number in accuracy.items()
            if self.shares.get(name)
        ]
        if not known:
            return 1.0, 1.0, 1.0
        columns = [[own[k] for own in known] for k in range(len(LEVELS))]
        return min(columns[0]), max(columns[1]), max(columns[2])

    @staticmethod
    def _between(
        shares: Mapping[float, tuple[float, float, float]], tolerance: float
    ) -> list[float]:
        """Return the shares at a tolerance, linear in its logarithm between the measured
        tolerances.
        """
        known = sorted(shares)
        tolerance = min(max(tolerance, known[0]), known[-1])
        high = next(i for i, own in enumerate(known) if tolerance <= own)
        low = max(high - 1, 0)
        part = 1.0
        if high > low:
            part = math.log(tolerance / known[low]) / math.log(known[high] / known[low])
        return [
            a + part * (b - a) for a, b in zip(shares[known[low]], shares[known[high]], strict=True)
        ]


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
        Largest residual of a converged row: of the balance of the roller and, where elements solve
        for the balance, of the friction law over mu p_max. Every accuracy has the same limit.
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
    films : bool
        Whether a film between the bodies, `layer_flexibility`, moves the surfaces of the model.
    remedy : str
        What to do where a word is refused.
    known_errors : bool
        Whether the errors of the forces are known, so that a tolerance can be asked for: estimated
        case by case, stated by the method `errors` of the class, or measured
        (`roller/expected_errors.json`).
    rough_peaks : bool
        Whether the errors of the forces outweigh those of the search for the peak stress, so that a
        rung takes the search and its elements from the next coarser rung.
    cheaper : str
        Model that stands in for this one at accuracy preview.
    cost : Cost
        Measured cost; orders of magnitude.
    falling : Cost, optional
        Measured cost where friction depends on the slip speed; by default `cost`.
    film : Cost, optional
        Measured cost with a film between the bodies; by default `cost`.
    source : str
        Digest of the source of a model from outside, which `register` adds for the identity of its
        cases.
    """

    name: str
    meaning: str
    converged_up_to: float = 1e-7
    rank: int = 0
    options: tuple[str, ...] = ()
    normals: tuple[str, ...] = ("hertz",)
    slip_terms: tuple[str, ...] = ()
    friction_laws: bool = False
    films: bool = False
    remedy: str = "Take contact_model: kalker."
    known_errors: bool = False
    rough_peaks: bool = False
    cheaper: str = ""
    cost: Cost = Cost()
    falling: Cost | None = None
    film: Cost | None = None
    source: str = ""

    def cost_of(self, friction_falls: bool, has_film: bool) -> Cost:
        """Return the cost of a case by its friction and its film."""
        if friction_falls:
            return self.falling or self.cost
        if has_film:
            return self.film or self.cost
        return self.cost

    def check(self, option: str, value: str) -> None:
        """Refuse a word of `normal` or `slip_terms` that the model does not serve."""
        if option == "normal":
            allowed = self.normals
        else:
            allowed = self.slip_terms
        if value not in allowed:
            words = ", ".join(allowed) or "no word"
            raise InputError(
                option, value, f"{words} only, with contact_model: {self.name}", self.remedy
            )


# The costs of the built-in models are measured on random designs, see `validation.tradeoff`.
_BUILT_IN = (
    ModelDeclaration(
        "sliding",
        "Coulomb friction at every point against the local creepage, as published; no adhesion "
        "area",
        converged_up_to=1e-10,
        rank=1,
        options=("spin_model",),
        normals=("hertz", "halfspace"),
        slip_terms=("profile",),
        friction_laws=True,
        remedy="Take contact_model: kalker, or leave 'curve' out: in full sliding it changes no "
        "force, it only "
        "lengthens slip and friction work.",
        known_errors=True,
        cost=Cost.measured("sliding"),
        falling=Cost.measured("sliding", "falling"),
    ),
    ModelDeclaration(
        "kalker",
        "exact theory of rolling contact; by its table at accuracy preview",
        converged_up_to=1e-4,
        rank=3,
        options=("slip_terms",),
        normals=("hertz", "halfspace"),
        slip_terms=("profile", "curve"),
        friction_laws=True,
        films=True,
        known_errors=True,
        cheaper="kalker_table",
        cost=Cost.measured("kalker"),
        falling=Cost.measured("kalker", "falling"),
        film=Cost.measured("kalker", "films"),
    ),
    ModelDeclaration(
        "kalker_table",
        "table of solutions of the exact theory; the exact theory outside its range and beside a "
        "nearly lifted contact",
        converged_up_to=1e-4,
        rank=2,
        options=("slip_terms",),
        slip_terms=("curve",),
        known_errors=True,
        rough_peaks=True,
        cost=Cost.measured("kalker_table"),
    ),
)
# Cost of solved patches (`normal: halfspace`) by kalker; other models take less.
SOLVED_PATCHES = Cost((0.2, 0.4, 0.7), (0.03, 0.2, 2.8), Cost.measured("kalker").shares)

DECLARED: dict[str, ModelDeclaration] = {}
MEANINGS: dict[str, str] = {}  # values of the option `contact_model`
CONTACT_MODELS: list[str] = []  # in the order of the numbers in `contact_model_used`
EXACTNESS: list[str] = []  # the most exact model first


def declare(model: ModelDeclaration) -> None:
    """Add a contact model to the option `contact_model`; its number in results is the next free
    one.
    """
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
