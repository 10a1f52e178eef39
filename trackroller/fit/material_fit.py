"""The result of a fit: values of a material, their intervals and posterior, and what the tests
cannot tell.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from trackroller.errors import InputError, check_names, checked_text, listing
from trackroller.files import all_or_none, write_whole
from trackroller.fit import SHOWN
from trackroller.fit.line import Interval, Line
from trackroller.fit.posterior import Normal, Posterior, ln_range, log_strength, posterior
from trackroller.fit.solved_rollers import worst_load
from trackroller.fit.table import LEAST_STRESS, MOST_CYCLES, MOST_STRESS, TestTable
from trackroller.materials import Material, add_material
from trackroller.materials.file import own_file, posterior_path
from trackroller.numerics.numbers import finite_number

CONFIDENCE = 0.9
LONGEST_NAME = 100  # characters of the name of a material, which is a part of names of files
# name in `.data` and in an entry of the database, by the value of a line of each kind
WORDS = {
    "fatigue_limit": ("MPa", "fatigue strength at the knee, failure probability 50 %"),
    "woehler_exponent": ("1", "slope k of the S-N line"),
    "scatter_in_cycles": ("1", "scatter of the life T_N"),
    "scatter_in_stress": ("1", "scatter of the fatigue limit T_S"),
    "rolling_pressure": ("MPa", "pressure borne in rolling contact, failure probability 50 %"),
    "rolling_exponent": ("1", "exponent of the line of pressure"),
    "wear_coefficient": ("mm3/(N m)", "wear coefficient"),
    "wear_scatter": ("1", "scatter of the travel to a depth, 90 over 10 %"),
    "friction_coefficient": ("1", "friction coefficient"),
    "friction_scatter": ("1", "scatter of the friction coefficient, 90 over 10 %"),
}
SPOKEN = {
    "slope": "woehler_exponent",
    "scatter": "scatter_in_cycles",
    "fatigue_strength": "fatigue_limit",
}
OF_GROUP = {
    "fatigue": {
        "slope": "woehler_exponent",
        "log_scatter": "scatter_in_cycles",
        "log_limit": "fatigue_limit",
        "log_limit_scatter": "scatter_in_stress",
    },
    "rolling": {"slope": "rolling_exponent", "log_scatter": "scatter_in_cycles"},
    "wear": {"level": "wear_coefficient", "log_scatter": "wear_scatter"},
    "friction": {"level": "friction_coefficient", "log_scatter": "friction_scatter"},
}
# load that a straight line bears for the cycles at which it is stated, by the kind of the line
STRENGTHS = {"fatigue": "fatigue_limit", "rolling": "rolling_pressure"}


@dataclass(frozen=True)
class Group:
    """The line of one kind of end, with its tests, priors and posterior.

    Parameters
    ----------
    kind : str
        "fatigue" (stress), "rolling" (pressure), "wear" or "friction".
    line : Line
        The line. That of wear is ln of the travel over the travel that the unit coefficient `scale`
        gives, and that of friction ln of the coefficient.
    priors : mapping of str to Normal
        Priors of its values.
    at : float
        Cycles at which a line without fatigue limit states its strength [1].
    scale : float
        Wear coefficient with which the travels of the model were computed [mm3/(N m)].
    rows : tuple of int
        Row of the table of each test of the line; empty for all rows in their order.
    """

    kind: str
    line: Line
    priors: Mapping[str, Normal] = field(default_factory=dict)
    at: float = math.nan
    scale: float = math.nan
    rows: tuple[int, ...] = ()

    @cached_property
    def posterior(self) -> Posterior:
        """Return the posterior of the values of the line."""
        return posterior(self.line, self.priors, self.at)

    @property
    def names(self) -> tuple[str, ...]:
        """Return the names of the values that the tests were to tell."""
        names_by_value = OF_GROUP[self.kind]
        names = [names_by_value[name] for name in self.line.free if name in names_by_value]
        if self.kind in STRENGTHS and not self.line.knee:
            names.insert(0, STRENGTHS[self.kind])
        return tuple(names)

    @property
    def unidentified(self) -> tuple[str, ...]:
        """Return the names of values whose estimate lies at a bound, or that no failure bounds."""
        names_by_value = OF_GROUP[self.kind]
        if not self.line.tests.failed.any():
            return self.names
        at_bound = {names_by_value[name] for name in self.line.at_bound if name in names_by_value}
        if names_by_value.get("slope") in at_bound and not self.line.knee:
            at_bound.add(STRENGTHS[self.kind])  # it lies on the line far from the tests
        return tuple(name for name in self.names if name in at_bound)

    def estimate(self, name: str) -> float:
        """Return the value of the largest likelihood, NaN where the tests do not identify it."""
        if name in self.unidentified:
            return math.nan
        return float(self._of(name, self.line.best))

    def values_of(self, name: str) -> np.ndarray:
        """Return a value by its name at the points of the posterior, in its unit."""
        return self._of(name, self.posterior.values)

    def _of(self, name: str, values: Any) -> np.ndarray:
        """Return a value by its name, in its unit, from the values of the line."""
        if name in STRENGTHS.values():
            return np.exp(log_strength(self.line, values, self.at))
        if name in ("woehler_exponent", "rolling_exponent"):
            return np.asarray(values.slope)
        if name == "wear_coefficient":  # a longer travel is a smaller coefficient
            return self.scale * np.exp(-values.level)
        if name == "friction_coefficient":
            return np.exp(values.level)
        if name == "scatter_in_stress":
            deviation = values.log_limit_scatter
        else:
            deviation = values.log_scatter
        return np.exp(math.log(ln_range(1.0)) * np.exp(deviation))

    def interval(self, name: str, confidence: float = CONFIDENCE) -> Interval:
        """Return the profile interval of a value by its name, in its unit; an open end is inf
        or 0.
        """
        if name in STRENGTHS.values() and not self.line.knee:
            return Interval(
                *np.exp(self.line.interval_of_strength(math.log(self.at), 0.5, confidence)).tolist()
            )
        key_of_line = next(key for key, output in OF_GROUP[self.kind].items() if output == name)
        ends = self.line.interval(key_of_line, confidence)
        if (
            self.kind == "wear" and key_of_line == "level"
        ):  # a longer travel is a smaller coefficient
            return Interval(self.scale * math.exp(-ends.high), self.scale * math.exp(-ends.low))
        return Interval(
            self._end(name, key_of_line, ends.low), self._end(name, key_of_line, ends.high)
        )

    def _end(self, name: str, key: str, end: float) -> float:
        """Return an end of the interval of a value in its unit; inf or 0 at a bound of the line's
        value `key`.
        """
        lower, upper = self.line.bounds[key]
        if end >= upper:
            return math.inf
        if end <= lower:
            return 0.0
        return float(self._of(name, self.line.best._replace(**{key: end})))

    def band(self, name: str, confidence: float = CONFIDENCE) -> tuple[float, float, float]:
        """Return low end, median and high end of a value by the posterior."""
        own = np.broadcast_to(self.values_of(name), self.posterior.weight.shape)
        ends = 0.5 - 0.5 * confidence, 0.5, 0.5 + 0.5 * confidence
        return tuple(float(end) for end in self.posterior.quantile(own, np.array(ends)))  # type: ignore[return-value]

    @property
    def tested(self) -> tuple[float, float, float]:
        """Return the least and the largest stress or pressure tested [MPa], and the cycles of the
        longest test [1].
        """
        tests = self.line.tests
        low = float(np.exp(tests.stress.min())), float(np.exp(tests.stress.max()))
        return (*low, float(np.exp(np.max(tests.middle))))


@dataclass(frozen=True)
class MaterialFit:
    """Values of a material from tests; `trackroller.fit_sn` and `trackroller.fit_bench` make it.

    `trackroller.report(fit, path)` writes its page; `fit.report(path)` is the same.

    Parameters
    ----------
    kind : str
        "sn" for coupons, "bench" for rollers, "wear" for depths of one groove.
    name : str
        Name of the material.
    groups : tuple of Group
        Fatigue, wear and friction, as far as they were fitted.
    tests : TestTable
        The tests as given.
    like : str or None
        Material whose other values the fitted one takes.
    given : mapping of str to str
        Under what the values hold, such as the contact model of the fit.
    notes : list of str
        Sentences on how the values enter a life.
    not_given : list of str
        The sentence on parameters that are those of the paper's example, if there are any.
    """

    kind: str
    name: str
    groups: tuple[Group, ...]
    tests: TestTable
    like: str | None = None
    given: Mapping[str, str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    not_given: list[str] = field(default_factory=list)

    def group(self, kind: str) -> Group:
        """Return the group of a kind of end.

        Raises
        ------
        InputError
            If the fit has no such group.
        """
        for own in self.groups:
            if own.kind == kind:
                return own
        raise InputError(
            "fit",
            kind,
            f"one of {listing([own.kind for own in self.groups], 'or')}",
            "Fit it as well.",
        )

    @property
    def unidentified(self) -> tuple[str, ...]:
        """Return the names of the values that the tests do not identify."""
        return tuple(name for names_by_value in self.groups for name in names_by_value.unidentified)

    @cached_property
    def material(self) -> dict[str, Any]:
        """Return the values as an entry of a material, without those that the tests do not
        identify.

        With `like`, a case takes the entry as a material: `Case(roller_material=fit.material)`.
        """
        entry: dict[str, Any] = {"name": self.name}
        if self.like:
            entry["like"] = self.like
        for group in self.groups:
            known = [
                name for name in group.names if name in ENTRY and name not in group.unidentified
            ]
            entry |= {name: group.estimate(name) for name in known}
            if STRENGTHS.get(group.kind) not in entry:
                continue
            best = group.line.best
            if group.kind == "fatigue":
                entry["cycles_at_fatigue_limit"] = self.knee
                if self.in_rolling:
                    entry["sn_in_rolling"] = 1.0
            else:
                entry["rolling_cycles"] = group.at
            if "slope" not in group.line.free:
                entry[OF_GROUP[group.kind]["slope"]] = float(best.slope)
            if "log_scatter" not in group.line.free:
                entry["scatter_in_cycles"] = float(ln_range(math.exp(best.log_scatter)))
        return entry

    @property
    def in_rolling(self) -> bool:
        """Return whether the tests were in rolling contact, and not in bending or tension."""
        return self.kind == "bench" or self.given.get("load type") == "rolling contact"

    @property
    def of_life(self) -> Group | None:
        """Return the line that a life by fatigue follows from, of stress or of pressure; None
        without one.
        """
        return next((own for own in self.groups if own.kind in STRENGTHS), None)

    def _line_of_life(self) -> Line:
        """Return the line of stress or of pressure; refuse a fit without both."""
        own = self.of_life
        if own is None:
            own = self.group("fatigue")
        return own.line

    @property
    def knee(self) -> float:
        """Return N_k: where the line meets the fatigue limit, or the cycles at which its strength
        is stated [1].
        """
        own = self.group("fatigue")
        best = own.line.best
        if not own.line.knee:
            return own.at
        return float(math.exp(best.level - best.slope * (best.log_limit - own.line.reference)))

    @cached_property
    def data(self) -> xr.Dataset:
        """Return estimates, intervals and posterior as a labelled data set.

        `estimate`, `low` and `high` (of 90 %) stand along `value`, `posterior_low` and so on beside
        them; the points of each posterior stand along `fatigue_point`, `rolling_point`,
        `wear_point` or `friction_point`.
        """
        rows = [(own, name) for own in self.groups for name in own.names]
        columns: dict[str, list[float]] = {"estimate": [own.estimate(name) for own, name in rows]}
        ends = [own.interval(name) for own, name in rows]
        columns |= {"low": [end.low for end in ends], "high": [end.high for end in ends]}
        failed = {own.kind: bool(own.line.tests.failed.any()) for own in self.groups}
        columns |= {
            name: [math.nan] * len(rows)
            for name in ("posterior_low", "posterior_median", "posterior_high")
        }
        for row, (own, name) in enumerate(rows):
            if failed[own.kind]:
                low, median, high = own.band(name)
                columns["posterior_low"][row] = low
                columns["posterior_median"][row] = median
                columns["posterior_high"][row] = high
        words = {
            "estimate": "value of the largest likelihood, missing where the tests do not identify "
            "it",
            "low": "low end of the 90 % profile interval",
            "high": "high end of the 90 % profile interval",
            "posterior_low": "5 % quantile of the posterior",
            "posterior_median": "median of the posterior",
            "posterior_high": "95 % quantile of the posterior",
        }
        ds = xr.Dataset(
            {n: ("value", np.array(v, float), {"long_name": words[n]}) for n, v in columns.items()}
        )
        ds = ds.assign_coords(
            value=[name for _, name in rows], unit=("value", [WORDS[name][0] for _, name in rows])
        )
        for own in (own for own in self.groups if failed[own.kind]):
            points = own.posterior.to_dataset().rename(point=f"{own.kind}_point")
            ds = ds.merge(points.rename({n: f"{own.kind}_{n}" for n in points}))
            tests = {
                "stress": own.line.tests.stress,
                "low": own.line.tests.low,
                "high": own.line.tests.high,
            }
            ds = ds.assign(
                {f"{own.kind}_test_{n}": (f"{own.kind}_test", value) for n, value in tests.items()}
            )
        ds.attrs = self._attributes()
        return ds

    def _attributes(self) -> dict[str, Any]:
        attributes: dict[str, Any] = {
            "title": self._title,
            "kind": self.kind,
            "tests": self.tests.name,
            "sha256": self.tests.digest,
            "rows": len(self.tests),
            "confidence": CONFIDENCE,
        }
        attributes |= {
            f"holds_for_{key.replace(' ', '_')}": value for key, value in self.given.items()
        }
        for own in self.groups:
            attributes |= {
                f"{own.kind}_tests": own.line.size,
                f"{own.kind}_failures": int(own.line.tests.failed.sum()),
                f"{own.kind}_reference": own.line.reference,
                f"{own.kind}_knee": int(own.line.knee),
            }
            constants = {"slope": own.line.slope, "scatter": own.line.scatter}
            attributes |= {
                f"{own.kind}_held_{key}": value
                for key, value in constants.items()
                if value is not None
            }
            if own.kind == "fatigue":
                low, high, cycles = own.tested
                attributes |= {"tested_stress": [low, high], "tested_cycles": cycles}
                if "fatigue_limit" in self.material:
                    attributes |= {
                        name: float(self.material[name])
                        for name in ("fatigue_limit", "woehler_exponent", "cycles_at_fatigue_limit")
                        if name in self.material
                    }
        return attributes

    def interval(
        self,
        quantity: str,
        *,
        amplitude: Any = None,
        cycles: Any = None,
        failure_probability: float = 0.5,
        confidence: float = CONFIDENCE,
    ) -> Interval:
        """Return an interval that holds the true value in 90 % of fits.

        Parameters
        ----------
        quantity : str
            "cycles" to failure under an `amplitude`, "amplitude" at so many `cycles`, or a fitted
            value: "slope", "scatter", "fatigue_strength" or a name of `.data`.
        amplitude : float or str, optional
            Stress amplitude [MPa], as the material takes it; of a line of pressure the pressure.
        cycles : float, optional
            Number of cycles [1].
        failure_probability : float
            Share of specimens that have failed, between 0 and 1.
        confidence : float
            Share of intervals that hold the true value.

        Returns
        -------
        Interval
            `low` and `high` in the unit of the quantity; an end that the tests do not bound is 0 or
            inf.

        Raises
        ------
        InputError
            For an unknown quantity, or one that was not fitted.
        """
        failure_probability = share("failure_probability", failure_probability)
        confidence = share("confidence", confidence)
        quantity = str(quantity)
        purpose = f"the interval of {quantity}"
        if quantity == "cycles":
            stress = math.log(_positive("amplitude", amplitude, purpose))
            line = self._line_of_life()
            return _unlogged(line.interval_of_life(stress, failure_probability, confidence))
        if quantity == "amplitude":
            life = math.log(_positive("cycles", cycles, purpose))
            line = self._line_of_life()
            return _unlogged(line.interval_of_strength(life, failure_probability, confidence))
        name = SPOKEN.get(quantity, quantity)
        known = {n: own for own in self.groups for n in own.names}
        check_names("quantity", [name], (*known, "cycles", "amplitude"))
        return known[name].interval(name, confidence)

    def life_hours(
        self, design: Any, *, failure_probability: float = 0.5, confidence: float = CONFIDENCE
    ) -> Interval:
        """Return the interval of the life by fatigue of a design [h], for the body that was tested.

        Parameters
        ----------
        design : Case or mapping
            Fields of the case, and options of `trackroller.solve`.
        failure_probability : float
            Share of bodies that have failed, 0.1 for B10.
        confidence : float
            Share of intervals that hold the true value.

        Returns
        -------
        Interval
            `low` and `high`; of coupons the roller counts.

        Raises
        ------
        InputError
            If the design does not roll, or has another contact model, life criterion or accuracy
            than the fit.
        """
        failure_probability = share("failure_probability", failure_probability)
        confidence = share("confidence", confidence)
        line = self._line_of_life()
        by_pressure = not self.has("fatigue")
        load, per_hour = worst_load(design, self.given, self.name, by_pressure)
        cycles = _unlogged(line.interval_of_life(math.log(load), failure_probability, confidence))
        return Interval(cycles.low / per_hour, cycles.high / per_hour)

    def estimate(
        self, quantity: str, *, amplitude: float = math.nan, failure_probability: float = 0.5
    ) -> float:
        """Return the most likely value of a quantity, as `interval` names them."""
        quantity = str(quantity)
        if quantity == "cycles":
            line = self._line_of_life()
            log_stress = math.log(_positive("amplitude", amplitude, "the estimate of cycles"))
            probability = share("failure_probability", failure_probability)
            return float(np.exp(line.log_life(line.best, log_stress, probability)))
        name = SPOKEN.get(quantity, quantity)
        known = {n: own for own in self.groups for n in own.names}
        check_names("quantity", [name], known)
        return known[name].estimate(name)

    def write(
        self, file: Path | str = Path("config/materials.yaml"), *, replace: bool = False
    ) -> Material:
        """Write the material into the user's file, and its posterior into the folder `fits` beside
        it.

        Parameters
        ----------
        file : path
            The user's materials file.
        replace : bool
            Allow to change a material that the file already contains.

        Returns
        -------
        Material
            The material as the file now defines it.

        Raises
        ------
        InputError
            If the tests do not identify a value that a material needs, or the file cannot be
            written.
        """
        entry = {key: value for key, value in self.material.items() if key != "name"}
        needed = [
            name
            for own in self.groups
            if own.kind in STRENGTHS
            for name in (STRENGTHS[own.kind], OF_GROUP[own.kind]["slope"])
        ]
        lacking = [name for name in needed if name not in entry]
        if lacking:
            remedy = "Hold the slope, or test more specimens at other stresses."
            raise InputError(
                f"material '{self.name}'",
                None,
                "",
                remedy,
                f"lacks {listing(lacking)}: not identified",
            )
        if self.like is None:
            remedy = "Name it with --like, in Python like=: a steel of the database for a steel."
            raise InputError(
                "like",
                None,
                "a material whose E, Poisson's ratio and R_m the new one takes",
                remedy,
            )
        path = posterior_path(file, self.name)
        self._check_file(path)
        digest = ""
        if self.tests.digest:
            digest = f", sha256 {self.tests.digest[:16]}"
        under = "; ".join(f"{key} {value}" for key, value in self.given.items())
        source = f"fit of {len(self.tests)} tests, {self.tests.name}{digest}"
        with all_or_none(path, own_file(file)):
            write_whole(path, lambda beside: self.data.to_netcdf(beside, engine="netcdf4"))
            # the material comes last: a killed process leaves no material without its range
            return add_material(
                file, self.name, replace=replace, source=source, note=under, **entry
            )

    def _check_file(self, path: Path) -> None:
        """Refuse a name whose posterior would take the place of that of another material."""
        if not path.is_file():
            return
        with xr.open_dataset(path) as stored:
            other = str(stored.attrs.get("title", ""))
        if other != self._title:
            wrong = (
                f"has its posterior in {path.name}, where another material has its own ({other})"
            )
            raise InputError(
                "name", self.name, "", "Choose a name that differs by a letter or digit.", wrong
            )

    @property
    def _title(self) -> str:
        return f"Values of {self.name} from tests"

    def has(self, kind: str) -> bool:
        """Return whether the fit has a group of this kind."""
        return any(own.kind == kind for own in self.groups)


for _name, _method in SHOWN.items():
    setattr(MaterialFit, _name, _method)


def share(field: str, value: Any) -> float:
    """Return a share between 0 and 1; refuse other values."""
    number = finite_number(value)
    if not 0.0 < number < 1.0:
        raise InputError(field, value, "a number between 0 and 1", "Give 0.1 for 10 %.")
    return number


def _unlogged(interval: Interval) -> Interval:
    """Return the interval of a value from that of its logarithm."""
    return Interval(*(float(np.exp(end)) for end in interval))


def _positive(name: str, value: Any, purpose: str) -> float:
    """Return an amplitude [MPa] or a number of cycles; refuse other values."""
    unit, low, high = "-", 1.0, MOST_CYCLES
    allowed = f"a finite number from {low:g} to {high:g}"
    if name == "amplitude":
        unit, low, high = "MPa", LEAST_STRESS, MOST_STRESS
        allowed = f"a finite number from {low:g} to {high:g} MPa"
    number = math.nan
    if value is not None:
        number = finite_number(value, unit, name)
    if not low <= number <= high:
        raise InputError(name, value, f"{allowed}, for {purpose}")
    return number


def check_texts(**texts: Any) -> None:
    """Refuse values of fields that are neither a name nor None."""
    for field_name, text in texts.items():
        if text is None:
            continue
        if not isinstance(text, str):
            raise InputError(field_name, text, "a text", "Write the name in quotes.")
        checked_text(text, f"{field_name} of a material")
        if len(text) > LONGEST_NAME:
            allowed = f"at most {LONGEST_NAME} characters"
            raise InputError(field_name, text, allowed, "Shorten the name, such as 'rig steel'.")


ENTRY = (
    "fatigue_limit",
    "woehler_exponent",
    "scatter_in_cycles",
    "scatter_in_stress",
    "rolling_pressure",
    "rolling_exponent",
    "wear_coefficient",
)
