"""How far a study is: done, missing, failed by reason and by factor level, and the time left."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.errors import InputError, nearest
from trackroller.materials.yaml_file import read_mapping
from trackroller.parameters import REGIMES
from trackroller.study import store
from trackroller.study.config import load_study, parse_study
from trackroller.study.cost import measured_rate, rate
from trackroller.study.design.build import build, draw
from trackroller.study.design.growth import with_history
from trackroller.study.design.levels import in_words
from trackroller.study.plan import identify, study_folder

if TYPE_CHECKING:
    from trackroller.study.config import Study


@dataclass
class Status:
    """Numbers of cases of a study; `by_level` maps factor and level to failed cases."""

    total: int
    done: int = 0
    failed: int = 0
    regimes: dict[str, int] = field(default_factory=dict)
    by_reason: dict[str, int] = field(default_factory=dict)
    by_level: dict[tuple[str, str], int] = field(default_factory=dict)
    seconds_left: float = 0.0
    gathered: bool = False
    corrupt: list[str] = field(default_factory=list)

    @property
    def missing(self) -> int:
        """Cases not solved yet."""
        return self.total - self.done


def find_study(study: str, results: Path | str = "results") -> Study:
    """A study from the path of its file, its results folder, or its name."""
    path = Path(study)
    if path.suffix in (".yaml", ".yml") or path.is_file():
        return load_study(path)
    folder = path if (path / "study.yaml").is_file() else Path(results) / study
    if not (folder / "study.yaml").is_file():
        known = sorted(p.parent.name for p in Path(results).glob("*/study.yaml"))
        close = nearest(study, known)
        allowed = f"a study file, or a study in {results}/: {', '.join(known) or 'none yet'}"
        raise InputError("study", study, allowed, f"Did you mean '{close}'?" if close else "")
    return parse_study(read_mapping(folder / "study.yaml", "study"), folder / "study.yaml")


def status_of(study: Study, results: Path | str = "results") -> Status:
    """State of a study from the files it has; nothing is written."""
    folder = study_folder(study.name, results)
    study = with_history(study, folder)
    sampled = draw(study)
    design = build(study, sampled)
    cases = identify(study, design)
    status = Status(len(cases), gathered=folder.gathered.is_file())
    regime: dict[bytes, int] = {}
    reasons: dict[str, str] = {}
    files = [*(folder.root / "store").glob("*.nc"), *(folder.root / "store").glob("*.parts/*.nc")]
    for path in files:
        try:
            block = store.read(path)
        except store.CorruptFile as exc:
            status.corrupt.append(str(exc))
            continue
        except FileNotFoundError:  # a running process has just moved it
            continue
        codes = block.columns("regime")[:, 0].astype(int).tolist()
        regime.update(zip(block.cases.tolist(), codes, strict=True))
        reasons |= block.reasons
    found = np.array([regime.get(case, -1) for case in cases.tolist()])
    status.done = int((found >= 0).sum())
    status.failed = int((found == store.FAILED).sum())
    status.regimes = {name: int((found == code).sum()) for code, name in enumerate(REGIMES)}
    failed = np.flatnonzero(found == store.FAILED)
    status.by_reason = dict(Counter(reasons.get(cases[i].decode(), "unknown") for i in failed).most_common())
    for name, factor in sampled.factors.items():
        if factor.discrete:
            counts = Counter(_told(name, sampled.columns[name][i]) for i in failed)
            status.by_level |= {(name, level): count for level, count in counts.most_common()}
    speed = measured_rate(folder.root / "store") or rate(study.options)
    status.seconds_left = status.missing / speed
    return status


def _told(name: str, level: Any) -> str:
    """A level with all its digits, so that neighbours are told apart."""
    return f"{level:.10g}" if isinstance(level, float) else in_words(name, level)
