"""Give steel of a known hardness the line of tests in rolling contact that its hardness tells."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from trackroller.damage.pressure_line import (
    CYCLES,
    EXPONENT,
    HARDNESS,
    VALUES,
    pressure_of_hardness,
)
from trackroller.errors import InputError
from trackroller.materials.properties import PROPERTIES, Value

BY_HARDNESS = (
    "by hardness, after Budynas, Nisbett: Shigley's Mechanical Engineering Design, 9th ed., "
    "equations (6-68) of rollers and (6-69) of gear flanks"
)
STEEL = (1.85e5, 2.2e5)  # MPa; ASSUME: a metal with such a Young's modulus is steel


def with_line_of_hardness(records: Mapping[str, Value], where: str) -> dict[str, Value]:
    """Return the values of a material with the line of its hardness, where it gives no other line.

    Parameters
    ----------
    records : mapping of str to Value
        Values of the material by name. A line by hardness that is inherited is computed anew.
    where : str
        Place of the material, for messages.

    Returns
    -------
    dict of str to Value
        With `rolling_pressure`, `rolling_cycles` and `rolling_exponent` for steel that is not
        surface hardened, whose S-N curve is not of rolling contact, and that has a hardness of
        `HARDNESS`. The pressure lies between those of
        rollers and of gear flanks; its value is their geometric mean.

    Raises
    ------
    InputError
        If some values of a line are given and others are missing.
    """
    by_hardness = [name for name in VALUES if _is_by_hardness(records.get(name))]
    out = {name: value for name, value in records.items() if name not in by_hardness}
    given = [name for name in VALUES if name in out]
    missing = [name for name in VALUES if name not in out]
    if given and missing:
        wrong = f"is missing: the line of {given[0]} lacks {' and '.join(missing)}"
        raise InputError(f"{where}.{missing[0]}", None, "", "Give these values.", wrong)
    if given or not _has_hardness(out):
        return out
    origin = out["hardness"].origin
    ends = np.sort(pressure_of_hardness(out["hardness"].value))
    low, high = float(ends[0]), float(ends[1])
    pressure = float(np.sqrt(low * high))
    span = (low, high)
    line = Value(pressure, "MPa", BY_HARDNESS, True, "by hardness", origin, span, "formula")
    exact = replace(line, placeholder=False, note="", range=None, unit="-")
    out["rolling_pressure"] = line
    out["rolling_cycles"] = replace(exact, value=CYCLES)
    out["rolling_exponent"] = replace(exact, value=EXPONENT)
    return {name: out[name] for name in (*PROPERTIES, *out) if name in out}


def _is_by_hardness(record: Value | None) -> bool:
    return record is not None and record.source == BY_HARDNESS


def _has_hardness(records: Mapping[str, Value]) -> bool:
    """Return whether the hardness tells the line: steel, hardened through or not at all, that has
    no tests of its own in rolling contact.
    """
    modulus = records.get("youngs_modulus")
    hardness = records.get("hardness")
    if modulus is None or hardness is None:
        return False
    for mark in ("surface_hardened", "sn_in_rolling"):
        if mark in records and records[mark].value:
            return False
    is_steel = STEEL[0] <= modulus.value <= STEEL[1]
    return is_steel and HARDNESS[0] <= hardness.value <= HARDNESS[1]
