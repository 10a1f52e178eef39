"""Find the earlier sizes of a sample, so that its solved cases are found again (see `grown_lhs`)."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING

from trackroller.study.design.grown_lhs import check_sizes

if TYPE_CHECKING:
    from trackroller.study.file.study import Study
    from trackroller.study.store.folder import StudyFolder

SAME = ("factors", "rank_correlations", "design", "seed", "inner")  # keys that a grown sample must share


def with_history(study: Study, folder: StudyFolder) -> Study:
    """Add the earlier sizes of the sample to a study.

    Parameters
    ----------
    study : the study
    folder : its results; the study file kept there has the earlier sizes

    Returns
    -------
    The study with `grown_from`, if it is a Latin hypercube whose factors, rank correlations, seed and design are
    unchanged. Otherwise the study as it is.
    """
    config = study.config
    lhs = config.design == "lhs" or (config.design == "inner_outer" and config.inner in (None, "lhs"))
    if not lhs or config.grown_from:
        return study
    try:
        old = type(config).model_validate(folder.earlier())
        earlier = check_sizes([s for s in (*(old.grown_from or ()), old.samples) if s < config.samples], config.samples)
    except ValueError:
        return study
    if not earlier or any(getattr(old, key) != getattr(config, key) for key in SAME):
        return study
    return dataclasses.replace(study, config=config.model_copy(update={"grown_from": earlier}))
