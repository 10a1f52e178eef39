"""All figures of a gathered study and of its analysis: each is drawn only when the study has what
it needs.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

from trackroller.report.figures import sensitivity, style
from trackroller.report.figures.loads import forces_against_axial, stress_against_fit
from trackroller.report.figures.maps import life_map, regime_map
from trackroller.report.figures.pareto_front import pareto_front
from trackroller.report.figures.sn_diagram import sn_diagram
from trackroller.report.numbers import lives_in_years
from trackroller.results.pareto import given_pareto
from trackroller.results.ranking import robust_design
from trackroller.results.results import Results

OF_CASES = (life_map, stress_against_fit, sn_diagram, forces_against_axial, regime_map)


@lives_in_years
def draw_all(results: Results, out_dir: Path) -> list[style.FigureInfo]:
    """Draw the figures of a study as SVG and PNG and write their captions to `index.json`.

    Parameters
    ----------
    results : Results
        The solved study.
    out_dir : pathlib.Path
        Folder for the figures; it is created if it does not exist.

    Returns
    -------
    list of FigureInfo
        The figures drawn, in the order of the report.
    """
    infos = style.draw_all(_jobs(results), Path(out_dir))
    style.write_index(infos, Path(out_dir))
    return infos


def _jobs(results: Results) -> Iterator[Callable[[], style.Drawn]]:
    """Yield the drawings in the order of the report."""
    sens = results.analysis
    outputs = []
    if sens is not None and not robust_design(sens):
        outputs = sensitivity.main_outputs(sens)

    def of_analysis(draw: Callable[..., style.Drawn], most: int) -> list[Callable[[], style.Drawn]]:
        return [partial(draw, sens, name) for name in outputs[:most]]

    yield from (partial(draw, results) for draw in OF_CASES)
    front = given_pareto(results)
    if front is not None:
        yield partial(pareto_front, front, results)
    yield from of_analysis(sensitivity.morris_plane, 2)
    yield from of_analysis(sensitivity.interactions, 1)
