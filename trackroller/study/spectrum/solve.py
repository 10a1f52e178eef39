"""Solve the blocks of a load spectrum and sum their damage to the life of roller and guide in shifts.

ASSUME: damage adds up linearly, independent of the order of the blocks (Palmgren-Miner).
ASSUME: the blocks load the same two tracks of the roller and the same point of the guide.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from trackroller.materials import load_database
from trackroller.study.spectrum.damage import damage_dataset
from trackroller.study.spectrum.file import Block, Spectrum, load_spectrum

if TYPE_CHECKING:
    import xarray as xr

    from trackroller.materials import MaterialDatabase

__all__ = ["Block", "Spectrum", "load_spectrum", "solve_spectrum"]


def solve_spectrum(
    spectrum: Spectrum,
    database: MaterialDatabase | None = None,
    solve: Callable[..., xr.Dataset] | None = None,
) -> xr.Dataset:
    """Return the damage of each block, the damage sum, and the life of roller and guide in shifts.

    Parameters
    ----------
    spectrum : Spectrum
        The blocks and the options of their solution.
    database : MaterialDatabase, optional
        Materials. Default: the built-in database, changed and extended by the user's own file.
    solve : callable, optional
        Function that solves the cases, with the signature of `trackroller.solve`, which is the default.

    Returns
    -------
    xarray.Dataset
        Dimensions block, contact and body, and probability where a material gives scatter. Overrollings per shift, peak
        stress [MPa], damage per shift [1], life in shifts of each track and to the first failure of each body. A block
        that cannot be solved makes the lives that depend on it NaN; `regime` states why. A contact that lifts off takes
        no damage in that block. The life of the guide is NaN where its overrollings are not known.

    Notes
    -----
    Damage adds up linearly, independent of the order of the blocks (Palmgren-Miner).
    """
    solve_cases: Callable[..., xr.Dataset]
    if solve is None:
        from trackroller.roller.solver import solve as solve_cases  # numba compiles on import
    else:
        solve_cases = solve
    database = load_database() if database is None else database
    cases = [block.case for block in spectrum.blocks]
    options = {key: value for key, value in spectrum.options.items() if key != "life_rule"}
    solved = solve_cases(cases, outputs=("forces", "peak_stress"), database=database, **options)
    return damage_dataset(spectrum, solved, database)
