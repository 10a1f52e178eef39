"""Derive the half-space stress kernels from the Boussinesq-Cerruti potentials.

`kernel_writer` turns the result into `trackroller/halfspace/kernels.py`.

With Omega = z ln(R + z) - R, R = sqrt(x^2 + y^2 + z^2) (eq. (2) of the paper, point load at the origin) the
displacements of the half-space z >= 0 under tractions q = (q_x, q_y, q_z) acting on the body are, with
Q_i = q_i Omega and psi_1 = dQ_x/dx + dQ_y/dy + dQ_z/dz (Johnson 1985, sec. 3.2; eq. (5) is the x component),

    4 pi G u_x = 2 d2Q_x/dz2 - d2Q_z/dxdz + 2 nu dpsi_1/dx - z d2psi_1/dxdz
    4 pi G u_y = 2 d2Q_y/dz2 - d2Q_z/dydz + 2 nu dpsi_1/dy - z d2psi_1/dydz
    4 pi G u_z =   d2Q_z/dz2 + (1 - 2 nu) dpsi_1/dz - z d2psi_1/dz2

and Hooke's law, eq. (4), gives 2 pi sigma = sym grad (4 pi G u) + 2 nu d2psi_1/dz2 1 once the dilatation is
known to be div (4 pi G u) = 2 (1 - 2 nu) d2psi_1/dz2. `check_dilatation` proves this relation, so that nu = 0.5 is
regular. E cancels, and every component is A + nu B.

Bilinear loads follow from the antiderivative of Omega. `double_antiderivative` finds W with d4W/dx2dy2 = Omega for
tractions interpolated bilinearly: their stresses are sums over corners of one function, weighted with second
differences of the nodal tractions. All functions used are smooth for z > 0 and have their right limits at z = 0.

The algebra runs in a polynomial ring over the rationals in x, y, z, R, 1/R, 1/(R+z), 1/(x^2+z^2), 1/(y^2+z^2) and

    Lx = asinh(x / sqrt(y^2+z^2)),  Ly = asinh(y / sqrt(x^2+z^2)),  Lz = ln(R + z),
    Ax = atan(y/x) - atan(y z/(x R)) = atan2(x y (R-z), x^2 R + y^2 z),  Ay the same with x and y exchanged,

each with its known partial derivatives (a differential ring). The algebra is exact and takes a second.
"""

from __future__ import annotations

from functools import cache
from math import gcd
from typing import Any

from sympy import QQ
from sympy.polys.matrices import DomainMatrix
from sympy.polys.rings import ring

COMPONENTS = ("xx", "yy", "zz", "xy", "yz", "xz")
LOADS = ("x", "y", "z")
KERNELS = {"point_kernel": 0, "bilinear_corner": 2}  # differences of each function over the corners of a load

_RING, x, y, z, R, iR, iS, iP, iQ, Lx, Ly, Lz, Ax, Ay = ring("x y z R iR iS iP iQ Lx Ly Lz Ax Ay", QQ)
_X, _Y, _Z, _R, _IR, _IS, _IP, _IQ = range(8)
Element = Any  # sympy's PolyElement has no useful static type

_DERIVATIVES: dict[str, dict[Element, Element]] = {
    "x": {
        x: _RING(1),
        R: x * iR,
        iR: -x * iR**3,
        iS: -x * iR * iS**2,
        iP: -2 * x * iP**2,
        Lx: iR,
        Ly: -x * y * iR * iP,
        Lz: x * iR * iS,
        Ax: -y * iR * iS + y * z * iR * iP,
        Ay: y * iR * iS,
    },
    "z": {
        z: _RING(1),
        R: z * iR,
        iR: -z * iR**3,
        iS: -iR * iS,
        iP: -2 * z * iP**2,
        iQ: -2 * z * iQ**2,
        Lz: iR,
        Lx: -x * z * iR * iQ,
        Ly: -y * z * iR * iP,
        Ax: -x * y * iR * iP,
        Ay: -x * y * iR * iQ,
    },
}
_EXCHANGED = list(zip((x, y, iP, iQ, Lx, Ly, Ax, Ay), (y, x, iQ, iP, Ly, Lx, Ay, Ax), strict=True))
_DERIVATIVES["y"] = {f.compose(_EXCHANGED): df.compose(_EXCHANGED) for f, df in _DERIVATIVES["x"].items()}

# Rewriting rules (factors to find, replacement), applied in this order as long as one of them applies.
_RULES: list[tuple[dict[int, int], Element]] = [
    ({_R: 1, _IR: 1}, _RING(1)),
    ({_R: 2}, x**2 + y**2 + z**2),
    ({_R: 1, _IS: 1}, 1 - z * iS),
    ({_IP: 1, _X: 2}, 1 - z**2 * iP),
    ({_IQ: 1, _Y: 2}, 1 - z**2 * iQ),
    ({_IP: 1, _IR: 1, _Y: 2}, R * iP - iR),
    ({_IQ: 1, _IR: 1, _X: 2}, R * iQ - iR),
    ({_IR: 1, _IS: 1, _Z: 1}, iR - iS),
    ({_IS: 1, _X: 2}, R - z - y**2 * iS),
    ({_IR: 1, _X: 2}, R - y**2 * iR - z**2 * iR),
]


def _rule_for(monomial: tuple[int, ...]) -> tuple[dict[int, int], Element] | None:
    for factors, replacement in _RULES:
        if all(monomial[i] >= k for i, k in factors.items()):
            return factors, replacement
    return None


def normal_form(f: Element) -> Element:
    """Return the element with all relations of R, 1/R, 1/(R+z), ... applied, so that equal functions look equal."""
    done, todo = _RING(0), f
    while todo:
        nxt = _RING(0)
        for monomial, coefficient in todo.terms():
            rule = _rule_for(monomial)
            if rule is None:
                done += _RING.from_dict({monomial: coefficient})
                continue
            rest = list(monomial)
            for i, k in rule[0].items():
                rest[i] -= k
            nxt += _RING.from_dict({tuple(rest): coefficient}) * rule[1]
        todo = nxt
    return done


def derivative(f: Element, along: str) -> Element:
    """Return the partial derivative of `f` along each letter of `along`, in turn: `derivative(f, "xxz")`."""
    for letter in along:
        f = normal_form(sum((f.diff(g) * dg for g, dg in _DERIVATIVES[letter].items()), _RING(0)))
    return f


def omega() -> Element:
    """Return Omega = z ln(R + z) - R, eq. (2)."""
    return z * Lz - R


def _monomials(degree: int, parity_x: int, parity_y: int) -> list[Element]:
    return [
        x**i * y**j * z ** (degree - i - j)
        for i in range(parity_x, degree + 1, 2)
        for j in range(parity_y, degree + 1 - i, 2)
    ]


# Points with rational R, so that the equations for the coefficients are exact.
_QUADRUPLES = [
    (a, b, c, r)
    for r in range(3, 22)
    for a in range(1, r)
    for b in range(a, r)
    for c in range(b, r)
    if a * a + b * b + c * c == r * r and gcd(a, b, c) == 1
]


def _values_at(f: Element, point: tuple[int, int, int, int]) -> dict[tuple[int, ...], Any]:
    """Return the coefficients of the transcendental monomials of `f` at a point with rational R."""
    a, b, c, r = map(QQ, point)
    values = (a, b, c, r, 1 / r, 1 / (r + c), 1 / (a * a + c * c), 1 / (b * b + c * c))
    found: dict[tuple[int, ...], Any] = {}
    for monomial, coefficient in f.terms():
        for value, power in zip(values, monomial, strict=False):
            coefficient *= value**power
        key = monomial[len(values) :]
        found[key] = found.get(key, QQ(0)) + coefficient
    return found


@cache
def double_antiderivative() -> Element:
    """Return W with d4W/dx2dy2 = Omega, even in x and y and homogeneous of degree 5 except for the logarithm.

    Omega times four lengths consists of the listed terms only; their coefficients follow from linear equations over the
    rationals.

    Raises
    ------
    ArithmeticError : if the listed terms do not suffice
    """
    terms = (
        [R * m for m in _monomials(4, 0, 0)]
        + [Lx * m for m in _monomials(5, 1, 0)]
        + [Ly * m for m in _monomials(5, 0, 1)]
        + [Lz * m for m in _monomials(5, 0, 0)]
        + [Ax * m for m in _monomials(5, 1, 1)]
        + [Ay * m for m in _monomials(5, 1, 1)]
        + [x**2 * y**2 * z]
    )
    images = [derivative(t, "xxyy") for t in terms] + [omega()]
    rows = []
    for quadruple in _QUADRUPLES:
        a, b, c, r = quadruple
        for point in (quadruple, (c, a, b, r)):
            values = [_values_at(f, point) for f in images]
            rows += [[v.get(key, QQ(0)) for v in values] for key in sorted(set().union(*values))]
    reduced, pivots = DomainMatrix(rows, (len(rows), len(images)), QQ).rref()
    if pivots[-1] >= len(terms):
        raise ArithmeticError("Omega has no antiderivative of the assumed form")
    w = sum((reduced[i, len(terms)].element * terms[p] for i, p in enumerate(pivots)), _RING(0))
    if derivative(w, "xxyy") != normal_form(omega()):
        raise ArithmeticError("the antiderivative found does not give Omega back")
    return w


def displacements(potential: Element, load: str) -> tuple[dict[str, Element], dict[str, Element]]:
    """Return 4 pi G u for unit traction along `load`, as (A, B) with u = A + nu B, per component."""
    psi_1 = derivative(potential, load)
    psi = derivative(psi_1, "z")
    a, b = {}, {}
    for i in LOADS:
        a[i] = -z * derivative(psi, i)
        b[i] = 2 * derivative(psi_1, i)
        if load == i != "z":
            a[i] += 2 * derivative(potential, "zz")
        if load == "z":
            a[i] += derivative(potential, "zz") if i == "z" else -derivative(potential, "z" + i)
        if i == "z":
            a[i] += psi
            b[i] = -2 * psi
    return {i: normal_form(a[i]) for i in LOADS}, {i: normal_form(b[i]) for i in LOADS}


def check_dilatation(load: str) -> bool:
    """Return True if div(4 pi G u) = 2 (1 - 2 nu) d(psi)/dz for the point load: then nu/(1 - 2 nu) cancels."""
    a, b = displacements(omega(), load)
    psi_z = derivative(omega(), load + "zz")
    div_a = sum((derivative(a[i], i) for i in LOADS), _RING(0))
    div_b = sum((derivative(b[i], i) for i in LOADS), _RING(0))
    return normal_form(div_a - 2 * psi_z) == 0 and normal_form(div_b + 4 * psi_z) == 0


def stresses(potential: Element, load: str) -> tuple[list[Element], list[Element]]:
    """Return 2 pi sigma for unit traction along `load`, as (A, B) in the order of COMPONENTS."""
    a, b = displacements(potential, load)
    psi_z = derivative(potential, load + "zz")
    parts: tuple[list[Element], list[Element]] = ([], [])
    for pair in COMPONENTS:
        i, j = pair[0], pair[1]
        for part, u in zip(parts, (a, b), strict=True):
            part.append((derivative(u[i], j) + derivative(u[j], i)) / 2)
        if i == j:
            parts[1][-1] += 2 * psi_z
    return [normal_form(f) for f in parts[0]], [normal_form(f) for f in parts[1]]


def _without_polynomials(f: Element, differences: int) -> Element:
    """Drop polynomials of degree < `differences` in x or in y, which the corner differences cancel."""
    keep = {m: c for m, c in f.terms() if any(m[_R:]) or min(m[_X], m[_Y]) >= differences}
    return _RING.from_dict(keep)


@cache
def kernel_elements(name: str) -> tuple[Element, ...]:
    """Return the 36 elements of a kernel: A of the 18 (load, component) pairs, load slowest, then B."""
    potential = omega() if name == "point_kernel" else double_antiderivative()
    split = [stresses(potential, load) for load in LOADS]
    found = [f for part in (0, 1) for one in split for f in one[part]]
    differences = KERNELS[name]
    return tuple(_without_polynomials(f, differences) if differences else f for f in found)
