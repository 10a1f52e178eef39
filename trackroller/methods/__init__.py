"""Designs of experiments, one file each behind the class `Method`: how they draw rows, and how they
analyse them.
"""

from __future__ import annotations

from trackroller.methods.arrays import BoxBehnken, CentralComposite, PlackettBurman
from trackroller.methods.grid import Grid
from trackroller.methods.inner_outer import InnerOuter
from trackroller.methods.lhs import LatinHypercube
from trackroller.methods.method import (
    METHODS,
    Design,
    Method,
    register,
    those_that_take,
    those_with,
)
from trackroller.methods.morris import Morris
from trackroller.methods.optimise import Optimise
from trackroller.methods.saltelli import Saltelli
from trackroller.methods.sobol import Sobol
from trackroller.methods.table import GivenTable

_FILES: tuple[type[Method], ...] = (
    Grid,
    LatinHypercube,
    Sobol,
    Morris,
    Saltelli,
    CentralComposite,
    BoxBehnken,
    PlackettBurman,
    InnerOuter,
    GivenTable,
    Optimise,
)
for _method in _FILES:
    register(_method)

__all__ = ["METHODS", "Design", "Method", "register", "those_that_take", "those_with"]
