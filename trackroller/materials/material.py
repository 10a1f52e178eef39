"""A material: its constants and the Woehler line, each value with unit, source and mark."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from trackroller.errors import InputError
from trackroller.materials.properties import PROPERTIES, Value, check_number


@dataclass(frozen=True)
class Material:
    """A material with the Woehler line through (N_Rm, R_m) and (N_k, sigma_D).

    Parameters
    ----------
    name : what the user calls it
    youngs_modulus : E [MPa], > 0
    poisson_ratio : nu [-], 0 to 0.5
    tensile_strength : R_m [MPa]
    fatigue_strength_ratio : sigma_D/R_m [-], between 0 and 1
    cycles_at_tensile_strength, cycles_at_fatigue_limit : N_Rm < N_k [-]
    family : group the friction table speaks of ('metal', 'PA6', 'POM' or the user's own; '' unknown)
    scatter_in_cycles : T_N = N_90/N_10 [-], failure probabilities in percent; None: not known
    scatter_in_stress : T_S = S_90/S_10 [-]; None: not known
    description : a few words
    records : unit, source and mark of each value, as far as known

    Raises `InputError` naming material, field, value and what to do.
    """

    name: str
    youngs_modulus: float
    poisson_ratio: float
    tensile_strength: float
    fatigue_strength_ratio: float
    cycles_at_tensile_strength: float
    cycles_at_fatigue_limit: float
    family: str = ""
    scatter_in_cycles: float | None = None
    scatter_in_stress: float | None = None
    description: str = ""
    records: Mapping[str, Value] = field(default_factory=dict, compare=False, repr=False, hash=False)

    def __post_init__(self) -> None:
        where = f"material '{self.name}'"
        for prop in PROPERTIES.values():
            value = getattr(self, prop.name)
            if value is None and prop.optional:
                continue
            object.__setattr__(self, prop.name, check_number(prop, value, where))
        if not self.cycles_at_tensile_strength < self.cycles_at_fatigue_limit:
            raise InputError(
                f"{where}.cycles_at_tensile_strength",
                self.cycles_at_tensile_strength,
                f"N_Rm must lie below N_k = {self.cycles_at_fatigue_limit:g}",
                "Give the lower number of cycles to the tensile strength.",
            )

    @property
    def fatigue_limit(self) -> float:
        """Fatigue limit sigma_D [MPa] at N_k cycles."""
        return self.fatigue_strength_ratio * self.tensile_strength

    @property
    def woehler_exponent(self) -> float:
        """Exponent k of the S-N curve [-], positive."""
        cycles = self.cycles_at_fatigue_limit / self.cycles_at_tensile_strength
        return -math.log(cycles) / math.log(self.fatigue_strength_ratio)

    @property
    def shear_modulus(self) -> float:
        """G = E / (2 (1 + nu)) [MPa]."""
        return self.youngs_modulus / (2.0 * (1.0 + self.poisson_ratio))

    @property
    def placeholders(self) -> tuple[str, ...]:
        """Names of the values that are guesses without a source."""
        return tuple(name for name, record in self.records.items() if record.placeholder)

    def as_dict(self) -> dict[str, Any]:
        """Plain numbers and texts; usable as an inline material."""
        values = {f.name: getattr(self, f.name) for f in dataclasses.fields(self) if f.name != "records"}
        return {key: value for key, value in values.items() if value not in (None, "")}
