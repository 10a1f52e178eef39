"""All figures of a gathered study and of its analysis: each is drawn only when the study has what it needs."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

import xarray as xr

from trackroller.analysis.pareto import study_pareto
from trackroller.analysis.table import StudyView, load_analysis
from trackroller.report.figures import style
from trackroller.report.figures.comparison import drawers
from trackroller.report.figures.factors import by_factor
from trackroller.report.figures.loads import forces_against_axial, stress_against_fit
from trackroller.report.figures.maps import life_map, regime_map
from trackroller.report.figures.pareto import pareto_front, robust_points
from trackroller.report.figures.sensitivity import (
    convergence,
    interactions,
    main_outputs,
    morris_plane,
    overview,
    tornado,
)
from trackroller.report.figures.sn_diagram import sn_diagram
from trackroller.report.words import indices as words
from trackroller.report.words.flags import FRICTION_OUTPUTS, friction_error

Draw = Callable[[], style.Drawn]
OF_CASES = (by_factor, life_map, stress_against_fit, sn_diagram, forces_against_axial, regime_map)
FRICTION_WORDS = ("friction power", "friction work", "friction energy")
OF_OUTPUTS = ((tornado, 1), (morris_plane, 2), (interactions, 1), (convergence, 1))


def draw_all(study_nc: Path, out_dir: Path, sensitivity_nc: Path | None = None) -> list[style.FigureInfo]:
    """Draw the figures of a study as SVG and PNG and write their captions to `index.json`.

    Parameters
    ----------
    study_nc : pathlib.Path
        Gathered study, as a grid over its factors or with one dimension `case`.
    out_dir : pathlib.Path
        Folder for the figures; it is created if it does not exist.
    sensitivity_nc : pathlib.Path, optional
        Analysis of the study.

    Returns
    -------
    list of FigureInfo
        The figures drawn, in the order of the report.
    """
    ds, sens = xr.load_dataset(study_nc), load_analysis(sensitivity_nc)
    view = StudyView.of(ds)
    jobs = list(_jobs(ds, view, sens))
    if sens is not None:
        before, after = _of_analysis(sens)
        jobs = [*before, *jobs, *after]
    infos = style.draw_all(jobs, Path(out_dir))
    if error := friction_error(view):
        infos = [replace(i, sentence=f"{i.sentence} {error.text}") if _is_about_friction(i) else i for i in infos]
    style.write_index(infos, Path(out_dir))
    return infos


def _is_about_friction(info: style.FigureInfo) -> bool:
    told = f"{info.name} {info.caption} {info.sentence}"
    return any(name in told for name in (*FRICTION_WORDS, *FRICTION_OUTPUTS))


def _jobs(ds: xr.Dataset, view: StudyView, sens: xr.Dataset | None) -> Iterator[Draw]:
    """Yield the drawings of the cases: contact models side by side, the study's own figures, the Pareto front."""
    yield from drawers(ds)
    yield from (partial(draw, view) for draw in OF_CASES)
    if (front := study_pareto(ds, sens)) is not None:
        yield partial(pareto_front, front, view)


def _of_analysis(sens: xr.Dataset) -> tuple[list[Draw], list[Draw]]:
    """Return the drawings of the analysis: those before and those after the figures of the cases."""
    if words.robust_design(sens):
        return [partial(robust_points, sens, str(n)) for n in sens["output"].values if "life" in str(n)], []
    parts: list[list[Draw]] = [[partial(draw, sens, name) for name in main_outputs(sens, n)] for draw, n in OF_OUTPUTS]
    first, *others = parts
    return first, [partial(overview, sens), *(draw for part in others for draw in part)]
