"""The stress kernel of the sliding ellipse rests on what SymPy derives from the potentials."""

import numpy as np
import pytest

from trackroller.halfspace.ellipse import NO_FIELD, PRESSURE, PRESSURE_NU, SHEAR, SHEAR_NU, _half_chord, _one_wave
from trackroller.halfspace.kernels import point_kernel
from trackroller.halfspace.plane_waves import plane_wave_stress

ORDER = {"ss": 0, "tt": 1, "zz": 2, "st": 3, "tz": 4, "zs": 5}


@pytest.mark.parametrize("load, row, nu_row, direction", [("z", PRESSURE, PRESSURE_NU, (0.0, 0.0)),
                                                          ("s", SHEAR, SHEAR_NU, (1.0, 0.0)),
                                                          ("t", SHEAR, SHEAR_NU, (0.0, 1.0))])  # fmt: skip
def test_wave_kernel_is_the_derived_one(load, row, nu_row, direction):
    """One plane wave of the kernel equals A G - i lambda z B G' with A + B kz + nu ... as derived."""
    kz, nu = 0.37, 0.3
    # phi = 0 and a = 1: s = x, lambda = 1; z = 0.37 m; G and G' by their definition as integrals
    z, across = kz, 0.2
    zeta = complex(across, z)
    log = np.log((zeta - 1) / (zeta + 1))
    g, g_prime = np.pi * (2 + zeta * log), np.pi * (log + 2 * zeta / (zeta**2 - 1))
    out = np.zeros((4, 6))
    _one_wave(1.0, 1.0, across, 0.0, z, 0.0, 2 * np.pi**2, 1.0, *direction, out)
    for name, expression in plane_wave_stress()[load].items():
        symbol = {str(s): s for s in expression.free_symbols}
        poly = expression.subs({symbol["nu"]: nu} if "nu" in symbol else {})
        constant = complex(poly.subs({symbol["kz"]: 0} if "kz" in symbol else {}))
        slope = complex(poly.diff(symbol["kz"])) if "kz" in symbol else 0.0
        derived = (constant * g + slope * (-1j) * z * g_prime).real
        found = out[row, ORDER[name]] + nu * out[nu_row, ORDER[name]]
        assert found == pytest.approx(derived, rel=1e-12, abs=1e-10), name


def test_chord_kernel_is_the_point_kernel():
    """The radial functions of the friction integral equal the generated point kernel along and across the ray."""
    rng = np.random.default_rng(0)
    for _ in range(20):
        r, z = rng.uniform(0.01, 2, 2)
        # one node at distance r in direction +x, unit weight, unit traction along (x) or across (y)
        patch = np.zeros(12)
        patch[3], patch[4], patch[5] = 1.0, 1e-9, 1e6  # slip along x only where the offset K0 says so
        for direction in (0, 1):
            k = point_kernel(-r, 0.0, z)
            a = np.array(k[6 * direction : 6 * direction + 6])
            b = np.array(k[18 + 6 * direction : 24 + 6 * direction])
            sums = np.zeros(6)
            d = np.array([-1.0, 0.0]) if direction == 0 else np.array([0.0, -1.0])
            patch[9] = 1e9  # slip far along -x: its direction is (+1, 0), subtracted below
            _half_chord(patch, NO_FIELD, 0.0, 0.0, z, 1.0, 0.0, -1.0, 2 * r, 0.0, r, 1.0 + d[0], d[1],
                        np.array([1.0]), np.array([1.0]), sums)  # fmt: skip
            ee, ee_nu, tt, zz, et, ez = sums / (2 * np.pi * r * r * np.sqrt(r * (r + 1)))  # over the weight of the node
            expected = {"ee": a[0], "tt": a[1], "zz": a[2], "et": a[3], "ez": a[5]}
            for name, value in zip(("ee", "tt", "zz", "et", "ez"), (ee + ee_nu, tt, zz, et, ez), strict=True):
                assert value == pytest.approx(expected[name], rel=1e-9, abs=1e-10), name
            assert -2 * ee_nu == pytest.approx(b[0], rel=1e-9, abs=1e-12)
