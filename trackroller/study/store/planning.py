"""Make the plan of a study and keep it while processes work from it.

Every process that works from a plan holds the study's lock together with the others. Only the sole holder of the lock
repairs the folder and may change the plan.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from trackroller.errors import InputError, WorkError
from trackroller.files import try_lock
from trackroller.study.file.load import without_former
from trackroller.study.store import ownership
from trackroller.study.store.folder import StudyFolder, Tell, unheard, wait_for_lock
from trackroller.study.store.inputs import store_inputs
from trackroller.study.store.inventory import Inventory, forget_failed, take_inventory
from trackroller.study.store.plan import Plan, new_plan, read_plan, record_of, sound_plan, study_folder, unused_cases
from trackroller.study.store.provenance import now
from trackroller.study.store.seal import discard
from trackroller.yaml_file import parse_mapping

if TYPE_CHECKING:
    from trackroller.study.file.study import Study


@contextlib.contextmanager
def working_plan(
    study: Study, results: Path | str = "results", *, tell: Tell = unheard, rerun_failed: bool = False
) -> Iterator[Plan]:
    """Plan a study and keep other processes from changing the plan.

    Parameters
    ----------
    study : Study
        The checked study.
    results : path
        Parent of the study's folder.
    tell : callable
        Receives one line for each event that the user should read, such as a damaged file.
    rerun_failed : bool
        Remove the failed cases, so that they are solved again.

    Yields
    ------
    Plan
        The plan, which stays as it is until the context ends.

    Raises
    ------
    InputError
        If the design holds an invalid case, the results folder cannot be a folder or is somebody else's, or a file of
        somebody else stands in the place of a result.
    WorkError
        If another process works on another version of the study, an input was edited after the study was loaded, or the
        folder cannot be written.
    """
    folder = study_folder(study.name, results).create()
    with open(folder.lock, "rb+") as lock:
        plan = _make_plan(study, folder, tell, rerun_failed) if try_lock(lock) else None
        wait_for_lock(lock, shared=True)
        if plan is None and not rerun_failed:  # another process has planned
            plan = read_plan(study, folder)
        if plan is None:
            raise WorkError(
                f"study '{study.name}': another process is solving it, from another version of the study file or "
                f"of the materials. Wait until that process ends, or stop it; then start again: {folder.root} keeps "
                "every finished case. To solve both versions at once, give this one another name."
            )
        yield plan


def _make_plan(study: Study, folder: StudyFolder, tell: Tell, rerun_failed: bool) -> Plan:
    """Remove damaged files, and plan anew unless the plan on the disk accounts for every case."""
    if folder.of_another_solver:
        tell(f"the solver's code has changed since {folder.root} was planned: all its cases are solved anew")
    _check_same_study(study, folder)
    for path in (folder.design, folder.gathered, folder.root / ownership.METADATA):
        ownership.make_way(path, folder.root, lambda line: tell(f"{line}, and made anew"))
    inventory = _sound_inventory(folder, tell)
    if rerun_failed:
        tell(f"{forget_failed(folder, inventory)} failed cases are solved again")
        inventory = take_inventory(folder)
    plan, damaged = sound_plan(study, folder, inventory)
    for line in damaged:
        tell(line)
    if plan is None:
        plan = new_plan(study, folder, inventory)
        if inventory.paths and (
            unused := unused_cases(study, folder, inventory, inventory.find(plan.cases.fingerprints))
        ):
            tell(unused)
        discard(folder.design)
    _keep(plan, tell)
    return plan


def _check_same_study(study: Study, folder: StudyFolder) -> None:
    """Refuse the folder of another study that was given the name of this one; a study may have been renamed itself."""
    earlier, now = without_former(folder.earlier()), parse_mapping(study.merged(), "study file")
    other = earlier.get("name", study.name)
    if other != study.name and any(earlier.get(key) != now.get(key) for key in ("base", "factors")):
        remedy = "Give this study another name, choose another --results, or rename the folder."
        wrong = f"holds the study '{other}', which has other inputs"
        raise InputError("results folder", str(folder.root), "a folder of this study", remedy, wrong)


def _sound_inventory(folder: StudyFolder, tell: Tell) -> Inventory:
    """Return the solved cases after damaged files are moved away and temporary files are removed."""
    inventory = take_inventory(folder)
    for path, why in inventory.corrupt.items():
        kept = ownership.set_aside(folder.root, path)
        tell(f"corrupt results, their cases are solved again, and the file is kept as {kept}: {why}")
    ownership.sweep(folder.root)
    return inventory


def _keep(plan: Plan, tell: Tell) -> None:
    """Write the record of a plan after its inputs, and remove the files of earlier plans."""
    folder, earlier = plan.folder, plan.folder.record()
    record = record_of(plan, store_inputs(plan.study, folder))
    record["planned"] = earlier.get("planned", now()) if earlier.get("study") == record["study"] else now()
    if record != earlier:
        folder.write_record(record, tell)
    for path in folder.lock.parent.iterdir():
        of_chunk = path.suffix in (".nc", ".solved", ".lock") and not path.name.startswith(".")
        if of_chunk and path.stem not in plan.chunks:
            ownership.remove(path, folder.root)
    for name in plan.chunks:
        mark = folder.mark(name)
        ownership.make_way(mark, folder.root)
        if not folder.chunk(name).is_file():
            mark.unlink(missing_ok=True)
        elif not mark.is_file():  # a mark keeps its date, on which the workflow's rules depend
            mark.touch()
