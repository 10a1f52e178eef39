"""Find the earlier sizes of a sample, so that its solved cases are found again (see `grown_lhs`)."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING

from trackroller.errors import InputError
from trackroller.materials.yaml_file import parse_yaml
from trackroller.study.design.grown_lhs import check_sizes
from trackroller.study.design.sampling import current_name

if TYPE_CHECKING:
    from trackroller.study.config import Study
    from trackroller.study.files import StudyFolder

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
    config, old = study.config, folder.earlier()
    lhs = config.design == "lhs" or (config.design == "inner_outer" and config.inner in (None, "lhs"))
    if not lhs or config.grown_from or not old:
        return study
    now = parse_yaml(study.merged(), "study")
    old["design"] = current_name(str(old.get("design")))
    if any((old.get(key) or None) != (now.get(key) or None) for key in SAME):
        return study
    try:
        sizes = [*old.get("grown_from", ()), int(old["samples"])]
        earlier = check_sizes([s for s in sizes if s < config.samples], config.samples)
    except (InputError, KeyError, TypeError, ValueError):
        return study
    return dataclasses.replace(study, config=config.model_copy(update={"grown_from": earlier})) if earlier else study
