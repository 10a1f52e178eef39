"""What solving costs: cases a second and bytes a case, for `plan` and for the size of chunks."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product
from typing import TYPE_CHECKING, Any

from trackroller.parameters import OPTIONS
from trackroller.study.design.entries import OPTION_FACTORS

if TYPE_CHECKING:
    from trackroller.study.config import Study

# Seconds of one core a case at preview, standard and reference, measured on random designs (friction 0.01 to 1, contact
# angles 10 to 80 deg, materials of all sorts) on a 2-core machine; ordinary designs take half. Orders of magnitude.
_LEVELS = ("preview", "standard", "reference")
_FORCES = {
    "sliding": (7e-4, 8e-4, 3.4e-3),
    "fastsim": (0.016, 0.04, 0.125),
    "kalker": (2.5e-3, 0.01, 0.08),  # at preview with the table
    "kalker_table": (2.5e-3, 5e-3, 0.05),
    "halfspace": (0.9, 0.8, 6.0),  # patches solved on a grid, any contact model
}
_PEAKS = {
    "sliding": (1.4e-3, 1.8e-3, 8.5e-3),
    "fastsim": (2.5e-3, 7e-3, 0.013),
    "kalker": (3e-3, 4e-3, 0.15),
    "kalker_table": (3e-3, 0.01, 0.2),
    "halfspace": (0.1, 0.25, 1.0),
}
_TRACTIONS, _SUBSURFACE = 1e-3, 0.1
_BYTES = {
    "forces": 200,
    "contact": 120,
    "friction_work": 40,
    "peak_stress": 160,
    "life": 90,
    "tractions": 300_000,
    "subsurface": 1_500_000,
}


def rate(options: Mapping[str, Any]) -> float:
    """Return the expected cases a second on one core for keyword arguments of `solve`."""
    accuracy = options.get("accuracy", "standard")
    if accuracy in _LEVELS:
        level = _LEVELS.index(accuracy)
    else:
        level = 1 if accuracy >= 1e-3 else 2
    groups = set(options.get("outputs", ("forces",)))
    model = options.get("contact_model", OPTIONS["contact_model"].default)
    model = "halfspace" if options.get("normal") == "halfspace" else model
    seconds = _FORCES[model][level]
    if groups & {"peak_stress", "life", "subsurface"}:  # one search serves all
        seconds += _PEAKS[model][level]
    seconds += _TRACTIONS * ("tractions" in groups) + _SUBSURFACE * ("subsurface" in groups)
    return 1.0 / seconds


def study_rate(study: Study) -> float:
    """Return the expected cases a second of a study, in which contact model and normal problem may be factors."""
    varied = {name: spec["values"] for name, spec in study.factors.items() if name in OPTION_FACTORS}
    several = [rate(study.options | dict(zip(varied, values, strict=True))) for values in product(*varied.values())]
    return len(several) / sum(1.0 / each for each in several)


def bytes_a_case(outputs: tuple[str, ...]) -> int:
    """Return the expected size of a case on the disk, chunk and gathered set together."""
    return 2 * (60 + sum(_BYTES[group] for group in set(outputs)))


def duration(seconds: float) -> str:
    """Return a time in words: '45 s', '3 min 20 s', '2 h 5 min'."""
    whole = int(seconds + 0.5)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"
