"""Cross-sections of guide and roller beside the nominal point of contact, and the gap between them.

Lateral coordinate u [mm] along the common tangent, 0 at the nominal point of contact, > 0 away from the middle of the
guide (outward). Heights [mm] are measured along the normal *out of the own body*: a convex circle of radius r has
height -u^2/(2 r) near the point, a groove the opposite. The gap of two bodies is minus the sum of their heights.

ASSUME: the bodies touch where the nominal contact angle says, whatever is drawn; drawn shapes change the gap around
that point, not the lever arms of the equilibrium.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

STEEPEST = 0.999  # sine of the inclination to the tangent plane up to which arcs are followed
# Tangent of 25 degrees: ASSUME what is more inclined to the contact plane takes no part in this contact; a half-space
# with one plane of contact could not tell what happens there.
CONTACT_SLOPE = 0.4663

SAFETY = 1.05  # on the noise found in points: too little smoothing hurts more than too much

Curve = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class CrossSection:
    """Height and slope of one body over the tangent plane, and where its material ends.

    height, slope : functions of u (any shape) [mm], [1]
    inner, outer : ends of the drawn shape, inner < 0 < outer [mm]; infinite where nothing ends it
    chamfer : radius of the rounding beyond these ends [mm], 0 for a sharp edge
    parabolic : Hertz's approximation: the inclination does not turn the curvature in the rolling direction
    """

    height: Curve
    slope: Curve
    inner: float = -np.inf
    outer: float = np.inf
    chamfer: float = 0.0
    parabolic: bool = False

    @cached_property
    def limits(self) -> tuple[float, float]:
        """Where there is no material any more, the rounding included, or it is too steep to touch [mm]."""
        return -self._reach(-1.0, -self.inner), self._reach(1.0, self.outer)

    def _reach(self, sign: float, end: float) -> float:
        far = min(end, 1e3)
        # closely near the contact, however far the material goes
        u = far * np.concatenate([np.geomspace(1e-4, 1.0, 400), np.linspace(0.0, 1.0, 400)[1:]])
        u.sort()
        steep = np.flatnonzero(np.abs(self.slope(sign * u)) > CONTACT_SLOPE)
        return float(u[steep[0]]) if steep.size else end + STEEPEST * self.chamfer

    def full_height(self, u: np.ndarray) -> np.ndarray:
        """Height with the rounded edges, shape of u."""
        inside = np.clip(u, self.inner, self.outer)
        beyond = np.abs(u - inside)
        if self.chamfer <= 0.0:
            return self.height(u)
        # the rounding goes on tangentially
        run = np.minimum(beyond, STEEPEST * self.chamfer)
        drop = run * run / (self.chamfer + np.sqrt(self.chamfer**2 - run * run))
        return self.height(inside) + self.slope(inside) * (u - inside) - drop


def parabola(radius: float) -> CrossSection:
    """Height -u^2/(2 r): the cross-section of Hertz's theory; radius > 0 convex, < 0 a groove [mm]."""
    curvature = 1.0 / radius
    return CrossSection(lambda u: -0.5 * curvature * u * u, lambda u: -curvature * u, parabolic=True)


def arcs(radii: Sequence[float], ends: Sequence[float]) -> CrossSection:
    """Circular arcs that follow one another tangentially, from the inside to the outside.

    Parameters
    ----------
    radii : of each arc, > 0 convex, < 0 concave, inf straight [mm]
    ends : u where each arc but the last gives way to the next, increasing [mm]

    The sine of the inclination is the integral of the curvature along u, hence linear on each arc.
    """
    kappa = 1.0 / np.asarray(radii, dtype=float)
    knots = np.asarray(ends, dtype=float)
    # both sides of u = 0, where height and slope are 0
    starts = np.unique(np.concatenate([knots, [0.0]]))
    order = np.searchsorted(knots, starts, side="right")
    zero = int(np.searchsorted(starts, 0.0))
    sine, height = np.zeros(starts.size), np.zeros(starts.size)

    def onward(s, z, step, curvature):
        to = np.clip(s + step * curvature, -STEEPEST, STEEPEST)
        cosines = np.sqrt(1 - s * s) + np.sqrt(1 - to * to)
        return to, z - step * (s + to) / cosines

    for k in range(zero + 1, starts.size):
        sine[k], height[k] = onward(sine[k - 1], height[k - 1], starts[k] - starts[k - 1], kappa[order[k - 1]])
    for k in range(zero - 1, -1, -1):
        sine[k], height[k] = onward(sine[k + 1], height[k + 1], starts[k] - starts[k + 1], kappa[order[k]])

    def piece(u):
        k = np.searchsorted(starts, u, side="right") - 1
        curvature = kappa[np.where(k < 0, 0, order[np.maximum(k, 0)])]
        k = np.maximum(k, 0)
        return onward(sine[k], height[k], u - starts[k], curvature)

    def slope(u):
        s, _ = piece(np.asarray(u, float))
        return -s / np.sqrt(1 - s * s)

    inner, outer = _steep_ends(starts, sine, kappa, order)
    return CrossSection(lambda u: piece(np.asarray(u, float))[1], slope, inner, outer)


def _steep_ends(starts, sine, kappa, order) -> tuple[float, float]:
    """Where the arcs become as steep as STEEPEST, within their first and last piece."""

    def reach(s, curvature, sign):
        if curvature == 0.0:
            return np.inf
        target = STEEPEST if curvature * sign > 0 else -STEEPEST
        return abs((target - s) / curvature)

    first, last = kappa[0], kappa[order[-1]]
    return starts[0] - reach(sine[0], first, -1.0), starts[-1] + reach(sine[-1], last, 1.0)


def drawn(u: np.ndarray, height: np.ndarray, noise: float | str = 0.0) -> CrossSection:
    """Cubic spline through points, or smoothed as far as their noise allows; height 0 at u = 0.

    Parameters
    ----------
    u, height : points, u strictly increasing, at least 5 [mm]
    noise : standard deviation of the heights' measuring noise [mm]: the smoothest natural cubic spline whose
        deviation from the points is that (Reinsch 1967); 'auto': with the noise that `noise_of` finds; 0: through every
        point, whose scatter then counts as shape
    """
    spline = smoothed(u, height, noise)
    slope, zero = spline.derivative(), float(spline(0.0))
    return CrossSection(lambda v: spline(v) - zero, lambda v: slope(v), float(u[0]), float(u[-1]))


def smoothed(u: np.ndarray, height: np.ndarray, noise: float | str):
    """The spline of `drawn`."""
    from scipy.interpolate import CubicSpline, make_smoothing_spline
    from scipy.optimize import brentq

    if noise == "auto":
        noise = noise_of(u, height)
    if noise == 0.0:
        return CubicSpline(u, height)
    unit = (u[-1] - u[0]) ** 3 / u.size

    def excess(log_weight: float) -> float:
        deviation = height - make_smoothing_spline(u, height, lam=unit * 10.0**log_weight)(u)
        return float(np.sqrt(np.mean(deviation**2)) / float(noise) - 1.0)

    low, high = -12.0, 6.0
    if excess(high) <= 0.0:  # a straight line is within the noise
        return make_smoothing_spline(u, height, lam=unit * 10.0**high)
    if excess(low) >= 0.0:
        return make_smoothing_spline(u, height, lam=unit * 10.0**low)
    return make_smoothing_spline(u, height, lam=unit * 10.0 ** brentq(excess, low, high, xtol=1e-6))


def noise_of(u: np.ndarray, height: np.ndarray) -> float:
    """Standard deviation of the heights' noise [mm], from what no cubic through five neighbours can follow.

    Arcs and parabolas leave next to nothing there, kinks and steps few large values, which do not count. Noise that
    neighbours share is not seen. Generalised cross-validation (Craven & Wahba 1979) takes more of it for shape.
    """
    count = u.size - 4
    near = np.stack([u[k : k + count] for k in range(5)])
    apart = near[:, None] - near[None] + np.eye(5)[:, :, None]
    weights = 1.0 / apart.prod(axis=1)
    weights /= np.sqrt((weights**2).sum(axis=0))
    left = np.abs(sum(weights[k] * height[k : k + count] for k in range(5)))
    found = 1.4826 * float(np.median(left))
    for _ in range(3):
        kept = left[left <= 3.0 * found]
        found = float(np.sqrt(np.mean(kept**2))) / 0.9866 if kept.size else found
    return SAFETY * found


def with_edges(section: CrossSection, inner: float, outer: float, chamfer: float = 0.0) -> CrossSection:
    """The cross-section cut at `inner` < 0 < `outer` where it reaches so far, its edges rounded with `chamfer`."""
    return CrossSection(
        section.height, section.slope, max(section.inner, inner), min(section.outer, outer), chamfer, section.parabolic
    )


@dataclass(frozen=True)
class Gap:
    """Gap of the undeformed bodies over the contact plane: g(x, y) = g_0(x) + k_y(x) y^2 / 2 [mm].

    guide, roller : cross-sections; alpha : contact angle [rad]; rolling_radius r_A and guide_curve_radius r_Curve of
    the nominal point [mm]. The curvature in the rolling direction is that of two bodies of revolution at each x:
    k_y = cos(inclination)/(r_A + x sin(alpha)) + cos(inclination)/(r_Curve - x sin(alpha)); for two parabolas
    it is the one of the nominal point, so that the problem is that of Hertz.
    """

    guide: CrossSection
    roller: CrossSection
    alpha: float
    rolling_radius: float
    guide_curve_radius: float

    @cached_property
    def limits(self) -> tuple[float, float]:
        """Where either body ends [mm]."""
        (a, b), (c, d) = self.guide.limits, self.roller.limits
        return max(a, c), min(b, d)

    @property
    def is_rounded(self) -> bool:
        """Has either body a rounded edge?"""
        return max(self.guide.chamfer, self.roller.chamfer) > 0.0

    def lateral(self, x: np.ndarray) -> np.ndarray:
        """g_0(x) [mm]."""
        return -(self.guide.full_height(x) + self.roller.full_height(x))

    def curvature(self, x: np.ndarray) -> np.ndarray:
        """k_y(x) [1/mm]."""
        s, c = np.sin(self.alpha), np.cos(self.alpha)
        if self.guide.parabolic and self.roller.parabolic:
            return np.full(np.shape(x), c / self.rolling_radius + c / self.guide_curve_radius)
        # outward, the roller's flank (height > 0 towards the guide) and the guide's turn with their slopes
        roller = (c - s * self.roller.slope(x)) / (self.rolling_radius + x * s)
        return roller + (c + s * self.guide.slope(x)) / (self.guide_curve_radius - x * s)

    def field(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """g at the points x (nx,), y (ny,), shape (ny, nx) [mm]."""
        return self.lateral(x)[None, :] + 0.5 * self.curvature(x)[None, :] * (y * y)[:, None]
