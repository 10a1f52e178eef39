"""Cross-sections of guide and roller beside the nominal point of contact, and the gap between them.

Lateral coordinate u [mm] along the common tangent, 0 at the nominal point of contact, > 0 away from
the middle of the guide (outward). Heights [mm] are measured along the outward normal of each body:
a convex circle of radius r has the height -u^2/(2 r) near the point, and a groove has +u^2/(2 r).
The gap of two bodies is minus the sum of their heights.

ASSUME: the bodies touch at the nominal contact angle for every drawn shape; drawn shapes change the
gap around that point, not the lever arms of the equilibrium.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from trackroller.contact.measured_points import noise_of

STEEPEST = 0.999  # largest sine of the inclination to the tangent plane at which arcs are followed
# Tangent of 25 degrees. ASSUME: a surface with a larger inclination to the contact plane takes no
# part in this contact; a half-space with one plane of contact does not describe it.
CONTACT_SLOPE = 0.4663

# ASSUME: a surface nearer to its axis of revolution than 5 % of the radius takes no part
BEFORE_AXIS = 0.95

Curve = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class CrossSection:
    """Height and slope of one body over the tangent plane, and the ends of its material.

    Attributes
    ----------
    height, slope : callable
        Functions of u (any shape) [mm], [1].
    inner, outer : float
        Ends of the drawn shape, inner < 0 < outer [mm]; infinite without an edge.
    chamfer : float
        Radius of the rounding beyond these ends [mm], 0 for a sharp edge.
    parabolic : bool
        True for Hertz's approximation, in which the inclination does not change the curvature in
        the rolling direction.
    """

    height: Curve
    slope: Curve
    inner: float = -np.inf
    outer: float = np.inf
    chamfer: float = 0.0
    parabolic: bool = False

    @cached_property
    def limits(self) -> tuple[float, float]:
        """Return the ends of the usable shape [mm]: of the material with its rounding, or of slopes
        that can touch.
        """
        return -self._reach(-1.0, -self.inner), self._reach(1.0, self.outer)

    def _reach(self, sign: float, end: float) -> float:
        far = min(end, 1e3)
        # The samples are dense near the contact for every width of the material.
        u = far * np.concatenate([np.geomspace(1e-4, 1.0, 400), np.linspace(0.0, 1.0, 400)[1:]])
        u.sort()
        steep = np.flatnonzero(np.abs(self.slope(sign * u)) > CONTACT_SLOPE)
        return float(u[steep[0]]) if steep.size else end + STEEPEST * self.chamfer

    def full_height(self, u: np.ndarray) -> np.ndarray:
        """Return the height with the rounded edges at u (any shape) [mm]."""
        inside = np.clip(u, self.inner, self.outer)
        beyond = np.abs(u - inside)
        if self.chamfer <= 0.0:
            return self.height(u)
        # the rounding continues the shape tangentially
        run = np.minimum(beyond, STEEPEST * self.chamfer)
        drop = run * run / (self.chamfer + np.sqrt(self.chamfer**2 - run * run))
        return self.height(inside) + self.slope(inside) * (u - inside) - drop


def parabola(radius: float) -> CrossSection:
    """Return the cross-section of Hertz's theory, height -u^2/(2 r); radius > 0 convex, < 0 a
    groove [mm].
    """
    curvature = 1.0 / radius
    return CrossSection(
        lambda u: -0.5 * curvature * u * u, lambda u: -curvature * u, parabolic=True
    )


def arcs(radii: Sequence[float], ends: Sequence[float]) -> CrossSection:
    """Return circular arcs that follow one another tangentially, from the inside to the outside.

    Parameters
    ----------
    radii : sequence of float
        Radius of each arc, > 0 convex, < 0 concave, inf straight [mm].
    ends : sequence of float
        u at the end of each arc except the last, increasing [mm].

    Notes
    -----
    The sine of the inclination is the integral of the curvature along u, so that it is linear on
    each arc.
    """
    kappa = 1.0 / np.asarray(radii, dtype=float)
    knots = np.asarray(ends, dtype=float)
    # pieces start on both sides of u = 0, where height and slope are 0
    starts = np.unique(np.concatenate([knots, [0.0]]))
    order = np.searchsorted(knots, starts, side="right")
    zero = int(np.searchsorted(starts, 0.0))
    sine, height = np.zeros(starts.size), np.zeros(starts.size)

    def onward(s, z, step, curvature):
        to = np.clip(s + step * curvature, -STEEPEST, STEEPEST)
        cosines = np.sqrt(1 - s * s) + np.sqrt(1 - to * to)
        return to, z - step * (s + to) / cosines

    for k in range(zero + 1, starts.size):
        sine[k], height[k] = onward(
            sine[k - 1], height[k - 1], starts[k] - starts[k - 1], kappa[order[k - 1]]
        )
    for k in range(zero - 1, -1, -1):
        sine[k], height[k] = onward(
            sine[k + 1], height[k + 1], starts[k] - starts[k + 1], kappa[order[k]]
        )

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
    """Return the u at which the first and the last arc become as steep as STEEPEST [mm]."""

    def reach(s, curvature, sign):
        if curvature == 0.0:
            return np.inf
        target = STEEPEST if curvature * sign > 0 else -STEEPEST
        return abs((target - s) / curvature)

    first, last = kappa[0], kappa[order[-1]]
    return starts[0] - reach(sine[0], first, -1.0), starts[-1] + reach(sine[-1], last, 1.0)


def drawn(u: np.ndarray, height: np.ndarray, noise: float | str = 0.0) -> CrossSection:
    """Return the cubic spline through points, or a spline smoothed within their noise; height 0 at
    u = 0.

    Parameters
    ----------
    u, height : numpy.ndarray, shape (n,)
        At least 5 points, u strictly increasing [mm].
    noise : float or str
        Standard deviation of the measuring noise of the heights [mm]. The result is the smoothest
        natural cubic spline with this deviation from the points (Reinsch 1967). 'auto' uses the
        noise that `noise_of` finds. With 0 the spline passes through every point, so that scatter
        counts as shape.
    """
    spline = smoothed(u, height, noise)
    slope, zero = spline.derivative(), float(spline(0.0))
    return CrossSection(lambda v: spline(v) - zero, lambda v: slope(v), float(u[0]), float(u[-1]))


def smoothed(u: np.ndarray, height: np.ndarray, noise: float | str):
    """Return the spline of `drawn`."""
    # heavy, and for drawn profiles only
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


def worn(
    section: CrossSection, start: float, step: float, depth: np.ndarray, moved: float = 0.0
) -> CrossSection:
    """Return the cross-section after wear: its height less the depth that was worn off.

    Parameters
    ----------
    section : CrossSection
        The new body.
    start, step : float
        u in the middle of the first cell of the depth and width of the cells [mm].
    depth : numpy.ndarray, shape (m,)
        Mean depth of each cell, normal to the contact plane [mm]; 0 beyond the cells.
    moved : float
        Distance by which the body has moved outward along the contact plane [mm].
    """
    from scipy.interpolate import PchipInterpolator  # heavy, and for drawn profiles only

    u = start + step * np.arange(-1, depth.size + 1)
    with np.errstate(over="ignore"):  # a slope that underflows counts as zero
        # it does not swing beyond its points
        curve = PchipInterpolator(u, np.concatenate([[0.0], depth, [0.0]]))
    rise = curve.derivative()

    def height(v: np.ndarray) -> np.ndarray:
        return section.height(v - moved) - curve(np.clip(v - moved, u[0], u[-1]))

    def slope(v: np.ndarray) -> np.ndarray:
        return section.slope(v - moved) - rise(np.clip(v - moved, u[0], u[-1]))

    inner, outer = section.inner + moved, section.outer + moved
    return CrossSection(height, slope, inner, outer, section.chamfer, section.parabolic)


def with_edges(
    section: CrossSection, inner: float, outer: float, chamfer: float = 0.0
) -> CrossSection:
    """Return the cross-section cut at `inner` < 0 < `outer` with edges of the radius `chamfer`
    [mm].
    """
    return CrossSection(
        section.height,
        section.slope,
        max(section.inner, inner),
        min(section.outer, outer),
        chamfer,
        section.parabolic,
    )


@dataclass(frozen=True)
class Gap:
    """Gap of the undeformed bodies over the contact plane: g(x, y) = g_0(x) + k_y(x) y^2 / 2 [mm].

    The curvature in the rolling direction is that of two bodies of revolution at each x: k_y =
    cos(inclination)/(r_A + x sin(alpha)) + cos(inclination)/(r_Curve - x sin(alpha)). For two
    parabolas it has its value at the nominal point for all x, so that the problem is that of Hertz.

    Attributes
    ----------
    guide, roller : CrossSection
        Cross-sections of the two bodies.
    alpha : float
        Contact angle [rad].
    rolling_radius, guide_curve_radius : float
        r_A and r_Curve of the nominal point [mm].
    """

    guide: CrossSection
    roller: CrossSection
    alpha: float
    rolling_radius: float
    guide_curve_radius: float

    @property
    def _parabolic(self) -> bool:
        """Return whether both profiles are parabolas, as Hertz assumes; such bodies have no axes of
        revolution.
        """
        return self.guide.parabolic and self.roller.parabolic

    @cached_property
    def limits(self) -> tuple[float, float]:
        """Return the first ends of the two bodies inward and outward [mm]; each ends before its
        axis, if it has one.
        """
        (a, b), (c, d) = self.guide.limits, self.roller.limits
        if self._parabolic:
            return max(a, c), min(b, d)
        sine, curve = np.sin(self.alpha) / BEFORE_AXIS, self.guide_curve_radius
        return max(a, c, -self.rolling_radius / sine), min(
            b, d, curve / sine if curve > 0.0 else np.inf
        )

    def lateral(self, x: np.ndarray) -> np.ndarray:
        """Return g_0(x) [mm]."""
        return -(self.guide.full_height(x) + self.roller.full_height(x))

    def curvature(self, x: np.ndarray) -> np.ndarray:
        """Return k_y(x) [1/mm]."""
        s, c = np.sin(self.alpha), np.cos(self.alpha)
        if self._parabolic:
            return np.full(np.shape(x), c / self.rolling_radius + c / self.guide_curve_radius)
        # counted outward, the slopes of both flanks change their inclination to the axes
        roller = (c - s * self.roller.slope(x)) / (self.rolling_radius + x * s)
        return roller + (c + s * self.guide.slope(x)) / (self.guide_curve_radius - x * s)

    def field(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Return g at the points x (nx,), y (ny,) [mm], (ny, nx)."""
        return self.lateral(x)[None, :] + 0.5 * self.curvature(x)[None, :] * (y * y)[:, None]
