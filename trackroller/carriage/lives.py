"""The lives of the rollers of carriages over their load cases, limit by limit.

ASSUME: damage adds up linearly over the load cases (Palmgren-Miner), limit by limit, by their
shares of the travel. ASSUME: the load cases load the same two tracks of a roller and the same point
of the guide.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import xarray as xr

from trackroller.damage import LIMITS, first_limit
from trackroller.damage.miner import block_damage, repetitions_to_failure
from trackroller.damage.pair import first_failure
from trackroller.parameters import BODIES
from trackroller.roller.output_names import declared
from trackroller.roller.run_in import with_run_in


def hours_per_km(share: np.ndarray, speed: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """Return the hours that a carriage travels for a km with all its load cases, (n,) [h/km].

    Parameters
    ----------
    share : numpy.ndarray, shape (load_case,)
        Shares of the travel [1].
    speed : numpy.ndarray, shape (n, load_case)
        Speeds [m/s]; NaN for a load case that states none, which has the velocity of the roller.
    velocity : numpy.ndarray, shape (n,)
        Velocity that the file of the roller states [m/min].
    """
    return np.asarray(
        np.sum(share / np.where(np.isnan(speed), 0.06 * velocity[:, None], 3.6 * speed), axis=1)
    )


class Lives:
    """The lives of rollers that are solved in several load cases.

    Parameters
    ----------
    group : numpy.ndarray of int, shape (n,)
        Roller of each solved case.
    share : numpy.ndarray, shape (n,)
        Share of the travel of its load case [1].
    speed : numpy.ndarray, shape (n,)
        Its speed [km/h].
    hours : numpy.ndarray, shape (n,)
        Hours that the carriage travels for a km, with all its load cases [h/km].
    solved : xarray.Dataset
        Results of the cases along `case`.

    Attributes
    ----------
    groups : numpy.ndarray of int
        Number of each roller, rising; what is given by roller comes in this order.
    first : numpy.ndarray of int
        First case of each roller.
    solved : xarray.Dataset
        The results, whose flag `worn` holds for all load cases of a roller together.
    summed : dict of str to numpy.ndarray
        Lives with the damage of all load cases, largest utilisations and worst states of limits, by
        roller.
    ruling : numpy.ndarray of int
        Case of each roller that does most damage, or in which it does not roll.
    rank : numpy.ndarray
        What sorts rollers, the worst one first: the life to the first limit [h], below 0 for one
        that does not roll.
    """

    def __init__(
        self,
        group: np.ndarray,
        share: np.ndarray,
        speed: np.ndarray,
        hours: np.ndarray,
        solved: xr.Dataset,
    ) -> None:
        self.order = np.argsort(group, kind="stable")
        self.groups, self.start = np.unique(group[self.order], return_index=True)
        self.first = self.order[self.start]
        self.counts = np.diff(np.append(self.start, len(group)))
        self.solved = solved
        self.share = share
        self.hours = hours[self.first]
        self.time = share / speed
        self.summed = self._summed()
        self.solved = self._with_run_in()
        self.ruling, self.rank = self._judged()

    def _with_run_in(self) -> xr.Dataset:
        """Return the cases with the flag `worn` of each roller over all its load cases."""
        if "life_to_first_limit_hours" not in self.summed:
            return self.solved
        # the number of the roller of each case: `order` sorts the cases by roller
        roller = np.empty(len(self.order), dtype=int)
        roller[self.order] = np.repeat(np.arange(len(self.first)), self.counts)
        km = self.summed["life_to_first_limit_hours"] / self.hours[:, None]
        return with_run_in(self.solved, roller, self.share, km)

    def of(self, values: np.ndarray, reduce: Callable[..., np.ndarray] = np.add) -> np.ndarray:
        """Return the sum, or another reduction, over the cases of each roller."""
        return np.asarray(reduce.reduceat(values[self.order], self.start))  # type: ignore[attr-defined]

    def life(self, values: np.ndarray, units: str) -> np.ndarray:
        """Return a life with the damage of all load cases; in hours by their time, otherwise by
        their travel.
        """
        weight = self.share
        whole = np.ones(len(self.first))
        if units == "h":
            weight = self.time
            whole = self.hours
        shape = (-1, *(1,) * (values.ndim - 1))
        damage = self.of(block_damage(weight.reshape(shape), values))
        return np.asarray(whole.reshape(shape) * repetitions_to_failure(damage))

    def _judged(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the case that stands for each roller, and what ranks the rollers."""
        regime = np.where(self.share > 0, self.solved["regime"].values, 0)
        name = next(
            n for n in ("pair_life_to_first_limit_hours", "pair_life_hours") if n in self.solved
        )
        damage = np.nan_to_num(
            block_damage(self.time, self.solved[name].values), nan=0.0, posinf=1e300
        )
        if "max_pressure" in self.solved:
            used = self.solved["max_pressure"].max("contact").values
        else:
            used = self.share
        # the case that rules is the last one of its roller
        order = np.lexsort((used, damage, regime))
        group = np.empty(len(order), dtype=int)
        group[self.order] = np.repeat(np.arange(len(self.first)), self.counts)
        ruling = np.empty(len(self.first), dtype=int)
        ruling[group[order]] = order
        worst = self.of(regime, np.maximum)
        return ruling, np.where(
            worst > 0, -worst.astype(float), np.nan_to_num(self.summed[name], nan=np.inf)
        )

    def _summed(self) -> dict[str, np.ndarray]:
        """Return lives with the damage of all load cases, utilisations and states of limits, by
        roller.
        """
        out = {}
        for name, variable in self.solved.data_vars.items():
            known = declared(str(name))
            if known is not None and known.life:
                out[str(name)] = self.life(variable.values, str(variable.attrs.get("units", "")))
        if "life_hours" in out:
            for body, life in zip(
                BODIES, np.moveaxis(out["life_hours"].min(axis=1), -1, 0), strict=True
            ):
                out[f"{body}_life_hours"] = life
            out["pair_life_hours"], first = first_failure(
                out["roller_life_hours"], out["guide_life_hours"]
            )
            out["first_to_fail"] = first.astype(self.solved["first_to_fail"].dtype)
        if "life_hours_by_limit" in self.solved:
            out |= self._by_limit(out)
        return out

    def _by_limit(self, out: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
        """Return the lives by limit and to the first one, and which one it is; fatigue adds up
        track by track.
        """
        solved = self.solved
        new: dict[str, np.ndarray] = {}
        limits = [LIMITS[name] for name in solved["limit"].values.tolist()]
        counts = (self.share > 0)[:, None, None]
        used = self.of(np.where(counts, solved["utilisation"].values, np.nan), np.fmax)
        state = self.of(np.where(counts, solved["limit_state"].values, 0), np.maximum)
        meanings = solved["validity_body"].attrs["flag_meanings"].split()
        breaks = (
            (solved["validity_body"].values >> meanings.index("static"))
            & 1
            & (self.share > 0)[:, None]
        )
        broken = first_limit.breaking(self.of(breaks, np.maximum).astype(bool), limits)
        timed = solved["life_hours_by_limit"].notnull().any(["case", "body"]).values
        for end in first_limit.ENDS:
            lives = out[f"life_hours_by_limit{end}"].copy()
            for i in (
                i
                for i, limit in enumerate(limits)
                if limit.name == "fatigue" and "life_hours" in solved
            ):
                lives[:, i] = self._fatigue(solved[f"life_hours_by_limit{end}"].values[:, i])
            first, which = first_limit.first_of(lives, used, timed, limits, broken, state == 0, end)
            new |= {f"life_hours_by_limit{end}": lives, f"life_to_first_limit_hours{end}": first}
            new[f"pair_life_to_first_limit_hours{end}"] = first_failure(*first.T)[0]
            if not end:
                words = solved["limiting_mechanism"].attrs["flag_meanings"].split()
                values = np.ravel(solved["limiting_mechanism"].attrs["flag_values"])
                names = [*(limit.name for limit in limits), "unknown"]
                numbers = np.array([values[words.index(name)] for name in names])
                new["limiting_mechanism"] = numbers[which].astype(
                    solved["limiting_mechanism"].dtype
                )
        return new | {"utilisation": used, "limit_state": state.astype(solved["limit_state"].dtype)}

    def _fatigue(self, by_limit: np.ndarray) -> np.ndarray:
        """Return the hours to the fatigue limit at its failure probability, (roller, body), of the
        worse track.
        """
        return np.asarray(self.life(self._of_tracks(by_limit), "h").min(axis=1))

    def _of_tracks(self, by_limit: np.ndarray) -> np.ndarray:
        """Return the hours to the fatigue limit at its failure probability of each track, (n,
        contact, body).

        ASSUME: both tracks of a case have the same ratio of this life to the life at 50 %.
        """
        tracks = self.solved["life_hours"].transpose("case", "contact", "body").values
        with np.errstate(invalid="ignore", divide="ignore"):
            ratio = by_limit / tracks.min(axis=1)
        return np.asarray(tracks * np.where(np.isnan(ratio), 1.0, ratio)[:, None])

    def at_most(self) -> np.ndarray:
        """Return the hours to the first limit by the damage that is known, (roller,) [h]: load
        cases whose damage is not known can only shorten the life.
        """
        limits = [LIMITS[name] for name in self.solved["limit"].values.tolist()]
        most = np.zeros(len(self.first))
        for place, limit in enumerate(limits):
            if limit.beside:
                continue
            lives = self.solved["life_hours_by_limit"].values[:, place]
            if limit.name == "fatigue" and "life_hours" in self.solved:
                lives = self._of_tracks(lives)
            lives = lives.reshape(len(lives), -1)
            damage = np.nan_to_num(block_damage(self.time[:, None], lives), nan=0.0)
            most = np.maximum(most, self.of(damage).max(axis=1))
        return np.asarray(self.hours * repetitions_to_failure(most))
