"""All figures of a gathered study: each drawn only when the study has what it needs."""

from __future__ import annotations

import logging
import warnings
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from trackroller.report.figures import comparison as ladder
from trackroller.report.figures import style
from trackroller.report.figures.study_effects import main_effects
from trackroller.report.figures.study_life import life_against_friction
from trackroller.report.figures.study_loads import forces_against_axial, stress_against_fit
from trackroller.report.figures.study_maps import life_map
from trackroller.report.figures.study_regimes import regime_map
from trackroller.report.figures.study_view import StudyView
from trackroller.report.figures.woehler import woehler

log = logging.getLogger(__name__)
FIGURES: tuple[Callable[[StudyView], Any], ...] = (
    life_against_friction,
    stress_against_fit,
    life_map,
    woehler,
    forces_against_axial,
    main_effects,
    regime_map,
)


def draw_all(study_nc: Path, out_dir: Path) -> list[style.FigureInfo]:
    """Draw the figures of a study as SVG and PNG and write their captions to `index.json`.

    Parameters
    ----------
    study_nc : gathered study, a grid unstacked into its factors or with one dimension `case`
    out_dir : folder for the figures, made when missing

    Returns
    -------
    What was drawn, in the order of the report. A figure that cannot be drawn is left out with a logged
    warning: a picture never fails a run.
    """
    import xarray as xr

    with xr.open_dataset(study_nc) as ds:
        view = StudyView.of(ds)
        draws = [*_comparison(ds), *(partial(draw, view) for draw in FIGURES)]
    infos = []
    with style.look(), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # empty slices and all-NaN panels are expected here
        for draw in draws:
            try:
                drawn = draw()
                if drawn is None:
                    continue
                figure, info = drawn
                style.save(figure, Path(out_dir), info.name)
            except OSError:  # a full disk is not the figure's fault
                raise
            except Exception as problem:
                log.warning("figure %s was not drawn: %s", draw.func.__name__, problem, exc_info=True)
                continue
            infos.append(info)
    style.write_index(infos, Path(out_dir))
    return infos


def _comparison(ds: Any) -> list[partial[Any]]:
    """What draws the contact models side by side, where the study has several."""
    try:
        return ladder.drawers(ds)
    except Exception as problem:  # a picture never fails a run
        log.warning("the contact models were not compared: %s", problem, exc_info=True)
        return []
