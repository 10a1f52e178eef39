"""The results of a study, as a user holds them: the solved cases and what analysis makes of
them.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import pandas as pd
import xarray as xr

from trackroller.errors import InputError
from trackroller.results import SHOWN
from trackroller.results.answer import Answer
from trackroller.results.candidates import Candidates, candidates_of
from trackroller.results.how_it_behaves import answer_how_it_behaves
from trackroller.results.lives_by_tests import ByTests, by_tests_of
from trackroller.results.pareto import pareto, study_pareto
from trackroller.results.questions import answer_of_study
from trackroller.results.sensitivity import analysis_of, indices_of
from trackroller.results.solved_cases import SolvedCases
from trackroller.results.summary import summary_of
from trackroller.roller.duty import years
from trackroller.roller.output_names import declared, is_life


@dataclass(frozen=True, eq=False)
class Results(SolvedCases):
    """The results of a study, which analysis, figures and report take.

    `trackroller.run` and `trackroller.open_study` return them. `trackroller.report(results, path)`,
    `trackroller.explore(results, path)` and `trackroller.workbook(results, path)` show them; each
    is a method, too.

    Parameters
    ----------
    study : Study
        The checked study; `config` is what its file says.
    design : Design
        The rows of the design with their places and the groups of factors, as they were drawn.
    data : xarray.Dataset
        The results, over the factors of a grid or along `case`. An input that varies is a
        coordinate; one that all cases share is an attribute, such as `axis_distance`, with its unit
        beside it (`axis_distance_units`), NaN where no case gives it.
    known_indices : xarray.Dataset, optional
        Sensitivity indices that were computed before. A data set without variables stands for a
        study that has none. By default they are computed when they are needed.
    materials_file : Path, optional
        Materials file of the study as its folder keeps it, with the fits of its materials beside
        it. By default the user's.

    Examples
    --------
    >>> from pathlib import Path
    >>> import trackroller as tr
    >>> factors = "{friction_coefficient: {values: [0.1, 0.2]}}"
    >>> text = f"{{name: friction, factors: {factors}, contact_model: sliding}}"
    >>> characters = Path("friction.yaml").write_text(text)
    >>> results = tr.run("friction.yaml", progress=False)
    >>> results.data.sizes["friction_coefficient"], results.indices().attrs["method"]
    (2, 'grid')
    """

    def __repr__(self) -> str:
        """Return ten lines on the study: cases, factors, regimes, the life that counts, and what to
        take next.
        """
        return summary_of(self)

    def indices(self) -> xr.Dataset:
        """Return the sensitivity indices of every output, see
        `trackroller.results.sensitivity.analyse`.

        Raises
        ------
        InputError
            If no output or no factor varies.
        """
        return indices_of(self)

    @property
    def analysis(self) -> xr.Dataset | None:
        """Return the sensitivity indices; None for a study that has none."""
        return analysis_of(self)

    def robustness(self) -> xr.Dataset:
        """Return life and probabilities at each design point of an inner/outer array design.

        Raises
        ------
        InputError
            If the study has another design.
        """
        if not self.design.method.points:
            remedy = "Take indices() for this study, or give the study method: inner_outer."
            raise InputError(
                "method",
                self.design.method.name,
                "method inner_outer, which has design points",
                remedy,
            )
        return self.indices()

    def pareto(
        self, objectives: Mapping[str, str] | None = None, constraints: Iterable[str] | None = None
    ) -> xr.Dataset | None:
        """Return the Pareto set of the candidates, or of the cases where goals or constraints are
        given.

        Parameters
        ----------
        objectives : mapping of str to str, optional
            Outputs or factors, each with `min` or `max`. Default: the key `pareto` of the study
            file, otherwise the longest life with the lowest friction or pressure.
        constraints : iterable of str, optional
            Comparisons that an allowed candidate must meet. Default: the key `constraints` of the
            study file.

        Returns
        -------
        xarray.Dataset or None
            None if the study has no goals.
        """
        if objectives is None and constraints is None:
            return study_pareto(self)
        if constraints is None:
            constraints = self.config.constraints
        return pareto(self, objectives or self.goals, constraints)

    def candidates(self, free: tuple[str, ...] = ()) -> Candidates | None:
        """Return the combinations of choices, each judged over its conditions.

        Parameters
        ----------
        free : tuple of str
            Conditions that count as choices here, because a goal names them.

        Returns
        -------
        Candidates or None
            See `trackroller.results.candidates.candidates_of`; None without a valid case that can
            be judged.
        """
        return candidates_of(self, free)

    @property
    def answer(self) -> Answer | None:
        """Return the answer to the study as one record of numbers and names.

        Returns
        -------
        Answer or None
            See `trackroller.results.answer.Answer`; None for a search that did not come to its end.
        """
        return answer_of_study(self)

    @property
    def by_tests(self) -> ByTests | None:
        """Return the fits of the materials of the study that hold for it.

        Returns
        -------
        ByTests or None
            See `trackroller.results.lives_by_tests.ByTests`; None without a material that was
            fitted to tests.
        """
        return by_tests_of(self)

    def best(self, count: int = 5) -> pd.DataFrame:
        """Return the best candidates over all their conditions, the best one first.

        Parameters
        ----------
        count : int
            Number of candidates.

        Returns
        -------
        pandas.DataFrame
            Rows of `trackroller.results.candidates.Candidates.table`; empty for a study without a
            valid case.

        Raises
        ------
        InputError
            If no candidate repeats, as in most random samples, so that candidates cannot be
            compared; or if the study has no lives, and no stresses of one material that rank its
            candidates.
        """
        candidates = self.candidates()
        if candidates is None:
            return pd.DataFrame()
        if not candidates.comparable:
            remedy = (
                "Give the choices as lists and the conditions as distributions with method: "
                "inner_outer."
            )
            raise InputError(
                "method", self.design.method.name, "designs that share their conditions", remedy
            )
        if not candidates.ranks:
            remedy = "Add life to outputs, and run the study again."
            raise InputError(
                "outputs", list(self.config.outputs), "lives, or stresses of one material", remedy
            )
        return candidates.table.head(count).copy()

    def to_table(self) -> pd.DataFrame:
        """Return one row a case: factors, other inputs that vary, and results by contact and body.

        Lives in hours are followed by lives in years if the study file has a `duty`.
        """
        table = self.table.copy()
        duty = self.config.duty
        if duty is None:
            return table
        lives = [name for name in map(str, table) if is_life(name) and declared(name).units == "h"]
        return table.assign(
            **{name.replace("hours", "years"): years(table[name], duty) for name in lives}
        )


for _name, _method in SHOWN.items():
    setattr(Results, _name, _method)


def shown_answer(results: Results) -> Answer:
    """Return the answer to a study; of a search without one how its candidates behave."""
    return results.answer or answer_how_it_behaves(results)
