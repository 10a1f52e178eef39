"""Let the sample of a study grow by doublings until its intervals are narrow, the key `until`.

A step solves all cases of the sample, looks at the intervals, and doubles every replicate; an
inner/outer design grows at the design points whose intervals are too wide. Each step is a design of
the study whose cases go through plan and chunks. A run that was stopped therefore repeats its looks
from the stored cases.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from trackroller.results.interim_looks import UNTIL, look
from trackroller.results.stored_study import solved_results
from trackroller.study.cost import duration
from trackroller.study.design.growth import doubled
from trackroller.study.file.study import Study
from trackroller.study.run import Runner
from trackroller.study.store.fingerprint import StudyCases
from trackroller.study.store.folder import StudyFolder, Tell
from trackroller.study.store.gather import gather
from trackroller.study.store.ledger import Ledger, study_folder, working_ledger


class Growing:
    """A study that grows, with the looks so far.

    Parameters
    ----------
    study : Study
        The checked study with the key `until`, at its first look.
    folder : StudyFolder
        Its folder.
    tell : callable
        Receives a line for each look.
    """

    def __init__(self, study: Study, folder: StudyFolder, tell: Tell) -> None:
        assert study.config.until is not None
        self.study = study
        self.until = study.config.until
        self.tell = tell
        self.folder = folder
        self.looks: list[dict[str, Any]] = []

    def advance(self) -> str:
        """Look at every solved step; return why the study stops, '' if its step has cases to
        solve.
        """
        while True:
            ledger = Ledger(StudyCases(self.study), self.folder)
            if (ledger.state_number < 0).any():
                return ""
            last_look = look(solved_results(ledger))
            self.looks.append(last_look)
            widest = ", ".join(f"{name} ± {_text(last_look, name)}" for name in self.until.of)
            cases = f"{last_look['cases']} cases"
            self.tell(f"look {len(self.looks)}: {cases}, widest 95 % interval: {widest}")
            unsure = last_look.get("unsure")
            if unsure:
                self.tell(
                    f"wider than wanted at {len(unsure)} of {len(self.study.drawn.points)} "
                    "design points"
                )
            larger = doubled(self.study, unsure)
            why = self._why(larger, ledger)
            if why:
                self.tell(f"stopped: {why}")
                return why
            self.study = larger

    def _why(self, larger: Study, ledger: Ledger) -> str:
        """Return why the study stops at its last look, '' if it goes on with the larger sample."""
        last_look = self.looks[-1]
        until = self.until
        widths = last_look["half_width"].values()
        if last_look["empty"]:
            names = " or ".join(last_look["empty"])
            return f"no case gives a valid {names}, so nothing is left to decide"
        if self._is_decided():
            return "every share is clear of the share that the requirement wants"
        if all(width is not None and width <= until.half_width for width in widths):
            return f"the intervals asked for are narrower than ± {until.half_width:g}"
        if last_look["constant"]:
            return f"{' and '.join(last_look['constant'])} does not vary, so it has no index"
        many = larger.drawn.size
        if many > until.at_most:
            return f"the next step has {many} cases, and at_most is {until.at_most}"
        if until.hours is None:
            return ""
        missing = int((ledger.find(StudyCases(larger).fingerprints) < 0).sum())
        needed = ledger.hours * missing / max(1, ledger.states.sizes["case"])
        if missing and ledger.hours + needed > until.hours:
            spent = duration(3600 * ledger.hours)
            left = f"about {duration(3600 * needed)} of solving"
            return f"{spent} of the {until.hours:g} h are spent, and the next step needs {left}"
        return ""

    def _is_decided(self) -> bool:
        """Return whether the last look tells of every design point whether it meets every
        requirement of `until`.
        """
        decided = self.looks[-1].get("decided", {})
        points = 0
        if self.study.config.method.points:
            points = len(self.study.drawn.points)
        return bool(points) and all(decided.get(name, 0) == points for name in self.until.of)

    def record(self, why: str) -> dict[str, str]:
        """Return the attribute of `study.nc` with the looks."""
        settings = {"half_width": self.until.half_width, "replicates": self.until.replicates}
        return {UNTIL: json.dumps(settings | {"stopped": why, "looks": self.looks})}


def _text(look: dict[str, Any], name: str) -> str:
    width = look["half_width"][name]
    if width is None:
        return "unknown"
    return f"{width:.2g} ({look['at'][name]})"


def grow_study(study: Study, results: Path | str = "results", **how: Any) -> Ledger:
    """Let the sample of a study grow until its intervals are narrow, and gather the cases.

    Parameters
    ----------
    study : Study
        The checked study with the key `until`.
    results : path
        Parent of the study's folder.
    **how
        Other fields of `trackroller.study.run.Runner`.

    Returns
    -------
    Ledger
        The ledger of the last step. The attribute `until` of `study.nc` holds the looks and why it
        stopped (JSON).

    Raises
    ------
    InputError
        If the study is wrong.
    WorkError
        If the work cannot be completed; every finished chunk is kept.
    """
    with Runner(results, **how) as runner, runner.deciding(study) as folder:
        growing = Growing(study, folder, runner.tell)
        while not (why := growing.advance()):
            with runner.solved(growing.study):
                pass
        with runner.solved(growing.study) as ledger:
            gather(ledger, runner.tell, growing.record(why))
    return ledger


def next_step(study: Study, results: Path | str, tell: Tell) -> dict[str, Any]:
    """Look at the solved steps of a study and plan the next one, for a workflow.

    Returns
    -------
    dict
        `stopped`, why the study stops ('' if it goes on), and `chunks`, the names of the chunks
        that are not solved.
    """
    growing = Growing(study, study_folder(study.name, results).create(), tell)
    why = growing.advance()
    if why:
        return {"stopped": why, "chunks": []}
    with working_ledger(growing.study, results, tell=tell) as ledger:
        return {"stopped": "", "chunks": ledger.open}
