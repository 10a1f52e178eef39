"""The one solved study: its configuration, design and data, and what analysis and report make of them."""

from __future__ import annotations

import tempfile
from collections.abc import Iterable, Mapping
from contextlib import nullcontext
from functools import cached_property
from pathlib import Path
from typing import Any

import pandas as pd
import xarray as xr

from trackroller.analysis.deciding import decides, run_any
from trackroller.analysis.designs import Designs
from trackroller.analysis.pareto import default_objectives, pareto
from trackroller.analysis.pareto_designs import study_pareto
from trackroller.analysis.sensitivity import analyse
from trackroller.analysis.stored_study import read_results
from trackroller.analysis.table import StudyResults, StudyView
from trackroller.errors import InputError
from trackroller.numerics.threads import limited_to
from trackroller.report.build import report_text
from trackroller.report.explorer.page import write_explorer
from trackroller.report.html import write_page
from trackroller.report.workbook import write_cases
from trackroller.roller.duty import years
from trackroller.study.file.load import load_study
from trackroller.study.file.study import Study
from trackroller.study.progress import progress_bar
from trackroller.study.run import solve_study
from trackroller.study.store.seal import read_result


class Solved(StudyResults):
    """A solved study.

    `trackroller.run` and `trackroller.open_study` return it.

    Parameters
    ----------
    study : Study
        The checked study; `config` is what its file says.
    design : Design
        The rows of the design with their places and the groups of factors, as they were drawn.
    data : xarray.Dataset
        The results, over the factors of a grid or along `case`, with every input as a coordinate.

    Examples
    --------
    >>> import trackroller as tr
    >>> text = "{name: friction, factors: {friction_coefficient: {values: [0.1, 0.2]}}, contact_model: sliding}"
    >>> characters = Path("friction.yaml").write_text(text)
    >>> solved = tr.run("friction.yaml", progress=False)
    >>> solved.data.sizes["friction_coefficient"], solved.indices().attrs["method"]
    (2, 'grid')
    """

    @cached_property
    def _analysis(self) -> xr.Dataset:
        return analyse(self)

    @cached_property
    def analysed_view(self) -> StudyView:
        """Return the study as a table with its analysis, which figures and report take."""
        return self.view.analysed(self._analysis)

    def indices(self) -> xr.Dataset:
        """Return the sensitivity indices of every output, see `trackroller.analysis.sensitivity.analyse`.

        Raises
        ------
        InputError
            If no output or no factor varies.
        """
        return self._analysis

    def robustness(self) -> xr.Dataset:
        """Return life and probabilities at each design point of an inner/outer array design.

        Raises
        ------
        InputError
            If the study has another design.
        """
        if not self.design.method.points:
            remedy = "Take indices() for this study, or give the study design: inner_outer."
            raise InputError("design", self.design.method.name, "design inner_outer, which has design points", remedy)
        return self._analysis

    def pareto(
        self, objectives: Mapping[str, str] | None = None, constraints: Iterable[str] | None = None
    ) -> xr.Dataset | None:
        """Return the Pareto set of the designs, or of the cases where goals or constraints are given.

        Parameters
        ----------
        objectives : mapping of str to str, optional
            Outputs or factors, each with `min` or `max`. Default: the key `pareto` of the study file, otherwise the
            longest life with the lowest friction or pressure.
        constraints : iterable of str, optional
            Comparisons that an allowed design must meet. Default: the key `constraints` of the study file.

        Returns
        -------
        xarray.Dataset or None
            None if the study has no goals.
        """
        if objectives is None and constraints is None:
            needs_points = self.design.method.points and self.config.pareto
            return study_pareto(self.view.analysed(self._analysis if needs_points else None))
        goals = objectives or self.config.pareto or default_objectives(self.data)
        return pareto(self, goals, self.config.constraints if constraints is None else constraints)

    def best(self, count: int = 5) -> pd.DataFrame:
        """Return the best designs over all their conditions, the best one first.

        Parameters
        ----------
        count : int
            Number of designs.

        Returns
        -------
        pandas.DataFrame
            Rows of `trackroller.analysis.designs.Designs.table`; empty for a study without a valid case.

        Raises
        ------
        InputError
            If no design repeats, as in most random samples, so that designs cannot be compared.
        """
        designs = Designs.of(self.view)
        if designs is not None and not designs.comparable:
            remedy = "Give the choices as lists and the conditions as distributions with design: inner_outer."
            raise InputError("design", self.design.method.name, "designs that share their conditions", remedy)
        return pd.DataFrame() if designs is None else designs.table.head(count).copy()

    def to_table(self) -> pd.DataFrame:
        """Return one row a case: factors, other inputs that vary, and results by contact and body.

        Lives in hours are followed by lives in years if the study file has a `duty`.
        """
        table, duty = self.view.table.copy(), self.config.duty
        if duty is None:
            return table
        lives = [name for name in map(str, table) if "life" in name and "hours" in name]
        return table.assign(**{name.replace("hours", "years"): years(table[name], duty) for name in lives})

    def export(self, path: Path | str) -> Path:
        """Write `to_table` as a workbook (.xlsx) or as CSV by the name of the file, and return its path."""
        return write_cases(self.to_table(), Path(path))

    def report(self, path: Path | str) -> Path:
        """Write the report as one HTML file, or as PDF by the name of the file, and return its path."""
        return write_page(Path(path), report_text(self, self.indices))

    def explore(self, path: Path | str) -> Path:
        """Write the explorer as one HTML file that works without a network, and return its path."""
        points = self._analysis if self.design.method.points else None
        return write_explorer(self.view.analysed(points), Path(path))


def run(
    study: Study | Path | str | Mapping[str, Any],
    cores: int | None = None,
    progress: bool = True,
    results: Path | str | None = None,
) -> Solved:
    """Solve a study in this process.

    Parameters
    ----------
    study : Study, pathlib.Path, str or mapping
        The study, its file, or a mapping with the keys of a study file.
    cores : int, optional
        Number of threads; by default one for each processor.
    progress : bool
        Whether to show a progress bar.
    results : path, optional
        Parent of a folder that keeps every solved case, as `trackroller run` does: a run that was interrupted goes on
        there. By default nothing is written.

    Returns
    -------
    Solved
        The solved study.

    Raises
    ------
    InputError
        If the study is wrong.
    WorkError
        If the folder cannot be written.

    Examples
    --------
    >>> import trackroller as tr
    >>> factors = {"friction_coefficient": {"values": [0.1, 0.2]}, "roller_profile_radius": {"values": [-7, -8]}}
    >>> solved = tr.run({"name": "groove", "factors": factors, "contact_model": "sliding"}, progress=False)
    >>> float(solved.best(1)["roller_profile_radius"].iloc[0])
    -7.0
    """
    checked = study if isinstance(study, Study) else load_study(study)
    with limited_to(cores), progress_bar(checked.name, progress) as bar:
        shown: dict[str, Any] = {"started": bar.started, "progress": bar.advanced, "tell": bar.tell}
        if results is None and not decides(checked):
            return Solved(checked, checked.drawn, solve_study(checked, bar.started, bar.advanced))
        # the cases of a study that decides follow from stored results
        with tempfile.TemporaryDirectory() if results is None else nullcontext(results) as place:
            return open_study(run_any(checked, place, **shown).folder.root)


def open_study(source: xr.Dataset | Path | str, indices: Path | str | None = None) -> Solved:
    """Open a solved study.

    Parameters
    ----------
    source : xarray.Dataset, pathlib.Path or str
        Folder of a study, its file `study.nc`, the data set in such a file, or the result of `trackroller.solve` for
        the design of a study.
    indices : pathlib.Path or str, optional
        File `sensitivity.nc` with the indices of the study. By default they are computed when they are needed.

    Returns
    -------
    Solved
        The study with the same meaning as before it was written.

    Raises
    ------
    InputError
        If the source holds no solved study, or a study that this version would read differently.

    Examples
    --------
    >>> import trackroller as tr
    >>> factors = {"roller_profile_radius": {"values": [-7, -8]}}
    >>> study = {"name": "groove", "factors": factors, "contact_model": "sliding"}
    >>> ds = tr.solve(tr.load_study(study).design(), accuracy="preview")
    >>> tr.open_study(ds).data.sizes["roller_profile_radius"]
    2
    """
    results = read_results(source)
    solved = Solved(results.study, results.design, results.data)
    if indices is not None:
        vars(solved)["_analysis"] = read_result(indices)
    return solved
