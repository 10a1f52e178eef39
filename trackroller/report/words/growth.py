"""The sentence on a sample that grew until its intervals were narrow."""

from __future__ import annotations

from trackroller.analysis.looks import looks_of
from trackroller.analysis.table import StudyView
from trackroller.report.numbers import count, plain, rounded
from trackroller.report.words.sentence import Sentence
from trackroller.study.file.goals import statistic
from trackroller.study.outputs import DEFAULTS


def quantity_words(name: str, design: str) -> str:
    """Name an entry of `until.of` in words."""
    kind, output = statistic(name) if design == "inner_outer" else ("", name)
    words = DEFAULTS[output][4] if output in DEFAULTS else plain(output)
    if design == "inner_outer":
        return f"probability of {words}" if kind == "probability" else f"log10 B10 of the {words}"
    return words


def grown(view: StudyView) -> Sentence | None:
    """Say at how many cases a sample stopped growing, why, and how wide its intervals are; None for other studies."""
    found = looks_of(view.solved) if view.results is not None else None
    if found is None:
        return None
    last = found["looks"][-1]
    wide = [
        f"no interval for the {quantity_words(name, view.solved.design.method)}"
        if width is None
        else f"± {rounded(width, 2)} for the {quantity_words(name, view.solved.design.method)} ({last['at'][name]})"
        for name, width in last["half_width"].items()
    ]
    text = f"The sample stopped growing at {count(last['cases'])} cases: {found['stopped']}. Widest 95 % interval: "
    text += f"{', '.join(wide)}, from {found['replicates']} independent replicates."
    return Sentence("grown", text, {"cases": last["cases"], "half_width": last["half_width"]})
