"""Double the sample of a study with the key `until`, and find the size to which it has grown.

The study file states the first look. How far the sample has grown stands in the plan of the study's
folder.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Collection, Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from trackroller.study.file.study import Study

# keys that a grown sample shares
SAME = ("factors", "rank_correlations", "method", "seed", "inner", "samples")


def doubled(study: Study, unsure: Collection[int] | None = None) -> Study:
    """Return the study with twice the samples; its first samples are those of the study.

    Parameters
    ----------
    study : the study
    unsure : design points of an inner/outer design that grow; by default all
    """
    if not study.drawn.method.points:
        return dataclasses.replace(study, grown=(2 * study.samples,))
    sizes = [rows.stop - rows.start for rows in study.drawn.points]
    if unsure is None:
        unsure = range(len(sizes))
    for point in set(unsure):
        sizes[point] *= 2
    return dataclasses.replace(study, grown=tuple(sizes))


def as_planned(study: Study, record: Mapping[str, Any]) -> Study:
    """Return a study with the number of samples to which the key `until` has grown it.

    Parameters
    ----------
    study : the study, at its first look
    record : record of the plan of its folder
    """
    if study.config.until is None or not record.get("grown"):
        return study
    planned = record["sample"]
    now = sample_of(study)
    if planned == now:
        return dataclasses.replace(study, grown=tuple(record["grown"]))
    return study


def sample_of(study: Study) -> dict[str, Any]:
    """Return what decides the first rows of a sample, as values of JSON."""
    stated = study.as_dict()
    replicates = 1
    if study.config.until is not None:
        replicates = study.config.until.replicates
    return {key: stated[key] for key in SAME if key in stated} | {"replicates": replicates}
