"""Sentences and a table on the number of samples: whether they suffice, and how a sample grew."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr

from trackroller.methods import METHODS, Method
from trackroller.methods.method import HALF_WIDTH
from trackroller.parameters import REGIMES
from trackroller.report.numbers import capital, plain, rounded
from trackroller.report.tables.table import Table
from trackroller.report.words.indices import of_output
from trackroller.report.words.sentence import Sentence, say
from trackroller.report.words.targets import target_words
from trackroller.results.looks import looks_of
from trackroller.results.ranking import best_points, estimate
from trackroller.results.results import Results
from trackroller.results.verdict import Verdict
from trackroller.roller.output_names import PARTS, is_life
from trackroller.study.file.goals import statistic

HALF_B10 = 0.1  # of B10 at the best design point, relative: a narrower interval is good enough
CLOSE = 10.0  # half width of B10 over its distance from the target, above which no number of samples is told
FEWEST = 64  # with fewer samples the lower bound of B10 is just the shortest life


def samples(sens: xr.Dataset, asked: int, about: str = "", settled: bool = False) -> Sentence | None:
    """Say whether the samples suffice, and if not, which number to write into the study file.

    Parameters
    ----------
    sens : analysis
    asked : `samples` of the study file, for an analysis that does not state its number of samples
    about : output that counts beside the targets; all of them if not given
    settled : whether the samples suffice for the verdict of the study, so that more of them only narrow intervals

    Returns
    -------
    The sentence; None for a design without samples, or if no output has an interval.

    Notes
    -----
    A half width falls as one over the root of the samples, measured by ``tests/results/test_enough.py``. The number is
    `asked` times a power of two, so that a Sobol sequence stays balanced.
    """
    method, asked = METHODS[str(sens.attrs["method"])], int(sens.attrs.get("samples", asked))
    if method.points:
        return _of_points(sens, asked, about, settled)
    if not method.judged or "take_times" not in sens:
        return None
    needed = {str(o): float(sens["take_times"].sel(output=o)) for o in sens["output"].values if str(o) not in REGIMES}
    needed = {name: value for name, value in needed.items() if np.isfinite(value) and about in ("", name)}
    if not needed:
        return None
    worst = max(needed, key=lambda name: (needed[name], float(sens["half_width"].sel(output=name))))
    half, times = float(sens["half_width"].sel(output=worst)), needed[worst]
    number = int(times * asked)
    values: dict[str, Any] = {
        "point": False,
        "chance": None,
        "too_few": False,
        "output": worst,
        "what": f"the indices of {of_output(sens, worst)}",
    }
    values |= {"table": method.observed, "settled": settled}
    values |= {"share": "the largest effect" if method.effects else "the variance", "half": half}
    values |= {"take_times": times, "number": number, "predicted": half / math.sqrt(times)}
    return say("samples", "enough" if times <= 1 else "more", **values)


def _of_points(sens: xr.Dataset, asked: int, about: str, settled: bool) -> Sentence | None:
    """Judge B10 of each life at its best design point, and the probability of each target at all design points."""
    widths = []
    for output in (str(n) for n in sens["output"].values if is_life(str(n)) and about in ("", str(n))):
        part = sens.sel(output=output)
        part = part.isel(point=best_points(part)[0])
        if not 0 < float(part["b10"]) < np.inf or not np.isfinite(float(part["b10_high"])):
            continue
        half = float(np.ptp(estimate(part, "b10")[1:])) / 2 / float(part["b10"])
        widths.append((half, HALF_B10, f"B10 of the {part['output_name'].item()} at the best design point"))
    for t in range(sens.sizes.get("target", 0)):
        own = sens.isel(target=t)
        half = float(np.ptp(estimate(own, "target_probability")[1:], axis=0).max()) / 2
        widths.append((half, HALF_WIDTH, f"the probability of {target_words(sens, t)}"))
    if not widths:
        return None
    half, wanted, what = max(widths, key=lambda item: item[0] / item[1])
    values = {
        "point": True,
        "chance": None,
        "table": False,
        "what": what,
        "half": half,
        "wanted": wanted,
        "asked": asked,
    }
    values["settled"] = settled
    lives = any(limit == HALF_B10 for _, limit, _ in widths)
    if half <= wanted and (asked >= FEWEST or not lives):
        return say("samples", "enough", **values)
    times = _times(half / wanted)
    while lives and times * asked < FEWEST:
        times *= 2
    values |= {"number": int(times * asked), "predicted": half / math.sqrt(times)}
    return say("samples", "more", **values, too_few=half <= wanted)


def of_target(sens: xr.Dataset, asked: int) -> Sentence | None:
    """Say whether the samples suffice for the probability to meet all targets; None where it has no interval."""
    own, method = sens.isel(target=-1), METHODS[str(sens.attrs["method"])]  # the last target joins several
    if own["target_probability"].ndim or not np.isfinite(estimate(own, "target_probability")).all():
        return None
    chance, low, high = map(float, estimate(own, "target_probability"))
    half, asked = (high - low) / 2, int(sens.attrs.get("samples", asked))
    values: dict[str, Any] = {
        "point": True,
        "table": method.observed,
        "what": f"the probability of {target_words(sens, -1)}",
    }
    values |= {"half": half, "chance": (chance, low, high), "settled": False}
    if half <= HALF_WIDTH:
        return say("samples", "enough", **values)
    times = _times(half / HALF_WIDTH)
    return say("samples", "more", **values, number=times * asked, predicted=half / math.sqrt(times), too_few=False)


def undecided(found: Verdict, asked: int, table: bool) -> Sentence | None:
    """Say how many samples decide where the interval of B10 holds the target; None where the two are too close."""
    one, required = found.best[0], found.required
    ends = np.log([one.low, *one.interval, required]) if one.low > 0 and one.interval[0] > 0 else np.full(4, np.nan)
    away = float(ends[3] - ends[0])
    half = float(ends[2] - ends[0] if away > 0 else ends[0] - ends[1])
    if not np.isfinite([away, half]).all() or half > CLOSE * abs(away):
        return None
    times = _times(half / abs(away))
    return say("samples", "undecided", number=times * asked, table=table) if times > 1 else None


def _times(ratio: float) -> int:
    """Return the power of two by which more samples divide a half width by a ratio."""
    return int(2 ** max(0, math.ceil(math.log2(ratio**2) - 1e-9)))


def quantity_words(name: str, method: Method) -> str:
    """Name an entry of `until.of` in words."""
    kind, output = statistic(name) if method.points else ("", name)
    words = PARTS[output].words if output in PARTS else plain(output)
    if method.points:
        return f"probability of {words}" if kind == "probability" else f"log10 B10 of the {words}"
    return words


def grown(results: Results) -> Sentence | None:
    """Say why a growing sample stopped, and its widest interval; None for other studies."""
    growth = looks_of(results)
    if growth is None:
        return None
    last = growth["looks"][-1]
    widths = {name: width for name, width in last["half_width"].items() if width is not None}
    name = max(widths, key=lambda name: widths[name], default="")
    words = quantity_words(name, results.design.method) if name else ""
    values = {"width": widths.get(name), "words": words, "at": last["at"].get(name, "")}
    return say("samples", "grown", cases=last["cases"], stopped=growth["stopped"], **values)


def looks_table(results: Results) -> Table | None:
    """List the widest interval of each output at each look; None for a study without the key `until`."""
    growth = looks_of(results)
    if growth is None:
        return None
    rows = []
    for one in growth["looks"]:
        row = {"Cases": one["cases"]}
        for name, width in one["half_width"].items():
            text = "–" if width is None else f"± {rounded(width, 2)} ({one['at'][name]})"
            row[capital(quantity_words(name, results.design.method))] = text
        rows.append(row)
    note = f"Widest 95 % interval at each look and where; wanted: ± {growth['half_width']:g}."
    return Table.of("looks", "Intervals as the sample grew", rows, note)
