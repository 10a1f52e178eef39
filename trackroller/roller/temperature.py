"""Take E and R_m of materials with a table at the temperature of their body, which depends on them
in turn.

A case is solved with its materials' own values first. The output `heat` gives the temperature of
each body, the tables give E and R_m there, and the case is solved again, until the temperature
stays.

ASSUME: the bulk temperature counts, not the flash, which stays in a thin layer for a short part of
a revolution. ASSUME: fatigue limits, yield strength and hardness keep their ratio to R_m; other
values do not depend on temperature. ASSUME: while a profile wears along its travel, the body has
its material's own values.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from trackroller.materials.temperature import FOLLOW_STRENGTH, TABLED, TemperatureTable
from trackroller.parameters import BODIES
from trackroller.roller.block_results import BlockResults, join

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import ArrayLike

    from trackroller.roller.case_table import CaseTable, MaterialArrays
    from trackroller.roller.options import Options

TOLERANCE = 0.005  # change of the temperature in the last pass [K]
PASSES = 10
HEAD = "temperature: "  # of a note on a table
UNSETTLED = "unsettled"  # cases without a fixed point within the passes
REASON = (
    f"the temperature still changes by more than {TOLERANCE:g} K after {PASSES} passes "
    "between heat and the material's "
    "temperature_dependence: cool the roller better, or give values for one temperature"
)
_table = lru_cache(maxsize=256)(lambda text: TemperatureTable(**json.loads(text)))


def settle(
    table: CaseTable,
    block: BlockResults,
    options: Options,
    solve: Callable[[CaseTable], BlockResults],
) -> tuple[CaseTable, BlockResults]:
    """Solve cases whose materials have tables again until their temperatures stay.

    Parameters
    ----------
    table, block : CaseTable and Block
        The n cases, and their results with the materials' own values.
    options : Options
        Their options; where heat is not computed, no temperature is known and nothing changes.
    solve : callable
        Solve a table.

    Returns
    -------
    table : CaseTable
        The cases with the values at their temperatures.
    block : BlockResults
        Their results, with `unsettled`, (n,), if a case was solved again. Cases without a table
        keep theirs.
    """
    rows = np.flatnonzero(
        (table.roller.temperature_dependence != "") | (table.guide.temperature_dependence != "")
    )
    if "bulk_temperature_rise" not in block.values or not rows.size:
        return table, block
    reached = temperatures(table, block)
    used = np.full_like(reached, np.nan)
    warm = table
    for _ in range(PASSES):
        used[rows] = reached[rows]
        before = warm
        warm = at_temperatures(table, used)
        rows = rows[_differ(before, warm)[rows]]  # equal values have equal results
        if not rows.size:
            break
        newest_row = np.arange(len(block))
        newest_row[rows] = len(block) + np.arange(rows.size)
        block = join([block, solve(warm.take(rows))]).take(newest_row)
        reached = temperatures(table, block)
        rows = rows[np.fmax.reduce(np.abs(reached - used)[rows], axis=1) > TOLERANCE]
    if rows.size:
        block.converged[rows] = False
        block.values[UNSETTLED] = np.isin(np.arange(len(block)), rows).astype(float)
    return warm, block


def temperatures(table: CaseTable, block: BlockResults) -> np.ndarray:
    """Return the temperature of roller and guide, (n, body) [degC]; NaN where `heat` does not know
    the rise.
    """
    # a contact that has lifted off has none
    rise = np.fmax.reduce(block.values["bulk_temperature_rise"], axis=1)
    return np.asarray(table.ambient_temperature[:, None] + rise)


def temperatures_of(ds: xr.Dataset, ambient: ArrayLike) -> np.ndarray:
    """Return the temperature of roller and guide of one result, (body,), or of each case, (n, body)
    [degC].

    `ambient` is the temperature of the surroundings, a number or (n, 1) [degC]. Without the output
    `heat` all is NaN.
    """
    if "bulk_temperature_rise" not in ds:
        return np.full(np.broadcast_shapes(np.shape(ambient), (len(BODIES),)), np.nan)
    rise = ds["bulk_temperature_rise"].transpose(..., "contact", "body").values
    return np.asarray(ambient + np.fmax.reduce(rise, axis=-2))


def at_temperatures(table: CaseTable, temperature: np.ndarray) -> CaseTable:
    """Return the cases with the values of their tables at temperatures, (n, body) [degC]; NaN
    leaves them.
    """
    bodies = {body: _at(getattr(table, body), temperature[:, i]) for i, body in enumerate(BODIES)}
    return replace(table, **bodies)


def _at(body: MaterialArrays, temperature: np.ndarray) -> MaterialArrays:
    values = {name: getattr(body, name).copy() for name in TABLED}
    for text in set(body.temperature_dependence) - {""}:
        rows = (body.temperature_dependence == text) & ~np.isnan(temperature)
        own = _table(text)
        for name in own.columns:
            values[name][rows] = own.at(name, temperature[rows])
    share = values["tensile_strength"] / body.tensile_strength
    return replace(
        body,
        **values,
        **{name: getattr(body, name) * share for name in ("fatigue_limit", *FOLLOW_STRENGTH)},
    )


def _differ(one: CaseTable, other: CaseTable) -> np.ndarray:
    """Return whether a value that a table may hold differs, (n,)."""
    pairs = [(getattr(one, body), getattr(other, body)) for body in BODIES]
    return np.any(
        [getattr(a, name) != getattr(b, name) for a, b in pairs for name in TABLED], axis=0
    )


def reasons(block: BlockResults) -> dict[int, str]:
    """Return why cases did not settle, by row."""
    return dict.fromkeys(
        np.flatnonzero(block.values.get(UNSETTLED, np.zeros(0)) > 0).tolist(), REASON
    )


def notes(table: CaseTable, block: BlockResults) -> list[str]:
    """Return one sentence on each table that results rest on, and on each that a temperature
    leaves.
    """
    if "bulk_temperature_rise" not in block.values:
        return []
    reached = temperatures(table, block)
    out = []
    for i, body in enumerate(BODIES):
        own = getattr(table, body)
        for name, text in dict.fromkeys(zip(own.name, own.temperature_dependence, strict=True)):
            if text == "":
                continue
            here = reached[(own.name == name) & (own.temperature_dependence == text), i]
            low, high = (_table(text).temperature[end] for end in (0, -1))
            values = " and ".join(_table(text).columns)
            out.append(f"{HEAD}{values} of material '{name}' are those at its bulk temperature.")
            if np.isnan(here).any():
                out.append(
                    f"{HEAD}where that of material '{name}' is not known, its table is not used."
                )
            if np.any((here < low) | (here > high)):
                out.append(
                    f"{HEAD}material '{name}' leaves its table from {low:g} to {high:g} degC, "
                    "whose end counts there."
                )
    return list(dict.fromkeys(out))
