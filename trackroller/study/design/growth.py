"""Double the sample of a study with the key `until`, and find the size to which it has grown."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any

from trackroller.study.design.grown_lhs import SAME, is_lhs, with_history

if TYPE_CHECKING:
    from trackroller.study.file.study import Study
    from trackroller.study.store.folder import StudyFolder


def doubled(study: Study) -> Study:
    """Return the study with twice the samples; its first samples are those of the study."""
    config = study.config
    update: dict[str, Any] = {"samples": 2 * config.samples}
    if is_lhs(config):
        update["grown_from"] = (*(config.grown_from or ()), config.samples)
    return dataclasses.replace(study, config=config.model_copy(update=update))


def as_planned(study: Study, folder: StudyFolder) -> Study:
    """Return a study with the number of samples to which the key `until` has grown it; see also `with_history`."""
    if study.config.until is None:
        return with_history(study, folder)
    try:
        old = type(study.config).model_validate(folder.earlier())
    except ValueError:
        return study
    if old.until is None or any(getattr(old, key) != getattr(study.config, key) for key in SAME):
        return study
    while 2 * study.config.samples <= old.samples:
        study = doubled(study)
    return study
