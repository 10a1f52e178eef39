"""Hold a block of cases on its way through the stages: inputs (`Scene`) and results (`StageResults`).

Arrays have the case as first axis (n,), then contact (2) and body (2: roller, guide). Flat arrays (2 n,) hold contact 1
of all cases, then contact 2.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from trackroller.contact.protocol import ContactModel
from trackroller.contact.quantities import Patch, Resultants, SurfaceTractions
from trackroller.contact.slip import Slip
from trackroller.roller import equilibrium as eq
from trackroller.roller.case import CaseTable
from trackroller.roller.dataset import VARIABLES, validity_bit
from trackroller.roller.distinct_contacts import Mirror

JAMMING = validity_bit("jamming")
_LENGTHS = {"mm": 1, "mm2": 2, "N": 2, "J m-1": 2, "N mm": 3}  # N = MPa mm2, J m-1 = N
POWER = {v.name: _LENGTHS[v.units] for v in VARIABLES.values() if v.units in _LENGTHS}  # of the unit of length


@dataclass(frozen=True)
class Scene:
    """A block of n cases with the quantities that follow from geometry and material alone.

    Attributes
    ----------
    table, loads, model : the cases, the input of the equilibrium, and the contact model
    unit : unit of length in which each roller is solved, (n,) [mm]. In the loads, the patches and all results of the
        stages, mm stands for this unit and N for MPa unit^2, until `StageResults.in_mm`
    mirror : marks rollers whose two contacts are mirror images
    frictionless : True if all cases have zero friction, so that no tractions are computed
    n : number of cases
    turning : turning of the rollers with the guide's curve, (n,) [1/mm]; None if it does not count
    inclined : turning of the contact normals towards +x_C by wear, (n, 2) [rad]; None without wear
    """

    table: CaseTable
    loads: eq.RollerLoads
    model: ContactModel
    unit: np.ndarray
    mirror: Mirror
    frictionless: bool
    n: int
    turning: np.ndarray | None = None
    inclined: np.ndarray | None = None

    def kinematics(self, slip: Slip, rows: np.ndarray) -> Slip:
        """Return the slip with the turning of the rollers `rows`, if the turning counts."""
        if self.turning is None:
            return slip
        return replace(slip, turning=self.turning[rows])

    def contacts(self, balance: eq.Equilibrium) -> tuple[Patch, Slip]:
        """Return the ellipses and the slip of both contacts in an equilibrium, arrays (2 n,)."""
        both = np.tile(np.arange(self.n), 2)
        ellipse, slip = self.loads.contacts(balance.normal_force.T.reshape(-1), np.tile(balance.shift, 2), both)
        return ellipse, self.kinematics(slip, both)

    def law(self, patch: Patch, slip: Slip, friction: np.ndarray, rows: np.ndarray, fine: bool) -> Resultants:
        """Return the resultants on the roller; this is the contact law of the equilibrium."""
        resultants = self.model.law(patch, self.kinematics(slip, rows), friction, rows, fine)
        if self.inclined is None:
            return resultants
        # the pressure of a worn patch has a lateral part
        lateral = patch.normal_force * self.inclined[rows, (slip.sine < 0).astype(int)]
        return replace(resultants, lateral_force=resultants.lateral_force + lateral)


@dataclass
class StageResults:
    """Quantities found so far for one block.

    Attributes
    ----------
    scene, balance : input and result of the equilibrium
    regime, converged : of each case, (n,)
    patch, slip, friction : of both contacts, arrays (2 n,)
    good : True for patches that exist, (2 n,)
    bits : validity flags, (n,)
    stopped : True where the condition of `stop_if` holds, (n,)
    values : results by name, arrays with the case as first axis
    surface : tractions of the existing patches, once computed
    share : traction of the existing patches over its bound, once computed
    refined : True for patches whose peak was searched on twice the elements, (2 n,)
    """

    scene: Scene
    balance: eq.Equilibrium
    regime: np.ndarray
    converged: np.ndarray
    patch: Patch
    slip: Slip
    friction: np.ndarray
    good: np.ndarray
    bits: np.ndarray
    stopped: np.ndarray
    values: dict[str, np.ndarray] = field(default_factory=dict)
    surface: SurfaceTractions | None = None
    share: np.ndarray | None = None
    refined: np.ndarray = field(default_factory=lambda: np.zeros(0, bool))

    @classmethod
    def start(cls, scene: Scene, balance: eq.Equilibrium) -> StageResults:
        """Make patches and slips from the normal forces and rolling radius shifts of the equilibrium."""
        both = np.tile(np.arange(scene.n), 2)
        ellipse, slip = scene.contacts(balance)
        friction = scene.loads.friction * np.where(balance.regime == eq.FULL_SLIP, scene.loads.at_high_speed, 1.0)
        patch = scene.model.settled(ellipse, slip, friction[both], both)
        # the friction law of each patch has to hold beside the balance of the roller
        unmet, met = scene.model.state(scene.n)
        rolls = balance.regime == eq.ROLLING
        out = cls(
            scene,
            balance,
            balance.regime,
            balance.converged & (met | ~rolls),
            patch,
            slip,
            friction[both],
            np.isfinite(balance.normal_force.T.reshape(-1)),
            np.where(balance.jamming, JAMMING, 0).astype(np.int32),
            np.zeros(scene.n, bool),
            refined=np.zeros(2 * scene.n, bool),
        )
        out.values["residual"] = np.where(rolls, np.fmax(balance.residual, unmet), balance.residual)
        return out

    def by_contact(self, flat: np.ndarray) -> np.ndarray:
        """Return flat values (2 n, ...) as (n, 2, ...)."""
        return flat.reshape(2, self.scene.n, *flat.shape[1:]).swapaxes(0, 1)

    @property
    def rows(self) -> np.ndarray:
        """Return the number of the roller to which each patch belongs, (2 n,)."""
        return np.tile(np.arange(self.scene.n), 2)

    @property
    def slides_along(self) -> np.ndarray:
        """Return the direction of the traction along y_C in full slip, and 0 in rolling, (2 n,)."""
        along = np.where(self.regime == eq.FULL_SLIP, -np.sign(self.scene.loads.motor_force), 0.0)
        return np.concatenate([along, along])

    def in_mm(self, name: str) -> np.ndarray:
        """Return the result `name` in N and mm, (n, ...)."""
        values = self.values[name]
        power = POWER.get(name, 0)
        if power:
            return values * self.scene.unit.reshape(-1, *(1,) * (values.ndim - 1)) ** power
        return values

    def full(self, flat_good: np.ndarray) -> np.ndarray:
        """Return values of the existing patches for all patches, NaN for the others, shape (n, 2, ...)."""
        out = np.full((2 * self.scene.n, *flat_good.shape[1:]), np.nan)
        out[self.good] = flat_good
        return self.by_contact(out)

    def of(self, patches: np.ndarray) -> tuple[Patch, Slip, np.ndarray, np.ndarray]:
        """Return patch, slip, friction and roller numbers of the patches `patches`, as contact models take them."""
        return self.patch.take(patches), self.slip.take(patches), self.friction[patches], self.rows[patches]

    def flag(self, name: str, condition: np.ndarray) -> None:
        """Set the validity flag `name` where the condition (n,) holds."""
        self.bits |= np.where(condition, validity_bit(name), 0).astype(np.int32)


def surface_tractions(results: StageResults) -> SurfaceTractions:
    """Return the tractions of the existing patches on a grid; they are computed at the first call."""
    if results.surface is None:
        good = results.good
        mirror = results.scene.mirror
        solved = mirror.to_solve(good)
        patch, slip, friction, rows = results.of(solved)
        rolling = replace(slip, shift=np.where(results.slides_along[solved] == 0, slip.shift, 0.0))
        # in full slip the tractions are known; without friction the model has nothing to solve
        rubs = np.where(results.slides_along[solved] == 0, friction, 0.0)
        t = mirror.spread_surface(good, results.scene.model.surface(patch, rolling, rubs, rows))
        mu = results.friction[good]
        along = results.slides_along[good]
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
