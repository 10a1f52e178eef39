"""Which sizes the sample of a study had before, so that its cases are found again (see `grown_lhs`)."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING

from trackroller.errors import InputError
from trackroller.materials.yaml_file import parse_yaml, read_mapping
from trackroller.study.design.grown_lhs import check_sizes

if TYPE_CHECKING:
    from trackroller.study.config import Study
    from trackroller.study.files import StudyFolder


def with_history(study: Study, folder: StudyFolder) -> Study:
    """The study with the sizes its sample had before, as told by the study file kept with its results.

    Only for Latin hypercubes whose factors, seed and design are as they were; another study comes back as it is.
    """
    config = study.config
    if not _is_lhs(config.design, config.inner) or config.grown_from or not (folder.root / "study.yaml").is_file():
        return study
    try:
        old = read_mapping(folder.root / "study.yaml", "study")
        now = parse_yaml(study.merged(), "study")
        if any(old.get(key) != now.get(key) for key in ("factors", "design", "seed", "inner")):
            return study
        sizes = [*old.get("grown_from", ()), int(old["samples"])]
        earlier = check_sizes([s for s in sizes if s < config.samples], config.samples)
    except (InputError, KeyError, TypeError, ValueError):
        return study
    return dataclasses.replace(study, config=config.model_copy(update={"grown_from": earlier})) if earlier else study


def _is_lhs(design: str, inner: str | None) -> bool:
    return design == "lhs" or (design == "nested" and inner in (None, "lhs"))
