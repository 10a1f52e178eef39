"""Choose the settings of each stage for an accuracy, and state the error that remains.

A ladder is a list of measured settings of one stage, sorted by cost; each setting is a rung. There is one ladder for
the quadrature of forces, one for the search of the peak stress, and one for the elements of each rolling contact model
(`roller/accuracy.json`, written by `python -m validation.adopt tradeoff`). A preset or a tolerance takes from each
ladder the cheapest setting whose measured error is small enough. A contact model that estimates the error of each case
meets a tolerance case by case instead, see `Tolerance` and `roller.tolerance`.
"""

from __future__ import annotations

import functools
import json
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from importlib import resources
from typing import Any

from trackroller.contact.settings import Accuracy
from trackroller.errors import InputError, unknown_name
from trackroller.halfspace.peak_settings import PeakSettings
from trackroller.numerics.numbers import number_or_nan, rounded_up
from trackroller.parameters import ACCURACIES, DEFAULT_OUTPUTS
from trackroller.parameters.contact_models import DECLARED

FORCE_QUANTITIES = ("normal_force", "friction_force", "spin_moment")
PEAK_OUTPUTS = frozenset(("peak_stress", "life", "subsurface"))
FORCE_SHARE = 0.1  # share of the tolerance for the forces of full sliding, whose cost is low
LIKELY_EXPONENT = 10.0  # of an S-N curve, for the search of the peak where the life has a tolerance
PEAK_SHARE = 0.2  # share of the tolerance for the search of the peak, beside that for the elements
SEARCH_SHARE = 0.4  # the same for a tolerance met case by case, where the estimated error contains that of the search
# For tolerances from each key up: the number of elements across a patch at first, and how often it may double.
BY_CASE = {5.5e-2: (16, 2), 1.5e-2: (20, 2), 5e-3: (24, 2), 0.0: (24, 3)}
WHOLE_ELEMENTS = (56, 112)  # across all patches of a case whose elements cannot double patch by patch
FORCE_SAFETY = 1.6  # factor on the estimated error of forces; the error of 1 in 100 designs is larger
SMALLEST = {"forces": 1e-3, "peak": 3e-3}  # allowed tolerances; most designs keep them, on at most 192 elements


@dataclass(frozen=True)
class Levels:
    """Measured relative errors over the sample of designs: percentiles, and `bound`, which 99 % of all cases keep."""

    median: float
    p95: float
    p99: float
    bound: float


@dataclass(frozen=True)
class Rung:
    """One measured setting of a ladder: cost (processor time of a case [s]) and errors by quantity [1]."""

    settings: Mapping[str, Any]
    cost: float
    errors: Mapping[str, Levels]

    def keeps(self, tolerance: float, quantities: Iterable[str], level: str = "bound") -> bool:
        """Return True if the measured errors of these quantities, at this level, are within the tolerance."""
        return all(getattr(self.errors[q], level) <= tolerance for q in quantities if q in self.errors)


Ladders = Mapping[str, tuple[Rung, ...]]


@functools.cache
def ladders() -> Ladders:
    """Return the measured ladders `forces`, `peak`, `kalker`, each sorted by rising cost."""
    text = resources.files("trackroller.roller").joinpath("accuracy.json").read_text(encoding="utf-8")
    return read_ladders(json.loads(text)["ladders"])


def read_ladders(records: Mapping[str, Iterable[Mapping[str, Any]]]) -> Ladders:
    """Return ladders from the records that the measurement writes."""
    return {name: tuple(sorted((_rung(r) for r in rungs), key=lambda r: r.cost)) for name, rungs in records.items()}


def _rung(record: Mapping[str, Any]) -> Rung:
    errors = {name: Levels(*values) for name, values in record["errors"].items()}
    return Rung(record["settings"], float(record["cost"]), errors)


def _cheapest(
    ladder: tuple[Rung, ...], tolerance: float, quantities: Iterable[str], level: str = "bound"
) -> Rung | None:
    wanted = tuple(quantities)
    return next((rung for rung in ladder if rung.keeps(tolerance, wanted, level)), None)


def _finest(ladder: tuple[Rung, ...], quantities: Iterable[str]) -> Rung:
    wanted = tuple(quantities)
    return min(ladder, key=lambda rung: max(rung.errors[q].bound for q in wanted if q in rung.errors))


def _composed(name: str, tolerance: float, forces: Rung, peak: Rung, elements: int) -> Accuracy:
    rough, fine = tolerance > 1e-2, tolerance < 5e-4
    points = (31, 31) if rough else (81, 121) if fine else (41, 61)
    return Accuracy(
        name,
        tolerance,
        forces.settings["force_nodes"],
        forces.settings["coarse_nodes"],
        PeakSettings(*peak.settings["peak"]),
        *points,
        elements,
    )


# Errors of the peak and of the forces that a preset keeps in full sliding in 99 % of the measured designs.
PROMISES = {"preview": (2e-2, 5e-3), "standard": (4e-3, 2e-5), "reference": (3e-4, 1e-7)}
# Elements of `kalker` across a patch. They are fixed, because too few designs are measured to distinguish neighbouring
# numbers of elements. A choice from the ladder would change with the sample.
ELEMENTS = {"preview": 12, "standard": 28, "reference": 56}
# Elements of solved patches, which do not interpolate between their elements.
GRID_ELEMENTS = {"preview": 20, "standard": 40, "reference": 80}


def preset_rungs(name: str, measured: Ladders) -> tuple[Rung, Rung]:
    """Return the cheapest rungs for forces and peak that keep a preset's errors, otherwise the finest."""
    peak_error, force_error = PROMISES[name]
    forces, peak = measured["forces"], measured["peak"]
    return (
        _cheapest(forces, force_error, FORCE_QUANTITIES, "p99") or _finest(forces, FORCE_QUANTITIES),
        _cheapest(peak, peak_error, ("peak_stress",), "p99") or _finest(peak, ("peak_stress",)),
    )


def _preset(name: str) -> Accuracy:
    composed = _composed(name, PROMISES[name][0], *preset_rungs(name, ladders()), ELEMENTS[name])
    return replace(composed, grid_elements=GRID_ELEMENTS[name])


PRESETS = {name: _preset(name) for name in ACCURACIES}


@dataclass(frozen=True)
class Tolerance:
    """Relative errors that a case may have, met case by case; infinite where nothing is asked.

    Parameters
    ----------
    forces : float
        Of F_N and friction work, relative to themselves, of F_T and F_A over mu F_N, and of M_R over mu F_N sqrt(a b).
    peak, life : float
        Of the peak stress and the life, relative to themselves.
    """

    forces: float = math.inf
    peak: float = math.inf
    life: float = math.inf

    @classmethod
    def read(cls, value: float | Mapping[str, float], outputs: Iterable[str]) -> Tolerance:
        """Return the tolerances that a user asks for; a number holds for forces and, if they are computed, for peaks.

        Raises
        ------
        InputError
            If a tolerance is smaller than the finest elements keep.
        """
        peaks = bool(PEAK_OUTPUTS & set(outputs))
        asked = dict(value) if isinstance(value, Mapping) else dict.fromkeys(("forces", *("peak",) * peaks), value)
        for name, smallest in SMALLEST.items():
            if asked.get(name, math.inf) < smallest:
                best = ", ".join(f"{key}: {max(SMALLEST.get(key, 0.0), own):g}" for key, own in asked.items())
                allowed = f"{smallest:g} or more for {name}, which the finest elements keep"
                raise InputError("accuracy", value, allowed, f"Write accuracy: {{{best}}}, or take 'reference'.")
        if not peaks and (extra := [name for name in ("peak", "life") if name in asked]):
            remedy = f"Leave {extra[0]} out, or add peak_stress or life to outputs."
            raise InputError("accuracy", extra[0], "a tolerance of a quantity that is computed", remedy)
        return cls(**asked)

    def settings(self, elements: int = 0) -> Accuracy:
        """Return the settings to solve with, on as many elements as the tolerance suggests, or on `elements`."""
        peak, searches = min(self.peak, self.life / LIKELY_EXPONENT), ladders()["peak"]
        search = _cheapest(searches, SEARCH_SHARE * peak, ("peak_stress",)) or _finest(searches, ("peak_stress",))
        forces = _finest(ladders()["forces"], FORCE_QUANTITIES)
        first, doublings = next(own for limit, own in BY_CASE.items() if min(self.forces, peak) >= limit)
        return replace(
            _composed("by case", min(self.forces, peak), forces, search, elements or first),
            doublings=doublings,
            force_goal=self.forces / FORCE_SAFETY,
            peak_goal=self.peak,
            life_goal=self.life,
        )


def accuracy_settings(
    accuracy: str | float | Mapping[str, float] | Accuracy, contact_model: str, outputs: Iterable[str] = DEFAULT_OUTPUTS
) -> Accuracy:
    """Return the settings of a preset, or the cheapest measured settings that meet a relative tolerance.

    Parameters
    ----------
    accuracy : str, float, mapping or Accuracy
        Preset, or relative tolerance in (0, 1), also by quantity. An `Accuracy` is returned as it is.
    contact_model : str
        Contact model, which chooses the ladder.
    outputs : iterable of str
        Groups of results that have to meet the tolerance.

    Returns
    -------
    Accuracy
        The settings.

    Raises
    ------
    InputError
        For unknown names, numbers outside (0, 1) and tolerances that the finest settings do not reach.

    Notes
    -----
    For `kalker` see `Tolerance`. For other models the tolerance limits the error of discretisation, not that of the
    model, in 99 % of the measured cases. It is relative to F_N for F_N, to mu F_N for F_T and F_A, to mu F_N sqrt(a b)
    for M_R, and to the value itself for friction work and peak stress. The relative error of the life is that of the
    peak times the exponent k of the S-N curve.
    """
    if isinstance(accuracy, Accuracy):
        return accuracy
    if isinstance(accuracy, str):
        if accuracy in PRESETS:
            return _preset_of(contact_model, accuracy)
        number = number_or_nan(accuracy, "-", "accuracy")  # of a text such as 1 %
        if math.isnan(number):
            raise unknown_name("accuracy", accuracy, (*ACCURACIES, "a relative tolerance such as 1e-3"))
        accuracy = number
    if DECLARED[contact_model].by_case and (by_case := tolerance_of(accuracy, outputs)) is not None:
        return by_case.settings()
    if isinstance(accuracy, Mapping):
        remedy = f"Give {contact_model} one number, or take contact_model: kalker."
        raise InputError("accuracy", accuracy, "a tolerance by quantity only with contact_model: kalker", remedy)
    if isinstance(accuracy, bool) or not isinstance(accuracy, (int, float)) or not 0.0 < accuracy < 1.0:
        raise InputError("accuracy", accuracy, f"one of {', '.join(ACCURACIES)} or a relative tolerance in (0, 1)")
    return _for_tolerance(float(accuracy), contact_model, frozenset(outputs))


def tolerance_of(accuracy: Any, outputs: Iterable[str]) -> Tolerance | None:
    """Return the tolerances that an accuracy asks for, None for a preset, settings, and what is no tolerance."""
    if isinstance(accuracy, str):
        accuracy = number_or_nan(accuracy, "-", "accuracy")
    number = isinstance(accuracy, (int, float)) and not isinstance(accuracy, bool) and 0.0 < accuracy < 1.0
    return Tolerance.read(accuracy, outputs) if number or isinstance(accuracy, Mapping) else None


@functools.lru_cache(maxsize=64)
def _preset_of(contact_model: str, name: str) -> Accuracy:
    """Return the settings of a preset for a contact model, see `ModelDeclaration.rough_peaks`."""
    own, names = PRESETS[name], list(PROMISES)
    if not DECLARED[contact_model].rough_peaks:
        return own
    coarser = PRESETS[names[max(names.index(name) - 1, 0)]]
    return replace(own, peak=coarser.peak, peak_elements=coarser.elements)


@functools.lru_cache(maxsize=256)
def _for_tolerance(tolerance: float, contact_model: str, outputs: frozenset[str]) -> Accuracy:
    peaks = bool(outputs & PEAK_OUTPUTS)
    declared = DECLARED[contact_model]
    if not declared.ladder:
        allowed = f"a preset ({', '.join(ACCURACIES)}): the errors of {contact_model} were not measured"
        raise InputError("accuracy", tolerance, allowed)
    if declared.own_errors and tolerance < (finest := finest_tolerance(contact_model)):
        raise InputError(
            "accuracy",
            tolerance,
            f"{finest:g} or more, which {contact_model} keeps of mu F_N in 99 % of the cases",
            "Use a preset or a larger tolerance, or contact_model: kalker.",
        )
    wanted = (
        *FORCE_QUANTITIES,
        *(("friction_energy",) if "friction_work" in outputs else ()),
        *(("peak_stress",) if peaks else ()),
    )
    ladder, rolling = declared.ladder, declared.ladder != "forces"
    elements = PRESETS["standard"].elements
    if rolling:
        rung = _cheapest(ladders()[ladder], (1.0 - PEAK_SHARE) * tolerance if peaks else tolerance, wanted)
        if rung is None:
            shares = {ladder: 1.0 - PEAK_SHARE, "peak": PEAK_SHARE} if peaks else {ladder: 1.0}
            raise _beyond(tolerance, contact_model, shares, wanted)
        elements = rung.settings["elements"]
    share = FORCE_SHARE if peaks and not rolling else 1.0
    nodes, searches = ladders()["forces"], ladders()["peak"]
    forces = _cheapest(nodes, share * tolerance, wanted) or _cheapest(nodes, tolerance, wanted)
    peak = _cheapest(searches, PEAK_SHARE * tolerance if rolling else tolerance, ("peak_stress",) if peaks else ())
    if peak is None or (forces is None and not rolling):
        shares = {"peak": PEAK_SHARE} if rolling else {"forces": 1.0, **({"peak": 1.0} if peaks else {})}
        raise _beyond(tolerance, contact_model, shares, wanted)
    return _composed(f"{tolerance:g}", tolerance, forces or _finest(nodes, FORCE_QUANTITIES), peak, elements)


def _beyond(tolerance: float, model: str, shares: Mapping[str, float], wanted: Iterable[str]) -> InputError:
    """Return the error for a tolerance that is too small; it states the smallest tolerance of the finest rungs."""
    bounds: dict[str, float] = {}
    for ladder, share in shares.items():
        known = [q for q in wanted if q in ladders()[ladder][0].errors]
        rung = _finest(ladders()[ladder], known)
        for q in known:
            bounds[q] = max(bounds.get(q, 0.0), rung.errors[q].bound / share)
    worst = max(bounds, key=lambda q: bounds[q])
    reached = rounded_up(bounds[worst])
    return InputError(
        "accuracy",
        tolerance,
        "",
        "Use 'reference' for the finest settings, a larger tolerance, or only the outputs that you need.",
        f"is too fine: the finest tolerance that {model} reaches here is {reached:g}, by its {worst.replace('_', ' ')}",
    )


def own_errors(contact_model: str) -> dict[str, Levels]:
    """Return the measured errors of the forces that the class of a contact model states, by quantity."""
    from trackroller.contact.models import CLASSES  # loads numba, which a plan at a preset does not need

    return {quantity: Levels(*levels) for quantity, levels in CLASSES[contact_model].errors().items()}


def finest_tolerance(contact_model: str) -> float:
    """Return the tolerance of forces that the model keeps in 99 % of the cases."""
    return rounded_up(max(levels.p99 for levels in own_errors(contact_model).values()))
