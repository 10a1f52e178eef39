"""A block of cases on its way through the stages: what is given (`Scene`) and what has been found (`Results`).

Arrays have the case as first axis (n,), then contact (2) and body (2: roller, guide).
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from trackroller.contact.common import ContactModel, Ellipse, Resultants, Slip, SurfaceTractions
from trackroller.roller import equilibrium as eq
from trackroller.roller.case import CaseTable
from trackroller.roller.dataset import validity_bit
from trackroller.roller.requirements import Mirror

JAMMING = validity_bit("jamming")


@dataclass(frozen=True)
class Scene:
    """A block of cases with what follows from geometry and material alone."""

    table: CaseTable
    loads: eq.Loads
    model: ContactModel
    mirror: Mirror
    frictionless: bool  # none of the cases has friction: no tractions to look for
    n: int
    turning: np.ndarray | None = None  # of the rollers with the guide's curve [1/mm], (n,), if it counts

    def kinematics(self, slip: Slip, rows: np.ndarray) -> Slip:
        """The slip with the turning of the rollers `rows` in the curve, where that counts."""
        if self.turning is None:
            return slip
        return slip.detailed(turning=self.turning[rows])

    def law(self, ellipse: Ellipse, slip: Slip, friction: np.ndarray, rows: np.ndarray, fine: bool) -> Resultants:
        """The contact law of the equilibrium."""
        return self.model.law(ellipse, self.kinematics(slip, rows), friction, rows, fine)


@dataclass
class Results:
    """Quantities found so far for one block."""

    scene: Scene
    balance: eq.Equilibrium
    regime: np.ndarray
    converged: np.ndarray
    ellipse: Ellipse  # arrays (2 n,): contact 1 of all cases, then contact 2
    slip: Slip
    friction: np.ndarray
    good: np.ndarray  # (2 n,) patches that exist
    bits: np.ndarray
    stopped: np.ndarray  # (n,) the condition of stop_if holds
    values: dict[str, np.ndarray] = field(default_factory=dict)
    surface: SurfaceTractions | None = None  # of the existing patches, once asked for
    share: np.ndarray | None = None  # their traction over its bound, once asked for

    @classmethod
    def start(cls, scene: Scene, balance: eq.Equilibrium) -> Results:
        normal = balance.normal_force.T.reshape(-1)
        s = scene.loads.shape
        two = lambda v: np.concatenate([v, v])  # noqa: E731
        sine = np.sin(scene.loads.contact_angle)
        ellipse = type(s)(two(s.lateral), two(s.rolling), two(s.pressure)).at(normal)
        slip = Slip(
            np.concatenate([sine, -sine]),
            two(np.cos(scene.loads.contact_angle)),
            two(scene.loads.guide_profile_radius),
            two(scene.loads.rolling_radius),
            two(balance.shift),
        )
        slip = scene.kinematics(slip, np.tile(np.arange(scene.n), 2))
        friction = scene.loads.friction * np.where(balance.regime == eq.FULL_SLIP, scene.loads.at_high_speed, 1.0)
        ellipse = scene.model.settled(ellipse, slip, two(friction), np.tile(np.arange(scene.n), 2))
        # the friction law of each patch has to hold beside the balance of the roller
        unmet, met = scene.model.state(scene.n)
        rolls = balance.regime == eq.ROLLING
        converged = balance.converged & (met | ~rolls)
        out = cls(
            scene,
            balance,
            balance.regime,
            converged,
            ellipse,
            slip,
            two(friction),
            np.isfinite(normal),
            np.where(balance.jamming, JAMMING, 0).astype(np.int32),
            np.zeros(scene.n, bool),
        )
        out.values["residual"] = np.where(rolls, np.fmax(balance.residual, unmet), balance.residual)
        return out

    def by_contact(self, flat: np.ndarray) -> np.ndarray:
        """(2 n, ...) -> (n, 2, ...)."""
        return np.moveaxis(flat.reshape(2, self.scene.n, *flat.shape[1:]), 0, 1)

    @property
    def rows(self) -> np.ndarray:
        """The roller that each of the 2 n patches belongs to."""
        return np.tile(np.arange(self.scene.n), 2)

    @property
    def slides_along(self) -> np.ndarray:
        """Direction of the traction along y_C in full slip, 0 in rolling; shape (2 n,)."""
        along = np.where(self.regime == eq.FULL_SLIP, -np.sign(self.scene.loads.motor_force), 0.0)
        return np.concatenate([along, along])

    def full(self, flat_good: np.ndarray) -> np.ndarray:
        """Values of the existing patches spread to all, NaN elsewhere, shape (n, 2, ...)."""
        out = np.full((2 * self.scene.n, *flat_good.shape[1:]), np.nan)
        out[self.good] = flat_good
        return self.by_contact(out)


def surface_tractions(results: Results) -> SurfaceTractions:
    """Tractions of the existing patches on a grid, found once."""
    if results.surface is None:
        good, mirror = results.good, results.scene.mirror
        asked = mirror.asked(good)
        slip = results.slip.take(asked)
        rolling = replace(slip, shift=np.where(results.slides_along[asked] == 0, slip.shift, 0.0))
        t = mirror.spread_surface(
            good,
            results.scene.model.surface(
                results.ellipse.take(asked), rolling, results.friction[asked], results.rows[asked]
            ),
        )
        mu, along = results.friction[good], results.slides_along[good]
        full = (along != 0)[:, None, None]
        results.surface = replace(
            t,
            shear_lateral=np.where(full, 0.0, t.shear_lateral),
            shear_rolling=np.where(full, along[:, None, None] * mu[:, None, None] * t.pressure, t.shear_rolling),
            slip_lateral=np.where(full, np.nan, t.slip_lateral),
            slip_rolling=np.where(full, np.nan, t.slip_rolling),
            stick=t.stick & ~full,
        )
    return results.surface
