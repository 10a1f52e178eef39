"""A random edit of any file of a finished study: each reading command gives the untouched study's result, or names it.

`EDITS` sets the number of edits, `EDITS_SEED` which ones; continuous integration tries 100, `make test-long` 10,000.
"""

from __future__ import annotations

import contextlib
import io
import os
import random
import re
import shutil
from pathlib import Path

import fake_solver
import pytest
import xarray as xr

from trackroller.cli.main import app, run_app
from trackroller.errors import InputError
from trackroller.report.build import build_report
from trackroller.study.file.load import load_study
from trackroller.study.run import run_study

EDITS, SEED = (int(os.environ.get(name, given)) for name, given in (("EDITS", "100"), ("EDITS_SEED", "2")))
STUDY = """
name: edited
method: lhs
samples: 12
factors: {axial_force: {uniform: [20, 50]}, friction_coefficient: {uniform: [0.1, 0.3]}}
outputs: [forces]
contact_model: sliding
chunk_size: 5
"""
COMMANDS = {
    "status": ("status", "edited"),
    "report": ("report", "edited"),
    "explore": ("explore", "edited", "-o", "explorer.html"),
    "plot": ("plot", "edited", "-o", "drawn"),
    "verify": ("verify", "results/edited"),
}


def draw_one(results, out_dir: Path) -> list[str]:
    """Write one file in place of the figures, which would take seconds; it holds the results that were read."""
    (out_dir / "one.svg").write_text(f"<svg>{float(results.data['normal_force'].sum())!r}</svg>")
    return ["one"]


@pytest.fixture(scope="module")
def original(tmp_path_factory):
    """Return a folder with a grown study and its report, for `finished` to copy."""
    place = tmp_path_factory.mktemp("original")
    with pytest.MonkeyPatch.context() as patch, contextlib.chdir(place):
        patch.setattr("trackroller.report.figures.study.draw_all", draw_one)
        for samples in ("6", "12"):
            Path("study.yaml").write_text(STUDY.replace("samples: 12", f"samples: {samples}"))
            plan = run_study(load_study("study.yaml"), solver=fake_solver.solve)
        build_report(plan.folder)
    return place


@pytest.fixture
def finished(original, tmp_path, monkeypatch):
    """Return the folder of a grown study with its report."""
    monkeypatch.setattr("trackroller.report.figures.study.draw_all", draw_one)
    monkeypatch.chdir(tmp_path)
    shutil.copytree(original, tmp_path, dirs_exist_ok=True)
    return Path("results/edited")


def edit(path: Path, chance: random.Random) -> str:
    """Edit a file as a fault or a user might, and return what was done; '' if the file did not change."""
    before = path.read_bytes()
    data, other = bytearray(before), chance.choice(sorted(p for p in path.parent.iterdir() if p.is_file()))
    kind = chance.choice(("flip", "cut", "delete", "empty", "copy", "word", "append"))
    if kind == "delete":
        path.unlink()
        return "deleted"
    place = chance.randrange(len(data)) if data else 0
    if kind == "flip" and data:
        data[place] ^= 1 << chance.randrange(8)
    elif kind == "cut":
        del data[place:]
    elif kind == "empty":
        data.clear()
    elif kind == "copy":
        data[:] = other.read_bytes()
    elif kind == "word" and (numbers := list(re.finditer(rb"\d+", before))):
        number = chance.choice(numbers)
        data[number.start() : number.end()] = b"7" * (number.end() - number.start())
    elif kind == "append":
        data += b"\n0"
    path.write_bytes(data)
    return kind if data != before else ""


def command(words) -> tuple[int, str, str]:
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = run_app(lambda: app(list(words)))
    return code, out.getvalue(), err.getvalue()


def results_of(name: str, root: Path) -> object:
    """Return what a command made of the results, without dates."""
    if name == "explore":
        return re.sub(r"\d{4}-\d\d-\d\d[T ][\d:+.Z]*", "", Path("explorer.html").read_text())
    if name == "plot":
        return Path("drawn/one.svg").read_text()
    if name == "report":
        return (root / "figures" / "one.svg").read_text(), xr.load_dataset(root / "sensitivity.nc").drop_attrs()
    return None


def same(one: object, other: object) -> bool:
    if isinstance(one, tuple) and isinstance(other, tuple):
        return one[0] == other[0] and one[1].identical(other[1])
    return one == other


def edited_studies(root: Path, count: int, seed: int) -> None:
    sound = Path(shutil.copytree(root, "sound"))
    wanted = {name: (*command(words)[:2], results_of(name, root)) for name, words in COMMANDS.items()}
    assert all(code == 0 for code, *_ in wanted.values())
    chance, files = random.Random(seed), sorted(p.relative_to(root) for p in root.rglob("*") if p.is_file())
    noticed = 0
    for _ in range(count):
        shutil.rmtree(root)
        shutil.copytree(sound, root)
        victim = chance.choice(files)
        done = edit(root / victim, chance)
        name = chance.choice(sorted(COMMANDS))
        code, out, err = command(COMMANDS[name])
        told = f"{name} after {victim} was changed ({done}): {code} {out} {err}"
        if code == 0:
            assert out == wanted[name][1] and same(results_of(name, root), wanted[name][2]), told
        else:
            noticed += 1
            named = victim.name.removesuffix(".sha256")  # without its record, a file counts as that of somebody else
            assert code in (1, 2) and named in out + err, told
            assert "Traceback" not in err and "internal error" not in err, told
            assert len(err.strip().splitlines()) <= 4, told
    assert noticed > count / 10


@pytest.mark.long
def test_a_few_edits_are_harmless_or_named(finished):
    edited_studies(finished, 40, seed=1)


@pytest.mark.long
def test_many_edits_are_harmless_or_named(finished):
    edited_studies(finished, EDITS, SEED)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["report", "explore", "plot", "status", "verify"])
@pytest.mark.parametrize("damage", ["values", "design"])
def test_altered_results_are_refused_by_name_and_never_sealed_again(finished, name, damage):
    if damage == "design":
        shutil.copy(finished / "design.nc", finished / "study.nc")
    else:
        altered = xr.load_dataset(finished / "study.nc")
        altered["normal_force"].values *= 1000
        altered.to_netcdf(finished / "study.nc")
    before = (finished / "ro-crate-metadata.json").read_bytes()
    code, out, err = command(COMMANDS[name])
    assert code == 1 and "study.nc" in out + err
    assert (finished / "ro-crate-metadata.json").read_bytes() == before
    with pytest.raises(InputError, match=r"study\.nc' was altered or damaged"):
        run_study(load_study("study.yaml"), solver=fake_solver.solve)
    (finished / "study.nc").unlink()  # as the message says
    run_study(load_study("study.yaml"), solver=fake_solver.solve)
    assert command(COMMANDS["report"])[0] == 0 and command(COMMANDS["verify"])[0] == 0


def test_an_altered_digest_in_a_crate_names_the_crate_and_not_a_sound_file(finished):
    path = finished / "ro-crate-metadata.json"
    path.write_text(re.sub(r'("sha256": ")[0-9a-f]{8}', r"\g<1>00000000", path.read_text(), count=1))
    code, out, err = command(COMMANDS["verify"])
    assert code == 1 and "ro-crate-metadata.json was altered" in err and not out
