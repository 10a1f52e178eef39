"""Write `kernels.py` from the derivation in `potentials`: `python -m validation.derivations.kernel_writer`."""

from __future__ import annotations

import re
from pathlib import Path

import sympy as sp

from trackroller.halfspace import kernels
from validation.derivations.potentials import KERNELS, LOADS, check_dilatation, kernel_elements

_HEADER = '''"""Stresses of point loads and corner functions of loaded rectangles. GENERATED: do not edit.

Written by `python -m validation.derivations.kernel_writer`; `validation/derivations/potentials.py`
derives them. Every function returns 36 numbers: A for the loads x, y, z (slowest) and the
components xx, yy, zz, xy, yz, xz, then B in the same order; the stress is A + nu B. Lengths of
corner functions are in units of the grid spacing: FLOOR is the distance below which logarithms stop
growing, which keeps a step of traction finite on its edge.
"""

from math import asinh, atan2, log, sqrt

from trackroller.numerics.compiled import compiled

FLOOR = 1e-10
'''

_COMMON = """    x2, y2, z2 = x * x, y * y, z * z
    R = sqrt(x2 + y2 + z2)
    iR = 1.0 / R if R > 0.0 else 0.0
    S = R + z
    iS = 1.0 / S if S > 0.0 else 0.0
"""
_CORNER = """    P = x2 + z2
    Q = y2 + z2
    Lx = asinh(x / max(sqrt(Q), FLOOR))
    Ly = asinh(y / max(sqrt(P), FLOOR))
    Lz = log(max(S, FLOOR))
    t = x * y * (x2 + y2) * iS
    Ax = atan2(t, x2 * R + y2 * z)
    Ay = atan2(t, y2 * R + x2 * z)
"""
_ROWS = ("load_x", "load_y", "load_z", "nu_x", "nu_y", "nu_z")  # six components for each load, A and then B
_TITLES = {
    "point_kernel": "Return the stresses at (x, y, z) due to unit forces at the origin [1/length^2].",
    "bilinear_corner": "Return the corner function of bilinear tractions; d4/dx2dy2: `point_kernel` [length^2].",
}


def _without_unused(prelude: str, body: str) -> str:
    """Return the assignments of the prelude that a later line uses."""
    kept: list[str] = []
    for line in reversed(prelude.splitlines()):
        names = {name.strip() for name in line.split(" = ")[0].split(",")}
        if names & set(re.findall(r"[A-Za-z_]\w*", body + "".join(kept))):
            kept.insert(0, line + "\n")
    return "".join(kept)


def function_source(name: str) -> str:
    """Return the Python source of one kernel function, with common subexpressions computed once."""
    expressions = [f.as_expr() / (2 * sp.pi) for f in kernel_elements(name)]
    shared, reduced = sp.cse(expressions, symbols=sp.numbered_symbols("t"), optimizations="basic", order="canonical")
    printer = sp.printing.pycode
    lines = "".join(f"    {symbol} = {printer(value.evalf(17))}\n" for symbol, value in shared)
    values = [printer(sp.Float(e) if e.is_number else e.evalf(17)) for e in reduced]
    rows = "".join(f"    {row} = {', '.join(values[6 * k : 6 * k + 6])}\n" for k, row in enumerate(_ROWS))
    prelude = _without_unused(_COMMON + ("" if name == "point_kernel" else _CORNER), lines + rows)
    return (
        f'\n\n@compiled\ndef {name}(x, y, z):\n    """{_TITLES[name]}"""\n{prelude}{lines}{rows}'
        f"    return {' + '.join(_ROWS)}\n"
    )


def module_source() -> str:
    """Return the whole text of `kernels.py`."""
    if not all(check_dilatation(load) for load in LOADS):
        raise ArithmeticError("the dilatation is not proportional to 1 - 2 nu")
    return _HEADER + "".join(function_source(name) for name in KERNELS)


def main() -> None:
    """Write `trackroller/halfspace/kernels.py`."""
    here = Path(kernels.__file__)
    here.write_text(module_source(), encoding="utf-8")
    for module in here.parent.glob("*.py"):
        if "halfspace.kernels import" in module.read_text(encoding="utf-8"):
            module.touch()  # otherwise numba would use code that it compiled with the former kernels


if __name__ == "__main__":
    main()
