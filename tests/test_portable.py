"""Nothing needs Linux: calls that other systems lack stand where a test for them stands beside."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
MODULES = {"fcntl", "resource", "pwd", "grp", "termios", "tty", "pty", "posix", "syslog"}
CALLS = {
    "os": "fork forkpty statvfs fstatvfs posix_fallocate posix_fadvise sched_getaffinity getuid geteuid getgid getegid "
    "chown lchown fchmod killpg getpgid getpgrp setsid setpgid mkfifo mknod uname wait3 wait4 nice lockf pread pwrite "
    "openpty ttyname O_DIRECTORY O_NOFOLLOW O_NONBLOCK",
    "signal": "SIGKILL SIGHUP SIGUSR1 SIGUSR2 SIGALRM SIGQUIT SIGPIPE SIGCHLD alarm setitimer pause sigwait "
    "pthread_sigmask pthread_kill sigtimedwait ITIMER_REAL",
}
# file -> calls of it that a `hasattr` beside them guards
GUARDED = {
    "trackroller/files.py": {"posix_fallocate", "setitimer", "SIGALRM", "ITIMER_REAL", "sched_getaffinity"},
    "trackroller/environment.py": {"getuid"},
}
ALARM = {"SIGALRM", "ITIMER_REAL"}  # where `setitimer` is
OPTIONAL = {"snakemake", "distributed"}  # of the extras `workflow` and `cluster`; the core runs without them
# what another system lacks fails here as it would there; the library that locks files has its own way there
WITHOUT = """
import builtins, os, sys
plain = builtins.__import__
def without(name, globals=None, locals=None, fromlist=(), level=0):
    ours = str((globals or {{}}).get("__name__", "")).startswith("trackroller")
    if name in {optional!r} or name in {modules!r} and ours:
        raise ModuleNotFoundError(name)
    return plain(name, globals, locals, fromlist, level)
builtins.__import__ = without
for name in {calls!r}.split():
    if hasattr(os, name):
        delattr(os, name)
import signal
del signal.setitimer, signal.SIGALRM, signal.ITIMER_REAL
from trackroller.cli.main import app, run_app
sys.exit(run_app(lambda: app(sys.argv[1:])))
"""
STUDY = """name: small
factors:
  friction_coefficient: {values: [0.1, 0.3]}
  axial_force: {values: [0, 30]}
contact_model: sliding
accuracy: preview
outputs: [forces, peak_stress, life]
"""


def posix_only(tree: ast.AST) -> set[str]:
    """Return the modules and calls of a file that other systems lack."""
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found |= {name.name for name in node.names} & MODULES
        elif isinstance(node, ast.ImportFrom):
            names = {name.name for name in node.names}
            found |= {node.module} & MODULES | names & set(CALLS.get(node.module or "", "").split())
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            found |= {node.attr} & set(CALLS.get(node.value.id, "").split())
    return found


@pytest.mark.slow
def test_calls_that_other_systems_lack_stand_guarded_in_one_file():
    found = {}
    for path in sorted((ROOT / "trackroller").rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        if calls := posix_only(ast.parse(text)):
            found[path.relative_to(ROOT).as_posix()] = calls
            assert all(re.search(rf'hasattr\((?:os|signal), "{call}"\)', text) for call in calls - ALARM), path
    assert found == GUARDED


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("import fcntl", {"fcntl"}),
        ("from resource import getrusage", {"resource"}),
        ("from signal import SIGKILL", {"SIGKILL"}),
        ("import os\nos.fork()", {"fork"}),
        ("import os\nos.replace('a', 'b')", set()),
    ],
)
def test_the_check_finds_what_other_systems_lack(text, names):
    assert posix_only(ast.parse(text)) == names


@pytest.mark.long
def test_a_study_is_run_and_reported_without_the_calls_of_linux_and_without_extras(tmp_path):
    """Run, report and verify, with everything removed from `os` that Windows has not, and without Snakemake."""
    kept = "O_DIRECTORY O_NOFOLLOW O_NONBLOCK fork forkpty nice uname getuid geteuid"  # Python's own library uses these
    calls = " ".join(name for name in CALLS["os"].split() if name not in kept.split())
    program = WITHOUT.format(modules=sorted(MODULES), optional=sorted(OPTIONAL), calls=calls)
    (tmp_path / "small.yaml").write_text(STUDY, encoding="utf-8")
    for words in (["run", "small.yaml", "-q"], ["report", "small"], ["verify", "results/small"]):
        done = subprocess.run([sys.executable, "-c", program, *words], cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
    assert (tmp_path / "results" / "small" / "report.html").is_file()


def test_large_room_is_reserved_where_the_system_has_no_call_for_it(tmp_path, monkeypatch):
    from trackroller import files

    monkeypatch.delattr(files.os, "posix_fallocate", raising=False)
    with open(tmp_path / "room", "w+b") as file:
        files.reserve(file, (1 << 20) + 7)
    assert (tmp_path / "room").stat().st_size == (1 << 20) + 7


def test_text_files_have_the_newlines_of_every_system(tmp_path):
    from trackroller.files import write_text

    write_text(tmp_path / "a.txt", "one\ntwo\n")
    assert (tmp_path / "a.txt").read_bytes() == b"one\ntwo\n"


@pytest.mark.parametrize("name", ["con", "NUL", "aux.v2", "com1", "lpt9.x.y"])
def test_a_study_with_the_name_of_a_device_of_windows_is_refused(name):
    from trackroller.errors import InputError
    from trackroller.study.file.config import check_name

    with pytest.raises(InputError, match="is a device of Windows"):
        check_name(name)
    assert check_name(f"{name[0]}-console") == f"{name[0]}-console"


def test_files_with_windows_newlines_and_a_byte_order_mark_give_the_same_cases(tmp_path):
    """Study, table of cases and measured profile as editors on Windows save them have the same fingerprints."""
    from trackroller.study.file.load import load_study
    from trackroller.study.store.fingerprint import StudyCases

    profile = "x,z\n" + "".join(f"{x / 2},{x * x / 52}\n" for x in range(-8, 9))
    files = {
        "study.yaml": "name: small\ndesign: table\ntable: tables/cases.csv\ncontact_model: sliding\nnormal: halfspace\n"
        "outputs: [forces]\nbase:\n  guide_profile: {file: points.csv}\n",
        "tables/cases.csv": "axial_force,friction_coefficient\n20,0.1\n30,0.2\n",
        "points.csv": profile,
    }
    prints = []
    for place, mark, newline in (("linux", "", "\n"), ("windows", "\ufeff", "\r\n")):
        for name, text in files.items():
            path = tmp_path / place / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes((mark + text.replace("\n", newline)).encode())
        prints.append(StudyCases(load_study(tmp_path / place / "study.yaml")).fingerprints.tolist())
    assert prints[0] == prints[1] and len(set(prints[0])) == 2


def test_only_empty_files_are_locked(tmp_path, monkeypatch):
    """On Windows a lock keeps every reader out, even the process that holds it."""
    import os

    import fake_solver
    import portalocker

    from trackroller.study.file.load import parse_study
    from trackroller.study.run import run_study

    plain, sizes = portalocker.lock, []

    def lock(stream, flags):
        sizes.append(os.fstat(stream.fileno()).st_size)
        plain(stream, flags)

    monkeypatch.setattr(portalocker, "lock", lock)
    factors = {"axial_force": {"values": [20.0, 30.0]}, "friction_coefficient": {"values": [0.1, 0.2]}}
    study = {"name": "small", "factors": factors, "contact_model": "sliding", "outputs": ["forces"]}
    run_study(parse_study(study), tmp_path, solver=fake_solver.solve)
    assert len(sizes) >= 5 and set(sizes) == {0}
