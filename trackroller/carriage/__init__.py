"""A carriage on track rollers: the loads of each roller from masses, motion and forces.

The module itself can be called: `trackroller.carriage` is both this room and the function
`solve_carriage`.
"""

from __future__ import annotations

import sys
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import xarray as xr


class _CallableModule(ModuleType):
    def __call__(self, source: Any, lives: bool = True) -> xr.Dataset:
        from trackroller.carriage.solve import solve_carriage  # heavy: scipy

        return solve_carriage(source, lives)


sys.modules[__name__].__class__ = _CallableModule
