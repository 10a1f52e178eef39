"""Files of somebody else, links and renamed folders: no byte of them is lost, whatever command meets them.

The paths at which files and links are planted are those that a real run writes.
"""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import stat
import warnings
from pathlib import Path
from types import SimpleNamespace

import fake_solver
import pandas as pd
import pytest
import xarray as xr
from test_edits import STUDY, command, draw_one

import trackroller as tr
from trackroller.app import studies
from trackroller.errors import InputError
from trackroller.files import sha256
from trackroller.report.build import build_report
from trackroller.study.file.load import load_study
from trackroller.study.run import run_study
from trackroller.study.store import manifest, mark, put
from trackroller.study.store.digests import digest_of_text
from trackroller.study.store.folder import StudyFolder, check_for_workflow, delete_study
from trackroller.study.store.ledger import working_ledger
from trackroller.study.store.manifest import CHANGING, OUTDATED, Manifest
from trackroller.study.store.put import put_text
from trackroller.yaml_file import parse_mapping

ROOT = Path("results/edited")
BIGGER = STUDY.replace("samples: 12", "samples: 24")
FOREIGN = b"somebody's only copy of a measurement\n"
COMMANDS = (
    *(("run", "study.yaml", "-q"), ("run", "study.yaml", "-q", "--report"), ("run", "study.yaml", "--rerun-failed")),
    *(("report", "edited"), ("report", "results/edited"), ("explore", "results/edited"), ("explore", "edited")),
    *(("plot", "edited"), ("status", "edited"), ("status", "edited", "--figures"), ("repeat", "results/edited", "0")),
    *(("best", "results/edited"), ("verify", "results/edited"), ("plan", "study.yaml"), ("status", "study.yaml")),
)


IDLE = SimpleNamespace(poll=lambda: 0)  # a process that has ended


def snapshot(*places: Path) -> dict[str, tuple[int, bytes | str]]:
    """Return kind and content of everything below some folders; links are not followed."""
    found: dict[str, tuple[int, bytes | str]] = {}
    for place in places:
        for folder, folders, files in os.walk(place):
            for path in (Path(folder, name) for name in (*folders, *files)):
                kind = stat.S_IFMT(os.lstat(path).st_mode)
                content = path.read_bytes() if stat.S_ISREG(kind) else os.readlink(path) if stat.S_ISLNK(kind) else ""
                found[str(path)] = kind, content
    return found


def solve_quickly(patch: pytest.MonkeyPatch) -> None:
    patch.setattr("trackroller.roller.solver.solve", fake_solver.solve)
    patch.setattr("trackroller.report.figures.study.draw_all", draw_one)


def run(text: str = STUDY, report: bool = True) -> StudyFolder:
    Path("study.yaml").write_text(text)
    folder = run_study(load_study("study.yaml"), solver=fake_solver.solve).folder
    if report:
        build_report(folder)
    return folder


@pytest.fixture(scope="module")
def original(tmp_path_factory):
    """Return a folder with a study, its report and its explorer, for `finished` to copy."""
    place = tmp_path_factory.mktemp("original")
    with pytest.MonkeyPatch.context() as patch, contextlib.chdir(place):
        solve_quickly(patch)
        folder = run()
        tr.open_study(folder.root).explore(folder.root / "explorer.html")
        (folder.root / "plan" / ".search").touch()
    return place


@pytest.fixture
def finished(original, tmp_path, monkeypatch):
    """Return the folder of a finished study, in a working folder."""
    solve_quickly(monkeypatch)
    monkeypatch.chdir(tmp_path)
    shutil.copytree(original, tmp_path, dirs_exist_ok=True)
    return ROOT


@pytest.fixture(scope="module")
def written(original):
    """Return every file and folder that a run, its report and its explorer write, from the folder of the study."""
    root = original / ROOT
    return [path.relative_to(root) for path in sorted(root.rglob("*"))]


def plant(path: Path, content: bytes = FOREIGN) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    if path.is_dir():
        shutil.rmtree(path)
    path.write_bytes(content)


@pytest.mark.slow
def test_no_command_touches_a_folder_that_somebody_else_filled(tmp_path, monkeypatch, written, original):
    solve_quickly(monkeypatch)
    monkeypatch.chdir(tmp_path)
    Path("study.yaml").write_text(STUDY)
    for name in written:
        if not (original / ROOT / name).is_dir():
            plant(ROOT / name)
    before = snapshot(Path())
    for words in COMMANDS:
        code, out, err = command(words)
        assert code == 2, (words, out, err)
        assert snapshot(Path()) == before, words
        if words[:2] == ("run", "study.yaml"):
            assert "results/edited" in err and "and holds" in err and "that trackroller made" in err
            assert "another name" in err and "move the folder away" in err
    with pytest.raises(InputError, match="and holds"):
        tr.run("study.yaml", progress=False, results="results")
    with pytest.raises(InputError, match="and holds"):
        studies.start(STUDY)
    with pytest.raises(InputError, match="and holds"):
        studies.delete("edited", "edited")
    assert "and holds" in studies.checked(STUDY)["errors"][0]["message"]
    assert snapshot(Path()) == before


def test_one_file_at_any_path_makes_a_folder_somebody_elses(tmp_path, monkeypatch, written, original):
    monkeypatch.chdir(tmp_path)
    Path("study.yaml").write_text(STUDY)
    study = load_study("study.yaml")
    for name in written:
        if (original / ROOT / name).is_dir():
            continue
        plant(ROOT / name)
        before = snapshot(Path())
        with pytest.raises(InputError, match="and holds"), working_ledger(study):
            pass
        assert snapshot(Path()) == before
        shutil.rmtree(ROOT)


OF_REPORT = ("sensitivity.nc", "report.html", "figures", "tables", "explorer.html")


def run_into(name: Path) -> tuple[int, str]:
    """Run what writes a path of the study; return exit code and what was printed."""
    words = [("run", "study.yaml", "-q")]
    if name.parts[0] in OF_REPORT or name.stem.partition(".")[0] in ("sensitivity", "report", "figures", "tables"):
        words.append(("explore" if "explorer" in name.name else "report", "results/edited"))
    told = ""
    with warnings.catch_warnings(record=True) as warned:  # the command line prints a warning as a line
        warnings.simplefilter("always")
        for one in words:
            code, out, err = command(one)
            told += out + err
            if code:
                break
    return code, told + "".join(str(warning.message) for warning in warned)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("state", "step"), [("begun", 1), ("finished", 4), pytest.param("finished", 1, marks=pytest.mark.long)]
)
def test_a_file_at_any_path_in_a_study_stops_the_command_that_would_write_there(
    finished, original, written, state, step
):
    """In a study that has begun the manifest does not list the file; in a finished one, with another digest."""
    if state == "begun":
        shutil.rmtree(ROOT)
        StudyFolder(ROOT).create()
    else:
        Path("study.yaml").write_text(BIGGER)  # so that everything is written again
    before = Path(shutil.copytree(ROOT, "before"))
    seen = {"refused": 0, "left": 0}
    for name in list(written)[::step]:
        if (original / ROOT / name).is_dir():
            continue
        path = ROOT / name
        plant(path)
        code, told = run_into(name)
        assert path.read_bytes() == FOREIGN, name
        assert code in (0, 2), (name, told)
        if code:
            remedy = "restore its plan.json" if str(name) == "plan.json" else "Move or remove it, then start again"
            assert name.name in told and remedy in told, (name, told)
            path.unlink()
        seen["refused" if code else "left"] += 1
        if code and name.name != "plan.json" and not (name.name == "files.jsonl" and state == "finished"):
            code, told = run_into(name)
            assert code == 0, ("the remedy works", name, told)
        shutil.rmtree(ROOT)
        shutil.copytree(before, ROOT)
    assert seen["refused"] >= 4, seen


@pytest.mark.slow
def test_files_beside_ours_stay_where_they_are(finished, written):
    places = ("", "plan", "chunks", "inputs", "inputs/given", "figures", "tables")
    names = ("notes.txt", ".mine.tmp", "mine.nc", "mine.solved", "mine.lock")
    extra = [Path(place, name) for place in places for name in names]
    extra += [Path("plan", f"0123456789abcdef{end}") for end in (".nc", ".lock", ".solved")]
    extra += [Path(place, ".study.nc.4711-0123456789abcdef.tmp") for place in ("", "plan", "chunks")]
    extra += [Path("unfinished", name) for name in ("report.html", "figures/mine.png", "notes.txt")]
    extra += map(Path, (".other.tmp/inside.txt", "figures/mine.png", "inputs/limits/mine.py"))
    for name in extra:
        plant(ROOT / name)
    folder = run(BIGGER)
    tr.open_study(folder.root).explore(folder.root / "explorer.html")
    for name in extra:
        assert (ROOT / name).read_bytes() == FOREIGN, name
    assert command(("verify", "results/edited"))[0] == 0
    assert xr.load_dataset(folder.gathered).sizes["case"] == 24


@pytest.mark.slow
@pytest.mark.parametrize("words", [w for w in COMMANDS if w[0] != "plan"], ids=" ".join)
def test_links_inside_a_study_are_refused(finished, written, words):
    victim = Path(shutil.copytree(ROOT, "victim"))
    Path("study.yaml").write_text(BIGGER)
    before = Path(shutil.copytree(ROOT, "before"))
    chosen = [Path(name) for name in ("inputs", "plan", "chunks", "figures", "study.nc", "report.html", "plan.json")]
    chosen += [name for name in written if name.suffix in (".lock", ".yaml")][:4]
    for name in [*chosen, Path("new-link"), Path("chunks", "new-link.nc"), Path("figures", "new-link")]:
        path = ROOT / name
        if path.is_dir():
            shutil.rmtree(path)
        path.unlink(missing_ok=True)
        path.symlink_to((victim / name).absolute(), target_is_directory=(victim / name).is_dir())
        now = snapshot(ROOT, victim)
        code, out, err = command(words)
        assert code == 2 and "is a link" in err and str(path) in err, (name, words, out, err)
        assert snapshot(ROOT, victim) == now, (name, words)
        shutil.rmtree(ROOT)
        shutil.copytree(before, ROOT)


@pytest.mark.slow
def test_results_may_lie_elsewhere_by_a_link(tmp_path, monkeypatch):
    solve_quickly(monkeypatch)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "disk").mkdir()
    Path("results").symlink_to("disk")
    run()
    assert Path("disk/edited/report.html").is_file()
    shutil.move("disk/edited", "elsewhere")
    ROOT.symlink_to(Path("elsewhere").absolute())
    run(BIGGER)
    assert xr.load_dataset("elsewhere/study.nc").sizes["case"] == 24
    Path("theirs").mkdir()
    plant(Path("theirs/study.nc"))
    ROOT.unlink()
    ROOT.symlink_to(Path("theirs").absolute())
    code, _, err = command(("run", "study.yaml"))
    assert code == 2 and "and holds study.nc" in err and snapshot(Path("theirs")).keys() == {"theirs/study.nc"}


def test_a_link_that_leads_nowhere_is_named(tmp_path, monkeypatch):
    solve_quickly(monkeypatch)
    monkeypatch.chdir(tmp_path)
    Path("study.yaml").write_text(STUDY)
    Path("results").symlink_to("gone")
    code, _, err = command(("run", "study.yaml"))
    assert code == 2 and "results is a link to something that does not exist" in err and "File exists" not in err


@pytest.mark.parametrize("name", ["study.nc", "design.nc", "ro-crate-metadata.json", "chunk", "link", "folder link"])
def test_a_file_that_comes_during_the_run_is_kept(tmp_path, monkeypatch, name):
    """Ownership is asked again just before a file is replaced or removed, not only when the run begins."""
    solve_quickly(monkeypatch)
    monkeypatch.chdir(tmp_path)
    Path("study.yaml").write_text(STUDY)
    study, outside = load_study("study.yaml"), tmp_path / "outside"
    plant(outside / "study.nc")

    def solver(design, database=None, **options):
        path = ROOT / name
        if name == "chunk":
            for listed in (ROOT / "plan").glob("*.nc"):
                plant(ROOT / "chunks" / listed.name)
        elif name == "link" and not os.path.lexists(ROOT / "study.nc"):
            (ROOT / "study.nc").symlink_to(outside / "study.nc")
        elif name == "folder link" and not (ROOT / "plan").is_symlink():
            (ROOT / "plan").rename(tmp_path / "moved")
            (ROOT / "plan").symlink_to(outside)
        elif "link" not in name:
            plant(path)
        return fake_solver.solve(design)

    with pytest.raises(InputError):
        build_report(run_study(study, solver=solver).folder)
    assert snapshot(outside) == {str(outside / "study.nc"): (stat.S_IFREG, FOREIGN)}
    if "link" not in name:
        found = [path for path in ROOT.rglob("*") if path.is_file() and path.read_bytes() == FOREIGN]
        assert found, "in its place"


def test_only_the_scratch_folder_is_swept(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    folder = StudyFolder(ROOT).create()
    ours = Manifest(ROOT).scratch(folder.gathered)
    other = ROOT / ".mine.nc.99-0123456789abcdef.tmp"
    for path in (ours, other, folder.gathered):
        plant(path)
    put.sweep(ROOT)
    assert not ours.exists() and other.read_bytes() == folder.gathered.read_bytes() == FOREIGN


@pytest.mark.parametrize("left", ["no mark", "an empty mark", "the mark", "an empty list"])
def test_what_a_killed_process_left_is_ours_and_can_be_deleted(tmp_path, monkeypatch, left):
    """Before its mark is whole, and in the folders that it fills for later."""
    monkeypatch.chdir(tmp_path)
    folder = StudyFolder(ROOT)
    ROOT.mkdir(parents=True)
    if left == "an empty mark":
        folder.plan_file.touch()
    elif left == "the mark":
        folder.create()
    elif left == "an empty list":
        folder.create()
        Manifest(ROOT).path.touch()
    folder.create()
    Manifest(ROOT).note({"study.nc": "0"})
    assert Manifest(ROOT).contents() == {"plan/files.jsonl": [CHANGING], "study.nc": ["0"]}
    assert mark.is_study(ROOT)
    plant(Manifest(ROOT).scratch(ROOT / "figures") / "one.svg")
    delete_study(ROOT)
    assert not ROOT.exists()


def test_a_kill_between_the_digest_and_the_file_leaves_a_file_of_ours(finished, monkeypatch):
    """The manifest has both digests, so the old and the new file are ours, and the next run replaces either."""
    page = ROOT / "explorer.html"
    real = os.replace

    def killed(source, goal):
        if Path(goal) == page:
            raise SystemExit
        real(source, goal)

    monkeypatch.setattr(os, "replace", killed)
    for text in ("new page", "newer page"):  # killed twice
        with pytest.raises(SystemExit):
            put_text(page, text)
    monkeypatch.setattr(os, "replace", real)
    listed = Manifest(ROOT).contents()["explorer.html"]
    assert listed[-2:] == [digest_of_text("new page"), digest_of_text("newer page")]
    assert not manifest.digests_of(page) and manifest.why_altered(page) is None
    for content in (page.read_bytes(), b"new page", b"newer page"):
        page.write_bytes(content)
        Manifest(ROOT).check(page)
    plant(page)
    with pytest.raises(InputError, match=r"explorer\.html.*altered.*Move or remove it"):
        put_text(page, "newest page")
    assert page.read_bytes() == FOREIGN
    page.unlink()
    put_text(page, "newest page")
    assert manifest.digests_of(page) == {"explorer.html": digest_of_text("newest page")}


def test_a_line_of_the_manifest_that_was_cut_off_spoils_no_other(finished):
    folder = Manifest(ROOT)
    before = folder.contents()
    with open(folder.path, "ab") as stream:
        stream.write(b'{"file": "study.nc", "sha25')
    assert folder.contents() == before
    put_text(ROOT / "explorer.html", "new page")
    listed = folder.contents()
    assert listed.pop("explorer.html")[-1] == digest_of_text("new page")
    assert listed == {name: known for name, known in before.items() if name != "explorer.html"}


def test_without_its_manifest_a_study_is_refused_by_its_files(finished):
    """A file of somebody else in place of the manifest is named; without any, so are the files that it listed."""
    plant(Manifest(ROOT).path)
    before = snapshot(ROOT)
    code, _, err = command(("run", "study.yaml", "-q"))
    assert code == 2 and "files.jsonl' was not written by trackroller" in err and snapshot(ROOT) == before
    Manifest(ROOT).path.unlink()
    code, _, err = command(("run", "study.yaml", "-q"))
    assert code == 2 and "design.nc" in err and "study.nc" in err and "Move or remove these files" in err
    for name in ("design.nc", "study.nc", "ro-crate-metadata.json"):  # what the message says
        (ROOT / name).unlink()
    code, _, err = command(("run", "study.yaml", "-q"))
    assert code == 0, err


@pytest.mark.parametrize("name", ["figures/../../../victim", "/victim"])
def test_a_manifest_that_names_a_file_outside_removes_nothing_there(finished, tmp_path, name):
    """Somebody may send an archive of results whose manifest names other files of ours, with the right digests."""
    plant(tmp_path / "victim")
    known = str(tmp_path / "victim") if name.startswith("/") else name
    Manifest(ROOT).note({known: sha256(tmp_path / "victim")})
    command(("report", "edited"))
    run(BIGGER)
    studies.delete("edited", "edited")
    assert (tmp_path / "victim").read_bytes() == FOREIGN and not ROOT.exists()


def test_devices_and_pipes_in_the_place_of_files_stop_no_command_for_ever(finished):
    name = next((ROOT / "chunks").glob("*.nc"))
    for path in (ROOT / "study.nc", name):
        path.unlink()
        os.mkfifo(path)
    code, _, err = command(("run", "study.yaml", "-q"))
    assert code == 2 and str(name) in err and "study.nc" in err and "Move or remove these files" in err, err
    for path in (ROOT / "study.nc", name):
        path.unlink()
    code, _, err = command(("run", "study.yaml", "-q"))
    assert code == 0 and (ROOT / "study.nc").is_file() and name.is_file(), err


# a study is found by its path


@pytest.mark.long
def test_a_renamed_folder_is_read_and_written_by_its_path(finished):
    shutil.copy("study.yaml", "first.yaml")
    ROOT.rename("results/edited-old")
    run(STUDY.replace("seed: 2", "").replace("samples: 12", "samples: 9"))
    other, old = snapshot(ROOT), Path("results/edited-old")
    stored = (old / "study.nc").read_bytes()
    for words in (("results/edited-old",), ("edited-old",)):
        code, out, _ = command(("status", *words))
        assert code == 0 and "12 cases, 12 done, 0 missing" in out
        for made, by in (("report.html", "report"), ("explorer.html", "explore"), ("figures/one.svg", "plot")):
            (old / made).unlink()
            code, out, err = command((by, *words))
            assert code == 0 and "results/edited-old" in out and (old / made).is_file(), err
        code, out, err = command(("repeat", *words, "11"))
        assert code == 0 and "equal to the stored result" in out, err
        code, out, err = command(("report", *words, "-o", "cases.csv"))
        assert code == 0 and len(Path("cases.csv").read_text().splitlines()) == 13
        assert command(("report", *words, "-o", "cases.xlsx"))[0] == 0
        assert len(pd.read_excel("cases.xlsx", skiprows=[1])) == 12  # below the names stand units
        assert command(("best", *words))[0] == 0
        assert command(("plot", *words, "-o", "drawn"))[0] == 0 and Path("drawn/one.svg").is_file()
        assert command(("status", *words, "--figures"))[0] == 0
    assert command(("verify", "results/edited-old"))[0] == 0
    opened = tr.open_study("results/edited-old")
    assert opened.data.sizes["case"] == 12 and len(opened.to_table()) == 12
    assert len(pd.read_csv(opened.export("opened.csv"))) == 12
    assert command(("rerun", "results/edited-old", "--results", "again"))[0] == 0
    assert snapshot(ROOT) == other and (old / "study.nc").read_bytes() == stored


def test_a_renamed_study_goes_on_in_a_fresh_folder_under_its_name(finished, solved):
    ROOT.rename("results/edited-old")
    before = snapshot(Path("results/edited-old"))
    run(STUDY, report=False)
    assert snapshot(Path("results/edited-old")) == before and sum(solved().values()) == 12


@pytest.mark.long
def test_the_page_lists_and_resumes_a_renamed_study_under_the_name_of_its_folder(finished, monkeypatch):
    ROOT.rename("results/old")
    run(STUDY.replace("samples: 12", "samples: 9"))
    listed = {entry["name"]: entry for entry in studies.listing()}
    assert {name: entry["total"] for name, entry in listed.items()} == {"edited": 9, "old": 12}
    assert {entry["done"] for entry in listed.values()} == {9, 12}
    assert studies.headlines("old")["cases"] == 12 and studies.page_of("old", "report.html") == Path(
        "results/old/report.html"
    )
    assert parse_mapping(studies.text_of("old")["text"], "study file")["name"] == "old"
    other = snapshot(ROOT)
    started: list[str] = []
    idle = SimpleNamespace(Popen=lambda words, **more: started.append(words[-1]) or IDLE, DEVNULL=None, STDOUT=None)
    monkeypatch.setattr(studies, "subprocess", idle)
    monkeypatch.setattr(studies, "_running", {})
    assert studies.resume("old") == {"name": "old"} and started == ["old"]
    plan = run_study(load_study("studies/old.yaml"), solver=fake_solver.solve)
    assert plan.folder.root == Path("results/old") and xr.load_dataset(plan.folder.gathered).sizes["case"] == 12
    studies.delete("old", "old")
    assert not Path("results/old").exists() and snapshot(ROOT) == other


def test_a_study_whose_folder_and_name_were_changed_keeps_its_cases(finished, solved):
    ROOT.rename("results/other")
    run(STUDY.replace("name: edited", "name: other"), report=False)
    assert sum(solved().values()) == 0


def test_the_folder_of_another_study_is_refused(finished):
    ROOT.rename("results/other")
    Path("study.yaml").write_text(STUDY.replace("name: edited", "name: other").replace("[20, 50]", "[1, 5]"))
    before = snapshot(Path("results"))
    code, _, err = command(("run", "study.yaml"))
    assert code == 2 and "holds the study 'edited'" in err and "another name" in err
    assert snapshot(Path("results")) == before


@pytest.mark.parametrize("holds", ["another study", "the same study", "somebody's file"])
def test_rerun_into_an_occupied_name_is_refused(finished, holds):
    target = Path("again/edited")
    if holds == "somebody's file":
        plant(target / "notes.txt")
    else:
        text = STUDY if holds == "the same study" else STUDY.replace("[20, 50]", "[1, 5]")
        Path("other.yaml").write_text(text)
        run_study(load_study("other.yaml"), "again", solver=fake_solver.solve)
    before = snapshot(Path("again"))
    code, _, err = command(("rerun", "results/edited", "--results", "again"))
    assert code == 2 and "again/edited" in err and snapshot(Path("again")) == before
    assert command(("rerun", "results/edited", "--results", "results"))[0] == 2


def test_a_rerun_that_was_stopped_goes_on(finished, solved):
    def stop(design, database=None, **options):
        if sum(solved().values()) >= 5:
            raise KeyboardInterrupt
        return fake_solver.solve(design)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("trackroller.roller.solver.solve", stop)
        assert command(("rerun", "results/edited", "--results", "again"))[0] == 130
    assert command(("rerun", "results/edited", "--results", "again"))[0] == 0
    assert sum(solved().values()) == 12 and set(solved().values()) == {1}


def test_the_plan_does_not_tell_where_the_study_file_lies(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("study.yaml").write_text(STUDY)
    Path("elsewhere").mkdir()
    for study in (Path("study.yaml"), tmp_path / "study.yaml", Path("elsewhere/../study.yaml")):
        run_study(load_study(study), solver=fake_solver.solve)
        for path in (ROOT / "plan.json", *(path for path in (ROOT / "plan").iterdir() if path.is_file())):
            assert str(tmp_path).encode() not in path.read_bytes(), path


@pytest.mark.parametrize("dates", ["1970", "now", "falling"])
@pytest.mark.long
def test_a_run_on_a_copy_with_other_dates_changes_no_byte_of_it(finished, solved, dates):
    run(STUDY)
    before = snapshot(ROOT)
    for number, path in enumerate(sorted(ROOT.rglob("*"))):
        when = {"1970": 1.0, "now": 4e9, "falling": 2e9 - 1e5 * number}[dates]
        os.utime(path, (when, when))
    run(STUDY)
    after = snapshot(ROOT)
    assert [name for name in before if before[name] != after.get(name)] == [] and before.keys() == after.keys()
    assert sum(solved().values()) == 0 and command(("verify", "results/edited"))[0] == 0


def test_the_manifest_lists_every_result(finished):
    proved = ("plan/", "chunks/", "plan.json")
    files = {path.relative_to(ROOT).as_posix() for path in ROOT.rglob("*") if path.is_file()}
    results = {name for name in files if not name.startswith(proved)}
    assert set(Manifest(ROOT).contents()) == results | {"plan/files.jsonl"}
    for name in results:
        assert manifest.digests_of(ROOT / name) == {name: sha256(ROOT / name)}


def test_results_that_grow_leave_an_outdated_report_which_is_still_ours(finished):
    run(BIGGER, report=False)
    for name in ("report.html", "sensitivity.nc", "figures"):
        assert (ROOT / name).exists() and not manifest.digests_of(ROOT / name)
    assert not (ROOT / "ro-crate-metadata.json").exists(), "it listed earlier results"
    assert Manifest(ROOT).contents()["report.html"][-1] == OUTDATED
    run(BIGGER)
    assert manifest.digests_of(ROOT / "report.html") and command(("verify", "results/edited"))[0] == 0


def test_a_log_is_ours_by_its_name_once_it_is_listed(finished):
    log = ROOT / "logs" / "gather.log"
    log.parent.mkdir()
    assert put.claim(log) == log and Manifest(ROOT).contents()["logs/gather.log"] == [CHANGING]
    for text in ("one line\n", "another\n"):
        log.write_text(text)
        put.claim(log)
        check_for_workflow(ROOT)
    plant(ROOT / "logs" / "report.log")
    with pytest.raises(InputError, match=r"report\.log.*was not written by trackroller"):
        put.claim(ROOT / "logs" / "report.log")
    with pytest.raises(InputError, match=r"report\.log.*was not written by trackroller"):
        check_for_workflow(ROOT)


# folders that are not of this version


def other_format(record: dict) -> dict:
    return record | {"store_format": mark.STORE_FORMAT + 1}


def without_manifest(record: dict) -> dict:
    """Return the record as earlier versions wrote it."""
    return {key: value for key, value in record.items() if key != "manifest"}


@pytest.mark.slow
@pytest.mark.parametrize("change", [other_format, without_manifest])
def test_a_folder_of_another_version_is_read_and_not_written(finished, solved, change):
    record = json.loads((ROOT / "plan.json").read_text())
    record.pop("digest")
    record = change(record)
    (ROOT / "plan.json").write_text(json.dumps(record | {"digest": mark._digest_of(record)}))
    before = snapshot(Path("results"))
    for words in (("verify", "results/edited"), ("best", "results/edited"), ("report", "edited", "-o", "cases.csv")):
        code, out, err = command(words)
        assert code == 0, (words, out, err)
        assert snapshot(Path("results")) == before, words
    for words in (("run", "study.yaml"), ("report", "edited"), ("status", "edited"), ("plot", "edited")):
        code, _, err = command(words)
        last = err.strip().splitlines()[-1]
        assert code == 2 and "was made by another version" in last and "Move the folder away" in last, (words, err)
        assert snapshot(Path("results")) == before, words
    ROOT.rename("results/old")  # what the message says
    assert command(("run", "study.yaml", "-q"))[0] == 0 and sum(solved().values()) == 12


def test_a_folder_whose_mark_is_damaged_is_refused(finished, solved):
    plan = (ROOT / "plan.json").read_bytes()
    plant(ROOT / "plan.json")
    code, _, err = command(("run", "study.yaml"))
    assert code == 2 and "plan.json is damaged or somebody else's" in err and "restore its plan.json" in err
    (ROOT / "plan.json").write_bytes(plan)  # what the message says
    assert command(("run", "study.yaml", "-q"))[0] == 0 and sum(solved().values()) == 0


# other folders that the program writes


def test_the_page_deletes_only_what_it_knows_and_saves_over_no_file_of_somebody_else(finished):
    plant(ROOT / "notes.txt")
    before = snapshot(ROOT)
    with pytest.raises(InputError, match=r"did not write: notes\.txt.*Move these files away"):
        studies.delete("edited", "edited")
    assert snapshot(ROOT) == before
    (ROOT / "notes.txt").unlink()
    Path("studies").mkdir()
    plant(Path("studies/edited.yaml"))
    with pytest.raises(InputError, match=r"studies/edited\.yaml from elsewhere"):
        studies.start(STUDY)
    assert Path("studies/edited.yaml").read_bytes() == FOREIGN
    Path("studies/edited.yaml").write_text("# by hand\n" + STUDY)
    run_study(load_study("studies/edited.yaml"), solver=fake_solver.solve)
    studies._write_text("edited", BIGGER, StudyFolder(ROOT))  # the page has read the file that was run
    studies._write_text("edited", STUDY, StudyFolder(ROOT))  # and has written the one after
    assert Path("studies/edited.yaml").read_text() == STUDY
    studies.delete("edited", "edited")
    assert not ROOT.exists()


def test_figures_in_any_folder_spare_the_files_beside_and_refuse_those_in_their_place(finished):
    plant(Path("mine/notes.txt"))
    assert command(("plot", "edited", "-o", "mine"))[0] == 0
    assert command(("plot", "edited", "-o", "mine"))[0] == 0, "figures of before are replaced"
    assert Path("mine/notes.txt").read_bytes() == FOREIGN
    plant(Path("theirs/one.svg"))
    before = snapshot(Path("theirs"))
    code, _, err = command(("plot", "edited", "-o", "theirs"))
    assert code == 2 and "theirs/one.svg" in err and snapshot(Path("theirs")) == before


@pytest.mark.parametrize(
    "words",
    [
        ("solve", "-o", "mine.txt"),
        ("solve", "--report", "mine.pdf"),
        ("wear", "-o", "mine.txt", "--to", "1km"),
        ("report", "edited", "-o", "mine.xlsx"),
        ("best", "edited", "-o", "mine.html"),
    ],
    ids=" ".join,
)
def test_a_file_of_another_kind_is_not_overwritten(finished, words):
    (name,) = [word for word in words if word.startswith("mine")]
    plant(Path(name))
    code, _, err = command(words)
    assert code in (1, 2) and name in err and Path(name).read_bytes() == FOREIGN


@pytest.mark.parametrize("attributes", [{}, {"source": "trackroller 0.1.0"}])
def test_wear_goes_on_only_from_its_own_results(tmp_path, monkeypatch, attributes):
    monkeypatch.chdir(tmp_path)
    xr.Dataset({"force": ("time", [1.0, 2.0])}, attrs=attributes).to_netcdf("mine.nc")
    before = Path("mine.nc").read_bytes()
    code, _, err = command(("wear", "-o", "mine.nc", "--to", "1km"))
    assert code == 2 and "mine.nc" in err and Path("mine.nc").read_bytes() == before
    assert ("one that `trackroller wear` wrote" if attributes else "trackroller did not write") in err


def test_an_explorer_beside_a_lone_file_replaces_only_an_explorer(finished):
    shutil.copy(ROOT / "study.nc", "study.nc")
    assert command(("explore", "study.nc"))[0] == 0 and command(("explore", "study.nc"))[0] == 0
    plant(Path("explorer.html"))
    code, _, err = command(("explore", "study.nc"))
    assert code == 2 and "-o" in err and Path("explorer.html").read_bytes() == FOREIGN
