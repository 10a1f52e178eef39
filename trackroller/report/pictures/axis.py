"""An axis of a picture: where a value stands in percent, and its ticks."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from trackroller.report.numbers import grouped

# mean width of a letter of a picture [px], measured in Chromium with DejaVu Sans of 11 px
LETTER = 6.6
WIDE_RATIO = 5.0  # largest over smallest value from which an axis of positive values is logarithmic
ROOM = 0.04  # of the axis that stays free at each end
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


@dataclass(frozen=True)
class Axis:
    """An axis between two ends.

    Attributes
    ----------
    low, high : its ends, low < high
    logarithmic : whether equal ratios are equally long
    """

    low: float
    high: float
    logarithmic: bool = False

    @classmethod
    def of(
        cls, values: Iterable[float], logarithmic: bool | None = None, room: float = ROOM
    ) -> Axis:
        """Return an axis that holds values; by their ratio it is logarithmic unless that is said.

        Infinite and undefined values stand at its ends, and so does 0 on a logarithmic axis.
        """
        numbers = np.asarray(list(values), dtype=float)
        numbers = numbers[np.isfinite(numbers)]
        positive = numbers[numbers > 0]
        if logarithmic is None:
            wide = positive.size > 0 and positive.max() > WIDE_RATIO * positive.min()
            logarithmic = bool(wide and (numbers >= 0).all())
        if logarithmic and positive.size:
            return cls(*_logarithmic_ends(float(positive.min()), float(positive.max()), room), True)
        if not numbers.size:
            return cls(0.0, 1.0)
        return cls(*_linear_ends(float(numbers.min()), float(numbers.max()), room))

    def place(self, value: float) -> float:
        """Return where a value stands, from 0 to 100 %."""
        if math.isnan(value):
            return math.nan
        if self.logarithmic:
            if value <= 0:
                return 0.0
            if math.isinf(value):
                return 100.0
            share = math.log(value / self.low) / math.log(self.high / self.low)
        elif self.high == self.low:
            share = 0.5
        else:
            share = (value - self.low) / (self.high - self.low)
        return 100 * min(1.0, max(0.0, share))

    def ticks(self, length: float) -> list[tuple[float, str]]:
        """Return values of ticks with their texts, so that texts do not collide along an axis of
        this length [px].
        """
        best: list[tuple[float, str]] = []
        for values in self._sets_of_values():
            ticks = [
                (value, tick_text(value)) for value in values if self.low <= value <= self.high
            ]
            if len(ticks) > len(best) and self._fit(ticks, length):
                best = ticks
        return best

    def lines(self, height: float) -> list[tuple[float, str]]:
        """Return values of ticks with their texts along a vertical axis of this height [px]."""
        best: list[tuple[float, str]] = []
        most = max(2, int(height / 22))
        for values in self._sets_of_values():
            ticks = [
                (value, tick_text(value)) for value in values if self.low <= value <= self.high
            ]
            if len(best) < len(ticks) <= most:
                best = ticks
        return best

    def powers(self) -> list[float]:
        """Return the powers of ten inside a logarithmic axis, at most twelve of them."""
        if not self.logarithmic:
            return []
        first = math.ceil(math.log10(self.low) - 1e-9)
        last = math.floor(math.log10(self.high) + 1e-9)
        step = max(1, math.ceil((last - first) / 12))
        return [10.0**power for power in range(first, last + 1, step)]

    def _fit(self, ticks: Sequence[tuple[float, str]], length: float) -> bool:
        places = [self.place(value) * length / 100 for value, _ in ticks]
        widths = [LETTER * len(text) for _, text in ticks]
        gaps = zip(places, places[1:], widths, widths[1:], strict=False)
        return all(right - left > (one + other) / 2 + LETTER for left, right, one, other in gaps)

    def _sets_of_values(self) -> list[list[float]]:
        """Return sets of round values, from which `ticks` takes the largest that fits."""
        if not self.logarithmic:
            return _steps(self.low, self.high)
        first = math.floor(math.log10(self.low))
        last = math.ceil(math.log10(self.high))
        decades = range(first, last + 1)
        sets = [
            [10.0**power for power in decades if power % step == 0]
            for step in (1, 2, 3, 4, 5, 10, 20)
        ]
        if last - first <= 2:
            sets += [
                [one * 10.0**power for power in decades for one in of] for of in ((1, 3), (1, 2, 5))
            ]
        if self.high < 10 * self.low:
            sets += _steps(self.low, self.high)
        return sets


def _logarithmic_ends(low: float, high: float, room: float) -> tuple[float, float]:
    if high <= low * (1 + 1e-9):
        return low / 2, high * 2
    spare = (high / low) ** room
    return low / spare, high * spare


def _linear_ends(low: float, high: float, room: float) -> tuple[float, float]:
    if high - low <= 1e-9 * max(abs(low), abs(high)):
        spare = abs(low) / 2 or 1.0
        return low - spare, high + spare
    spare = room * (high - low)
    return low - spare, high + spare


def _steps(low: float, high: float) -> list[list[float]]:
    """Return multiples of round steps between two ends, for steps of a twentieth to a half of the
    range.
    """
    power = math.floor(math.log10(high - low)) - 1
    steps = sorted(
        one * 10.0**exponent for exponent in (power, power + 1) for one in (1, 2, 2.5, 5)
    )
    marks = []
    for step in steps:
        first = math.ceil(low / step - 1e-9)
        last = math.floor(high / step + 1e-9)
        if 1 <= last - first <= 20:
            marks.append([float(f"{one * step:.12g}") for one in range(first, last + 1)])
    return marks


def tick_text(value: float) -> str:
    """Write the number of a tick: '100,000', but '10⁶'."""
    power = 0.0
    if value > 0:
        power = math.log10(value)
    if (power >= 6 or power <= -4) and abs(power - round(power)) < 1e-9:
        return f"10{str(round(power)).translate(_RAISED)}"
    return grouped(value, 4)
