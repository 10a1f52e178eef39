"""Without a home or a folder for caches the program works, and it imports nothing from the working folder."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import warnings
from pathlib import Path

import pytest

from trackroller import environment
from trackroller.environment import import_nothing_from, is_writable, let_matplotlib_cache, python, temporary_cache
from trackroller.numerics import compiled

ROOT = Path(__file__).parents[1]


@pytest.fixture
def temporary(tmp_path, monkeypatch):
    """Return the temporary folder of the system in this test, without caches named in the environment."""
    place = tmp_path / "temporary"
    place.mkdir()
    monkeypatch.setattr(environment, "TEMPORARY", place)
    for name in ("NUMBA_CACHE_DIR", "MPLCONFIGDIR", "XDG_CACHE_HOME", "XDG_CONFIG_HOME"):
        monkeypatch.setenv(name, "")  # so that it is restored
        monkeypatch.delenv(name)
    return place


@pytest.fixture
def homeless(temporary, monkeypatch):
    """Let the home be a folder that nobody can write, root included."""
    monkeypatch.setenv("HOME", "/dev/null/nobody")
    return temporary


def test_a_folder_is_writable_if_a_file_can_be_written(tmp_path):
    assert is_writable(tmp_path / "new" / "folder")
    (tmp_path / "file").write_text("")
    assert not is_writable(tmp_path / "file") and not is_writable("/dev/null/x")
    assert not is_writable("~/.cache") and not Path("~").exists()


def test_matplotlib_gets_a_temporary_folder_where_there_is_no_home(homeless):
    with pytest.warns(UserWarning, match=r"matplotlib keeps its cache in .*Set MPLCONFIGDIR"):
        let_matplotlib_cache()
    place = Path(os.environ["MPLCONFIGDIR"])
    assert place.is_dir() and place.parent.parent == homeless and place.parent.stat().st_mode & 0o777 == 0o700
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        let_matplotlib_cache()  # a process that this one starts


def test_a_usable_home_is_left_alone(temporary, tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        let_matplotlib_cache()
        assert compiled.can_cache(compiled.PACKAGE)
    assert "MPLCONFIGDIR" not in os.environ and not list(temporary.iterdir())


@pytest.mark.parametrize("kind", ["link", "open to all", "file"])
def test_a_folder_that_others_prepared_holds_no_cache(temporary, tmp_path, kind):
    """Caches hold compiled code."""
    name = temporary / f"trackroller-{os.getuid() if hasattr(os, 'getuid') else 'cache'}"
    if kind == "link":
        (tmp_path / "theirs").mkdir()
        name.symlink_to(tmp_path / "theirs")
    elif kind == "file":
        name.write_text("")
    else:
        name.mkdir()
        name.chmod(0o777)
    with pytest.warns(UserWarning, match="keeps its cache"):
        place = temporary_cache("MPLCONFIGDIR", "matplotlib", "~/.config")
    assert place is not None and place.parent != name and place.is_dir()
    assert not (tmp_path / "theirs").exists() or not list((tmp_path / "theirs").iterdir())


def test_numba_compiles_without_a_cache_where_no_folder_can_be_written(homeless, tmp_path, monkeypatch):
    package = tmp_path / "package"
    package.mkdir()
    (package / "one.py").write_text("")
    (package / "__pycache__").write_text("")
    with pytest.warns(UserWarning, match="numba keeps its cache in"):
        assert compiled.can_cache(package)
    assert Path(os.environ["NUMBA_CACHE_DIR"]).is_relative_to(homeless)
    assert str(compiled.numba.config.CACHE_DIR) == os.environ["NUMBA_CACHE_DIR"]
    monkeypatch.setitem(vars(compiled.numba.config), "CACHE_DIR", "")
    monkeypatch.setenv("NUMBA_CACHE_DIR", "/dev/null/x")
    monkeypatch.setattr(environment, "_temporary_folder", lambda: None)
    with pytest.warns(UserWarning, match="compiles them anew"):
        assert not compiled.can_cache(package)


@pytest.mark.long
def test_a_read_only_package_solves_without_a_home(tmp_path):
    """As in a container that runs as any user."""
    site, place = tmp_path / "site", tmp_path / "place"
    shutil.copytree(ROOT / "trackroller", site / "trackroller", ignore=shutil.ignore_patterns("__pycache__"))
    for folder in {file.parent for file in (site / "trackroller").rglob("*.py")}:
        (folder / "__pycache__").write_text("")  # root could write into a folder without rights
    place.mkdir()
    bare = {name: text for name, text in os.environ.items() if not name.startswith(("XDG", "NUMBA", "MPL", "HOME"))}
    env = bare | {"PYTHONPATH": str(site), "HOME": "/dev/null/x", "TMPDIR": str(tmp_path)}
    words = ["solve", "--set", "contact_model=sliding", "--set", "outputs=forces"]
    command = [sys.executable, "-m", "trackroller.cli", *words]
    done = subprocess.run(command, cwd=place, env=env, capture_output=True, text=True, timeout=900)
    assert done.returncode == 0 and "numba keeps its cache in" in done.stderr and "Traceback" not in done.stderr
    assert not list(place.iterdir()) and list(tmp_path.glob("trackroller-*/numba/**/*.nbi"))


def test_the_working_folder_leaves_the_path(tmp_path, monkeypatch):
    monkeypatch.setattr(sys, "path", ["", str(tmp_path), str(tmp_path / "." / ""), str(ROOT), "/usr/lib"])
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(["", str(tmp_path), "relative", str(ROOT)]))
    monkeypatch.setenv("PYTHONSAFEPATH", "")
    monkeypatch.chdir(tmp_path)
    import_nothing_from(tmp_path)
    assert sys.path == [str(ROOT), "/usr/lib"] and os.environ["PYTHONSAFEPATH"] == "1"
    assert os.environ["PYTHONPATH"].split(os.pathsep) == [str(tmp_path / "relative"), str(ROOT)]


def test_a_process_of_its_own_imports_nothing_from_the_working_folder(tmp_path):
    for name in ("portalocker", "typer", "numpy", "trackroller"):
        (tmp_path / f"{name}.py").write_text("raise SystemExit('imported from the working folder')\n")
    for words in (python("trackroller.cli"), [sys.executable, "-m", "trackroller.cli"]):
        if words[1] == "-m":
            (tmp_path / "trackroller.py").unlink()  # Python itself imports it before a line of this program runs
        done = subprocess.run([*words, "--version"], cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode == 0 and done.stdout.startswith("trackroller"), done.stderr
