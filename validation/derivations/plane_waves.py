"""Derive the plane-wave stresses that `ellipse` and its kernels use from the potentials of eqs (1)-(5), with SymPy.

A traction that varies as exp(i k s) along a direction s has the potential function Omega -> 2 pi exp(-k z)/k^3 (since
d^2 Omega/dz^2 = 1/rho, whose transform is 2 pi exp(-k z)/k). The potentials then give the stresses of such a wave as
(A + B k z) exp(-k z) in the frame (s, t, z). `python -m validation.derivations.plane_waves` prints them.
"""

from __future__ import annotations

import functools

import sympy

COMPONENTS = ("ss", "tt", "zz", "st", "tz", "zs")


def _potential_stresses(potentials, space, poisson):
    """Return the stresses of half-space potentials F1, G1, H1 (Johnson 1985, eqs (3.1)-(3.9)) for unit 1/(4 pi G)."""
    s, t, z = space
    diff = sympy.diff
    f_1, g_1, h_1 = potentials
    psi_1 = diff(f_1, s) + diff(g_1, t) + diff(h_1, z)
    f, g, h, psi = (diff(v, z) for v in (f_1, g_1, h_1, psi_1))
    u = (
        2 * diff(f, z) - diff(h, s) + 2 * poisson * diff(psi_1, s) - z * diff(psi, s),
        2 * diff(g, z) - diff(h, t) + 2 * poisson * diff(psi_1, t) - z * diff(psi, t),
        diff(h, z) + (1 - 2 * poisson) * psi - z * diff(psi, z),
    )
    dilatation = sum(diff(u[i], space[i]) for i in range(3))
    out = {}
    for name in COMPONENTS:
        i, j = "stz".index(name[0]), "stz".index(name[1])
        strain = (diff(u[i], space[j]) + diff(u[j], space[i])) / 2
        volume = 2 * poisson / (1 - 2 * poisson) * dilatation if i == j else 0
        out[name] = (2 * strain + volume) / (4 * sympy.pi)
    return out


@functools.cache
def plane_wave_stress():
    """Return the stresses of unit traction waves exp(i k s) over exp(i k s - k z), as functions of k z and nu.

    Returns
    -------
    dict: load 's' | 't' | 'z' -> dict: component -> SymPy expression in `kz` and `nu`
    """
    s, t = sympy.symbols("s t", real=True)
    k, z = sympy.symbols("k z", positive=True)
    nu, kz = sympy.symbols("nu kz")
    wave = sympy.exp(sympy.I * k * s - k * z)
    omega = 2 * sympy.pi / k**3 * wave
    loads = {"s": (omega, 0 * omega, 0 * omega), "t": (0 * omega, omega, 0 * omega), "z": (0 * omega, 0 * omega, omega)}
    result = {}
    for load, potentials in loads.items():
        stresses = _potential_stresses(potentials, (s, t, z), nu)
        result[load] = {
            name: sympy.expand(sympy.simplify(value / wave)).subs(z, kz / k) for name, value in stresses.items()
        }
    return result


if __name__ == "__main__":
    for load, stresses in plane_wave_stress().items():
        print(load, {name: str(value) for name, value in stresses.items()})
