"""A material with its elastic constants and its S-N curve; each value has a unit, a source and a
mark.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, make_dataclass
from typing import Any

import numpy as np

from trackroller.damage.sn_curve import SNCurve, curve_exponent
from trackroller.errors import InputError
from trackroller.materials.energy_wear import FIELD as ENERGY_WEAR
from trackroller.materials.energy_wear import EnergyWear, read_energy_wear
from trackroller.materials.properties import OF_LIMITS, PROPERTIES, Value, check_number
from trackroller.materials.sn_curve import CURVE, POINTS, numbers_of_line, read_points
from trackroller.materials.temperature import FIELD, FOLLOW_STRENGTH, TemperatureTable, read_table

UNNAMED = "inline"  # name of a material that a case gives without one
LESS_IS_BETTER = ("loss_fraction", "wear_coefficient")
_OfLimits = make_dataclass(
    "_OfLimits", [(name, Any, field(default=None)) for name in OF_LIMITS], frozen=True, kw_only=True
)


def contradictions(values: Mapping[str, Any]) -> dict[str, str]:
    """Return the values of limits that are impossible beside R_m and sigma_D of a material, with
    what is allowed.

    Parameters
    ----------
    values : mapping
        Values of the material by name, `fatigue_limit` among them; None or nothing where a value is
        not given.
    """
    strength = values["tensile_strength"]
    limit = values["fatigue_limit"]
    out = {}
    if (values.get("yield_strength") or 0.0) > strength:
        out["yield_strength"] = f"it must not exceed R_m = {strength:g} MPa"
    for mark in ("surface_hardened", "sn_in_rolling"):
        if (values.get(mark) or 0.0) not in (0.0, 1.0):
            out[mark] = "it must be 0 or 1"
    torsion = values.get("fatigue_limit_torsion")
    if torsion is not None and not 0.5 < torsion / limit < 1.0:
        out["fatigue_limit_torsion"] = (
            f"it must lie between 0.5 and 1 times sigma_D = {limit:g} MPa, for Findley's and Dang "
            "Van's criteria"
        )
    return out


@dataclass(frozen=True)
class Material(_OfLimits):  # type: ignore[misc, valid-type]
    """A material whose S-N curve runs through (N_Rm, R_m) and (N_k, sigma_D), or through points of
    its own.

    Parameters
    ----------
    name : str
        Name of the material.
    youngs_modulus : float
        E > 0 [MPa].
    poisson_ratio : float
        nu from 0 to 0.5 [1].
    tensile_strength : float
        R_m [MPa].
    fatigue_strength_ratio : float
        sigma_D/R_m between 0 and 1 [1].
    cycles_at_tensile_strength, cycles_at_fatigue_limit : float
        N_Rm < N_k [1].
    family : str
        Group in the friction table: "metal", "PA6", "POM" or the user's own; "" if unknown.
    second_exponent : float, optional
        Exponent of the S-N curve below sigma_D [1]. None: `life_rule` decides.
    scatter_in_cycles : float, optional
        T_N = N_90/N_10 [1]; the index is the failure probability in percent. None: not known.
    scatter_in_stress : float, optional
        T_S = S_90/S_10 [1]. None: not known.
    sn_in_rolling : float, optional
        1 if the S-N curve is of tests in rolling contact; otherwise it counts as one of bending.
    description : str
        A short description.
    sn_points : sequence of pairs
        Points (stress [MPa], cycles [1]) of the S-N curve, straight in logarithms between them; the
        last one is the knee. They do not depend on R_m and replace sigma_D/R_m, N_Rm and N_k, which
        follow from them. Empty: none.
    temperature_dependence : TemperatureTable or mapping, optional
        E and R_m over temperature, for the output `heat`; see `trackroller.materials.temperature`.
    energy_wear : EnergyWear or mapping, optional
        Loss of mass over frictional work, for `wear_law: energy`; see
        `trackroller.materials.energy_wear`.
    records : mapping of str to Value
        Unit, source and mark of each value, as far as known.

    Other Parameters
    ----------------
    Values that the limits declare, such as `yield_strength`; see
    `trackroller.materials.properties`.

    Raises
    ------
    InputError
        If a value is wrong; the error names material, field, value and remedy.
    """

    name: str
    youngs_modulus: float
    poisson_ratio: float
    tensile_strength: float
    fatigue_strength_ratio: float
    cycles_at_tensile_strength: float
    cycles_at_fatigue_limit: float
    family: str = ""
    second_exponent: float | None = None
    scatter_in_cycles: float | None = None
    scatter_in_stress: float | None = None
    sn_in_rolling: float | None = None
    description: str = ""
    sn_points: tuple[tuple[float, float], ...] = ()
    temperature_dependence: Any = None
    energy_wear: Any = None
    records: Mapping[str, Value] = field(
        default_factory=dict, compare=False, repr=False, hash=False
    )

    def __post_init__(self) -> None:
        where = f"material '{self.name}'"
        for prop in PROPERTIES.values():
            value = getattr(self, prop.name)
            if (value is None and prop.allow_missing) or (self.sn_points and prop.name in CURVE):
                continue
            object.__setattr__(self, prop.name, check_number(prop, value, where))
        if self.sn_points:
            points = read_points(self.sn_points, where)
            for name, number in {
                POINTS: points,
                **numbers_of_line(points, self.tensile_strength),
            }.items():
                object.__setattr__(self, name, number)
        elif not self.cycles_at_tensile_strength < self.cycles_at_fatigue_limit:
            raise InputError(
                f"{where}.cycles_at_tensile_strength",
                self.cycles_at_tensile_strength,
                f"N_Rm below N_k = {self.cycles_at_fatigue_limit:g}",
                "Give the lower number of cycles to the tensile strength.",
            )

        for name, allowed in contradictions(
            vars(self) | {"fatigue_limit": self.fatigue_limit}
        ).items():
            raise InputError(f"{where}.{name}", getattr(self, name), allowed, "Correct the values.")
        if self.temperature_dependence is not None:
            object.__setattr__(
                self, FIELD, read_table(self.temperature_dependence, vars(self), where)
            )
        if self.energy_wear is not None:
            object.__setattr__(self, ENERGY_WEAR, read_energy_wear(self.energy_wear, where))

    @property
    def fatigue_limit(self) -> float:
        """Return the fatigue limit sigma_D [MPa] at N_k cycles."""
        if self.sn_points:
            return self.sn_points[-1][0]
        return self.fatigue_strength_ratio * self.tensile_strength

    @property
    def woehler_exponent(self) -> float:
        """Return the exponent k > 0 of the S-N curve [1], of the segment above the knee if it has
        several.
        """
        if self.sn_points:
            return float(SNCurve.of(self).exponent)
        cycles = self.cycles_at_fatigue_limit / self.cycles_at_tensile_strength
        return float(curve_exponent(cycles, 1.0 / self.fatigue_strength_ratio))

    @property
    def sn_line(self) -> tuple[tuple[float, float], ...]:
        """Return the points (stress [MPa], cycles [1]) that the S-N curve runs through, the last
        one its knee.
        """
        upper = (self.tensile_strength, self.cycles_at_tensile_strength)
        knee = self.cycles_at_fatigue_limit
        return self.sn_points or (upper, (self.fatigue_limit, knee))

    @property
    def shear_modulus(self) -> float:
        """Return the shear modulus G = E / (2 (1 + nu)) [MPa]."""
        return self.youngs_modulus / (2.0 * (1.0 + self.poisson_ratio))

    @property
    def placeholders(self) -> tuple[str, ...]:
        """Return the names of the values that are guesses without a source, those of single limits
        left out.
        """
        guessed = [
            name
            for name, record in self.records.items()
            if record.placeholder and name not in OF_LIMITS
        ]
        table: TemperatureTable | None = self.temperature_dependence
        if table is not None and table.placeholder:
            return (*guessed, FIELD)
        return tuple(guessed)

    @property
    def guesses_of_limits(self) -> dict[str, Value]:
        """Return the values of single limits that are guesses without a source, or that were
        measured on another material.
        """
        guesses = {
            name: own for name, own in self.records.items() if own.placeholder and name in OF_LIMITS
        }
        law: EnergyWear | None = self.energy_wear
        if law is not None and law.placeholder:
            guesses[ENERGY_WEAR] = Value(law.work_rate[-1], "-", law.source, True, law.note)
        return guesses

    @property
    def ends_of_limits(self) -> dict[str, tuple[float, float]]:
        """Return the worse and the better end of each placeholder of a limit that has a range, over
        its value.
        """
        values = {name: float(getattr(self, name)) for name in self._ends()}
        return {
            name: (worse / v, better / v)
            for name, (worse, better) in self._ends().items()
            if (v := values[name])
        }

    def _ends(self) -> dict[str, tuple[float, float]]:
        """Return the worse and the better end of each placeholder of a limit; one without a range
        has none.
        """
        ends = {}
        for name, record in self.records.items():
            if record.placeholder and record.range is not None and name in OF_LIMITS:
                low, high = record.range
                ends[name] = (low, high)
                if name in LESS_IS_BETTER:
                    ends[name] = (high, low)
        return ends

    def moved(self, position: float, fixed: Collection[str] = ()) -> Material:
        """Return the material with its placeholders of limits at another place in their ranges.

        Parameters
        ----------
        position : float
            -1 for the worse end of each range, 0 for the value, 1 for the better end; linear
            between them.
        fixed : collection of str
            Names of values that stay, because the user gave what replaces their range.

        Returns
        -------
        Material
            Values that are no placeholders, or that have no range, stay. The material itself for a
            position of 0.

        Notes
        -----
        ASSUME: more is better, but for loss and wear.
        """
        values: dict[str, Any] = {}
        for name, (worse, better) in self._ends().items():
            if name in fixed:
                continue
            value = self.records[name].value
            end = worse
            if position > 0:
                end = better
            values[name] = value + abs(position) * (end - value)
        if position:
            return dataclasses.replace(self, **values)
        return self

    def at(self, temperature: float) -> Material:
        """Return the material with the values of its table at a temperature [degC]; NaN leaves
        them.

        Notes
        -----
        ASSUME: fatigue limits, yield strength and hardness keep their ratio to R_m.
        """
        table: TemperatureTable | None = self.temperature_dependence
        if table is None or math.isnan(temperature):
            return self
        values: dict[str, Any] = {
            name: float(table.at(name, np.asarray(temperature))) for name in table.columns
        }
        share = values.get("tensile_strength", self.tensile_strength) / self.tensile_strength
        values |= {
            name: share * v for name in FOLLOW_STRENGTH if (v := getattr(self, name)) is not None
        }
        values[POINTS] = tuple((share * stress, cycles) for stress, cycles in self.sn_points)
        return dataclasses.replace(self, **values)

    def as_dict(self) -> dict[str, Any]:
        """Return plain numbers and texts, which a case accepts as a material."""
        values = {
            f.name: getattr(self, f.name) for f in dataclasses.fields(self) if f.name != "records"
        }
        if self.temperature_dependence is not None:
            values[FIELD] = self.temperature_dependence.as_dict()
        if self.energy_wear is not None:
            values[ENERGY_WEAR] = self.energy_wear.as_dict()
        return {key: value for key, value in values.items() if value not in (None, "", ())}

    def with_sources(self) -> dict[str, Any]:
        """Return `as_dict` with `sources` and `notes` of the values, and the names of those that
        are `guesses`.
        """
        return self.as_dict() | {
            "sources": {k: r.source for k, r in self.records.items()},
            "notes": {
                k: r.note
                for k, r in self.records.items()
                if r.note and not (r.placeholder and k in OF_LIMITS)
            },
            "guesses": self.placeholders,
        }
