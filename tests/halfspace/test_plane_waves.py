"""The stress kernel of the sliding ellipse rests on what SymPy derives from the potentials."""

import numba
import numpy as np
import pytest

from trackroller.halfspace import ellipse
from trackroller.halfspace.ellipse import PATCH, PRESSURE, PRESSURE_NU, SHEAR, SHEAR_NU, Place
from trackroller.halfspace.kernels import point_kernel
from validation.derivations.plane_waves import plane_wave_stress

sum_waves, sum_rays = ellipse.sum_waves, ellipse.sum_rays


@numba.njit()
def wave(patch, place, work, out):
    sum_waves(patch, place, 1, work, out)


@numba.njit()
def ray(patch, place, rule, work, out):
    sum_rays(patch, None, place, 1, rule, work, np.empty(1, np.int32), out)


def scratch(**values):
    """Return a scratch array of the kernels with one entry a row."""
    work = np.zeros(ellipse.SCRATCH)
    for name, value in values.items():
        work[getattr(ellipse, name)] = value
    return work


ORDER = {"ss": 0, "tt": 1, "zz": 2, "st": 3, "tz": 4, "zs": 5}


@pytest.mark.slow
@pytest.mark.parametrize(
    "load, row, nu_row, direction",
    [("z", PRESSURE, PRESSURE_NU, (0.0, 0.0)), ("s", SHEAR, SHEAR_NU, (1.0, 0.0)), ("t", SHEAR, SHEAR_NU, (0.0, 1.0))],
)
def test_wave_kernel_is_the_derived_one(load, row, nu_row, direction):
    """One plane wave of the kernel equals A G - i lambda z B G' with A + B kz + nu ... as derived."""
    kz, nu = 0.37, 0.3
    # phi = 0 and a = 1: s = x, lambda = 1; z = 0.37 m; G and G' by their definition as integrals
    z, across = kz, 0.2
    zeta = complex(across, z)
    log = np.log((zeta - 1) / (zeta + 1))
    g, g_prime = np.pi * (2 + zeta * log), np.pi * (log + 2 * zeta / (zeta**2 - 1))
    out = np.zeros((4, 6))
    patch = np.zeros(1, PATCH)[0]
    patch["a"] = patch["b"] = patch["friction"] = 1.0
    wave(patch, Place(across, 0.0, z, *direction), scratch(ANGLE=0.0, WEIGHT=2 * np.pi**2), out)
    for name, expression in plane_wave_stress()[load].items():
        symbol = {str(s): s for s in expression.free_symbols}
        poly = expression.subs({symbol["nu"]: nu} if "nu" in symbol else {})
        constant = complex(poly.subs({symbol["kz"]: 0} if "kz" in symbol else {}))
        slope = complex(poly.diff(symbol["kz"])) if "kz" in symbol else 0.0
        derived = (constant * g + slope * (-1j) * z * g_prime).real
        found = out[row, ORDER[name]] + nu * out[nu_row, ORDER[name]]
        assert found == pytest.approx(derived, rel=1e-11, abs=1e-10), name


@pytest.mark.slow
def test_chord_kernel_is_the_point_kernel():
    """The radial functions of the friction integral equal the generated point kernel along and across the ray."""
    rng = np.random.default_rng(0)
    for _ in range(20):
        r, z = rng.uniform(0.01, 2, 2)
        # one node at distance r in direction +x, unit weight, unit traction along (x) or across (y)
        patch = np.zeros(1, PATCH)[0]
        patch["sine"], patch["cosine"], patch["radius"] = 1.0, 1e-9, 1e6  # the offset k0 alone gives slip along x
        for direction in (0, 1):
            k = point_kernel(-r, 0.0, z)
            a = np.array(k[6 * direction : 6 * direction + 6])
            b = np.array(k[18 + 6 * direction : 24 + 6 * direction])
            out = np.zeros((4, 6))
            d = np.array([-1.0, 0.0]) if direction == 0 else np.array([0.0, -1.0])
            patch["k0"] = 1e9  # slip far along -x: its direction is (+1, 0), subtracted below
            work = scratch(C=1.0, SPAN=2 * r, BEHIND=1.0, LENGTH=1.0, WEIGHT=r)
            ray(patch, Place(0.0, 0.0, z, 1.0 + d[0], d[1]), np.array([[0.5], [1.0]]), work, out)
            out /= 2 * np.pi * r * r * np.sqrt(r * (r + 1))  # the weight of the node
            kernel_order = [ORDER[name] for name in ("ss", "tt", "zz", "st", "tz", "zs")]
            np.testing.assert_allclose(out[SHEAR][kernel_order], a, rtol=1e-9, atol=1e-10)
            np.testing.assert_allclose(out[SHEAR_NU][kernel_order], b, rtol=1e-9, atol=1e-10)
