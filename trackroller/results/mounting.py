"""Choose a roller of a shelf for each mounting place of a carriage.

The rollers share the load by their stiffness, so that the forces of a place depend on the rollers
of the others. Each roller is judged at each place of a carriage that has this roller everywhere,
each place takes the least one that is enough there, and the carriage with these rollers is solved.
Where a place then fails, it takes its next roller.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pandas as pd

from trackroller.carriage.file import carriage_of
from trackroller.carriage.solve import cases_of, forces_of, with_lives
from trackroller.damage import LIMITS
from trackroller.damage.first_limit import STATES
from trackroller.errors import InputError
from trackroller.methods.factor import ROWS
from trackroller.parameters import BODIES
from trackroller.results.load_ratio import EXACT, load_ratios_of_cases
from trackroller.results.size_verdicts import LIMIT_OF
from trackroller.roller.aliases import RADII
from trackroller.study.design.factor_names import CASE_FIELDS
from trackroller.study.file.shelf import ROLLER
from trackroller.study.file.study import Study

PLACE = "place"
ROUNDS = 20  # carriages with different rollers that are tried at most


@dataclass(frozen=True, eq=False)
class Mounting:
    """The roller of each mounting place of a carriage.

    Parameters
    ----------
    table : pandas.DataFrame
        One row a place: `place`, `roller` ('' if no roller is enough there), `life_hours` (low end
        of the life of roller and rail to their first limit), `life_ratio`, `load_ratio` (what its
        forces may be multiplied by), `load_ends`, and the value that is to be least.
    enough : bool
        Whether the carriage with these rollers meets the requirement at each place.
    carriage : mapping
        Keys of the file of this carriage; {} if a place has no roller.
    """

    table: pd.DataFrame
    enough: bool
    carriage: Mapping[str, Any] = field(default_factory=dict, repr=False)


def rollers_by_place(
    study: Study, safety: float = 1.0, least: str = "", permitted: tuple[str, ...] = ()
) -> Mounting:
    """Return the least roller that is enough at each place of the carriage of a sizing.

    Parameters
    ----------
    study : Study
        The study at the loads of `trackroller.results.size.sizing_studies`, with a carriage.
    safety : float
        Factor on the forces of each roller at which no limit may be exceeded [1].
    least : str
        Column of the shelf by which rollers rank; '' for the longest life.
    permitted : tuple of str
        The permitted values that are required, of `trackroller.results.size_verdicts.PERMITTED`; a
        roller of which one is not known is not surely enough.

    Returns
    -------
    Mounting
        The rollers, solved together.
    """
    if study.carriage is None:
        remedy = "Leave it out, or give a carriage file."
        raise InputError("each", True, "a carriage, which has places", remedy)
    search = _Mounting(study, safety, least, permitted)
    return search.mounted()


class _Mounting:
    """Judge the rollers of a shelf at the places of a carriage."""

    def __init__(self, study: Study, safety: float, least: str, permitted: tuple[str, ...]) -> None:
        self.study = study
        self.limits = [LIMIT_OF[name] for name in permitted]
        self.safety = safety
        self.keys = dict(study.config.carriage or {})
        self.places = list(self.keys["rollers"])
        factor = study.config.factors[ROLLER]
        self.rows = {str(row["name"]): row for row in factor[ROWS]}
        self.least = least
        ends = [
            own.least for name, own in study.config.requirement.items() if name.endswith("hours")
        ]
        self.required = max(ends, default=math.nan)

    def mounted(self) -> Mounting:
        """Return the rollers that are enough together, or those that are enough at each place
        alone.
        """
        alone = pd.concat([self._at_places(dict.fromkeys(self.places, name)) for name in self.rows])
        options = {place: self._ranked(alone, place) for place in self.places}
        for _ in range(ROUNDS):
            chosen = {place: names[0] for place, names in options.items() if names}
            if len(chosen) < len(self.places):
                break
            table = self._at_places(chosen)
            if table["enough"].all():
                return Mounting(table.drop(columns="enough"), True, self._carriage_keys(chosen))
            for place in table[PLACE][~table["enough"]]:
                options[place] = options[place][1:]
        rows = [
            alone[(alone[PLACE] == place) & (alone[ROLLER] == name)]
            for place, name in chosen.items()
        ]
        lacking = [place for place in self.places if place not in chosen]
        none = pd.DataFrame({PLACE: lacking, ROLLER: ""})
        table = pd.concat([*rows, none], ignore_index=True)
        return Mounting(table.drop(columns="enough", errors="ignore"), False)

    def _ranked(self, alone: pd.DataFrame, place: str) -> list[str]:
        """Return the rollers that are enough at a place, in the order in which it takes them; one
        without the value that is to be least is left out.
        """
        rows = alone[(alone[PLACE] == place) & alone["enough"]]
        if not self.least:
            return list(rows.sort_values("life_hours", ascending=False)[ROLLER])
        known = rows[rows[self.least].notna()]
        order = known.sort_values([self.least, "life_hours"], ascending=[True, False])
        return list(order[ROLLER])

    def _carriage_keys(self, chosen: Mapping[str, str]) -> dict[str, Any]:
        """Return the keys of the carriage with a roller at each place."""
        places = {}
        for place, name in chosen.items():
            entry = dict(self.keys["rollers"][place])
            row = self.rows[name]
            own = {key: v for key, v in row.items() if key in (*CASE_FIELDS, *RADII)}
            own = {key: value for key, value in own.items() if value is not None}
            overridden = set(own)
            if overridden & {"axis_distance", *RADII}:
                overridden |= {"axis_distance", *RADII}
            stated = {key: v for key, v in entry["roller"].items() if key not in overridden}
            entry["roller"] = stated | own
            places[place] = entry
        return {**self.keys, "rollers": places}

    def _at_places(self, chosen: Mapping[str, str]) -> pd.DataFrame:
        """Return the lives and load ratios of the rollers of a carriage, a row a place."""
        keys = self._carriage_keys(chosen)
        whole = carriage_of(keys)
        ds = with_lives(forces_of(whole), whole)
        lives = ds["life_hours_low"].values
        rolls = np.isin(ds["roller_regime"].values, (-1, 0)).all(axis=0)
        names = ds["limit"].values.tolist()
        exceeded = self._exceeded(ds["limit_state"].values, names)
        known = self._known(ds["limit_state"].values, names)
        cases = cases_of(whole, ds)
        labels = [self.places[j] for _, j in cases]
        options = {key: v for key, v in whole.rollers[0].options.items() if key != "outputs"}
        ratios = load_ratios_of_cases(list(cases.values()), labels, options, self.study.materials)
        table = pd.DataFrame({PLACE: self.places, ROLLER: [chosen[place] for place in self.places]})
        table["life_hours"] = lives
        table["life_ratio"] = lives / self.required
        table["load_ratio"] = ratios.least.reindex(self.places).to_numpy()
        table["load_ends"] = ratios.first.reindex(self.places).to_numpy()
        if self.least:
            table[self.least] = [self.rows[name].get(self.least) for name in table[ROLLER]]
            table[self.least] = table[self.least].astype(float)
        lasts = np.isnan(self.required) | (lives >= self.required)
        holds = ~(table["load_ratio"] < self.safety * (1.0 - EXACT)).to_numpy()
        table["enough"] = lasts & holds & rolls & known & ~exceeded
        return table

    def _known(self, state: np.ndarray, names: list[str]) -> np.ndarray:
        """Return which rollers have a verdict on each limit that is asked for, (roller,) bool."""
        known = np.ones(len(self.places), dtype=bool)
        for limit in self.limits:
            if limit not in names:
                return np.zeros(len(self.places), dtype=bool)
            of_roller = state[:, names.index(limit), BODIES.index("roller")]
            known &= of_roller != STATES.index("unknown")
        return known

    def _exceeded(self, state: np.ndarray, names: list[str]) -> np.ndarray:
        """Return which rollers exceed a limit over the load cases, (roller,) bool."""
        counts = np.array([LIMITS[name].bounded for name in names])
        is_exceeded = state == STATES.index("exceeded")
        return np.asarray((is_exceeded & counts[None, :, None]).any(axis=(1, 2)))
