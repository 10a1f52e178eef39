"""Double the sample of a study with the key `until`, and find the size to which it has grown."""

from __future__ import annotations

import dataclasses
from collections.abc import Collection
from typing import TYPE_CHECKING, Any

from trackroller.errors import InputError
from trackroller.study.design.grown_lhs import earlier_config, is_lhs, with_history

if TYPE_CHECKING:
    from trackroller.study.file.study import Study
    from trackroller.study.store.folder import StudyFolder

GROWN = ("samples", "grown_from", "point_samples")  # keys of a study file that growth changes


def doubled(study: Study, unsure: Collection[int] | None = None) -> Study:
    """Return the study with twice the samples; its first samples are those of the study.

    Parameters
    ----------
    study : the study
    unsure : design points of an inner/outer design that grow; by default all
    """
    config = study.config
    sizes = [rows.stop - rows.start for rows in study.drawn.points] if config.design == "inner_outer" else []
    sizes = [2 * size if unsure is None or point in unsure else size for point, size in enumerate(sizes)]
    update: dict[str, Any] = {"point_samples": tuple(sizes) if len({*sizes}) > 1 else None}
    update["samples"] = max(sizes, default=2 * config.samples)
    if is_lhs(config) and update["samples"] > config.samples:
        update["grown_from"] = (*(config.grown_from or ()), config.samples)
    return dataclasses.replace(study, config=config.model_copy(update=update))


def check_point_samples(given: Any, samples: int, points: int) -> list[int]:
    """Return the number of samples of each design point.

    Raises
    ------
    InputError : `given` is neither empty nor a whole number from 1 to `samples` for each point
    """
    sizes = list(given) or [samples] * points
    if len(sizes) != points or any(not isinstance(size, int) or not 0 < size <= samples for size in sizes):
        allowed = f"{points} whole numbers from 1 to samples ({samples}), one for each design point"
        raise InputError(
            "point_samples", sizes, allowed, "Remove the key. The key until sets it while the sample grows."
        )
    return sizes


def as_planned(study: Study, folder: StudyFolder) -> Study:
    """Return a study with the number of samples to which the key `until` has grown it; see also `with_history`."""
    if study.config.until is None:
        return with_history(study, folder)
    if (old := earlier_config(study, folder)) is None:
        return study
    times, rest = divmod(old.samples, study.config.samples)
    if rest or times & (times - 1):
        return study
    return dataclasses.replace(study, config=study.config.model_copy(update={k: getattr(old, k) for k in GROWN}))
