"""Signals at random moments: an interrupted or killed command goes on when it is started again, and nothing is lost.

An interrupted one ends with one sentence that says what is kept. `tests/workflow/test_workflow.py` kills the workflow.
"""

from __future__ import annotations

import _imp
import gc
import importlib.util
import os
import random
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections import Counter
from importlib.machinery import ExtensionFileLoader

import pytest
import xarray as xr

from trackroller.files import interrupts_wait_for_files

STUDY = """
name: stopped
factors:
  axial_force: {linspace: [0, 60, 60]}
  friction_coefficient: {linspace: [0.05, 0.4, 40]}
outputs: [forces, contact]
contact_model: sliding
chunk_size: 400
"""
LARGE = """
name: large
method: lhs
samples: 100000
factors: {axial_force: {uniform: [20, 50]}, friction_coefficient: {uniform: [0.1, 0.3]}}
outputs: [forces]
contact_model: sliding
"""
PROGRAM = [sys.executable, "-m", "trackroller.cli"]
# Each phase of a study: what is deleted before a try, and the command. Solving starts afresh every eighth try.
PHASES = {
    "solve": ((), ("run", "study.yaml", "-q")),
    "gather": (("study.nc",), ("run", "study.yaml", "-q")),
    "analysis, figures and report": (("sensitivity.nc", "report.html"), ("report", "stopped")),
    "everything": (("chunks", "study.nc"), ("run", "study.yaml", "-q", "--report")),
    "explore": (("explorer.html",), ("explore", "stopped")),
    "plan": ((), ("plan", "large.yaml")),
}
# killed phases; workers are processes of their own, which are killed with the main process
KILLED = {name: PHASES[name] for name in ("solve", "gather")} | {
    "solve by workers": (("chunks", "study.nc"), ("run", "study.yaml", "-q", "--scheduler", "local")),
}
# A shell reports 130 for both codes. CPython treats an interrupt as unhandled if it passes through `exec` or `eval` of
# a text, as in the definition of a data class. At its end, CPython then sends the signal to itself.
STOPPED_CODES = (130, -signal.SIGINT)


def command(place, words, results):
    """Run a command to its end, require that it succeeds, and return its duration [s]."""
    begun = time.monotonic()
    done = subprocess.run([*PROGRAM, *words, "--results", results], cwd=place, capture_output=True, text=True)
    assert done.returncode == 0, f"{words}: {done.stderr}"
    return time.monotonic() - begun


def stopped_after(seconds, place, words, results, sent):
    """Start a command, send it a signal (SIGKILL to its workers too), and return its exit code and its stderr."""
    words, null = [*PROGRAM, *words, "--results", results], subprocess.DEVNULL
    process = subprocess.Popen(words, cwd=place, stdout=null, stderr=subprocess.PIPE, text=True, start_new_session=True)
    time.sleep(seconds)
    if process.poll() is None:
        (os.killpg if sent == signal.SIGKILL else os.kill)(process.pid, sent)
    try:
        _, told = process.communicate(timeout=120)
    except subprocess.TimeoutExpired:
        process.kill()
        pytest.fail(f"{words} hangs after {sent.name} at {seconds} s")
    return process.returncode, told


def lay_out(place, phases):
    """Write the studies and return how long each phase takes without an interrupt [s]."""
    (place / "study.yaml").write_text(STUDY)
    (place / "large.yaml").write_text(LARGE)
    command(place, ("run", "study.yaml", "-q", "--report"), "calm")
    shutil.copytree(place / "calm", place / "rough")
    lengths = {}
    for phase, (deleted, words) in phases.items():
        remove(place / "rough", ("chunks", "study.nc") if phase == "solve" else deleted)
        lengths[phase] = command(place, words, "rough")
    return lengths


def remove(results, names):
    for path in (results / "stopped" / name for name in names):
        shutil.rmtree(path) if path.is_dir() else path.unlink(missing_ok=True)


def stopped_runs(place, tries, seed, sent, phases):
    lengths = lay_out(place, phases)
    chance, stopped = random.Random(seed), Counter()
    for number in range(tries):
        phase = list(phases)[number % len(phases)]
        deleted, words = phases[phase]
        again = phase == "solve" and number % (8 * len(phases)) == 0
        remove(place / "rough", ("chunks", "study.nc") if again else deleted)
        if words[0] in ("report", "explore") and not (place / "rough/stopped/study.nc").is_file():
            command(place, PHASES["everything"][1], "rough")  # makes deleted results again, too
        code, told = stopped_after(chance.uniform(0.1, 1.05) * lengths[phase], place, words, "rough", sent)
        assert code in (0, *(STOPPED_CODES if sent == signal.SIGINT else (-sent,))), f"{phase}: {code} {told}"
        assert "Traceback" not in told, f"{phase}: {told}"
        stopped[phase] += code != 0
        if code == 0:  # it ended before the signal: the machine has become faster
            lengths[phase] *= 0.7
        if code in STOPPED_CODES:
            assert told.strip().splitlines()[-1].startswith("trackroller: stopped. The finished chunks"), told
    command(place, ("run", "study.yaml", "-q", "--report"), "rough")
    for words in (words for _, words in phases.values() if words[0] in ("explore", "plan")):  # no part of `run`
        command(place, words, "rough")
    subprocess.run([*PROGRAM, "verify", "rough/stopped"], cwd=place, check=True, capture_output=True)
    for name in ("study.nc", "sensitivity.nc"):
        sets = [xr.load_dataset(place / results / "stopped" / name).drop_attrs() for results in ("rough", "calm")]
        xr.testing.assert_identical(*sets)
    assert not [path for path in (place / "rough/stopped").rglob(".*.tmp")], "temporary files are removed"
    assert sum(stopped.values()) >= tries / 4, stopped


@pytest.mark.long
@pytest.mark.parametrize(("sent", "phases"), [(signal.SIGINT, PHASES), (signal.SIGKILL, KILLED)])
def test_commands_stopped_in_any_phase_go_on(tmp_path, sent, phases):
    tries = int(os.environ.get("INTERRUPT_TRIES", str(len(phases))))  # each phase once
    stopped_runs(tmp_path, tries, int(os.environ.get("INTERRUPT_SEED", "2")), sent, phases)


@pytest.mark.slow
def test_an_interrupt_waits_while_a_file_is_written_and_comes_afterwards(tmp_path):
    """An interrupt that a process sends to itself after some milliseconds never leaves the lock of the library held."""
    data = xr.Dataset({"a": ("x", [1.0] * 1000)})
    gc.disable()  # Python drops an interrupt in a callback of the collector, such as that of hypothesis
    for number in range(8):
        with pytest.raises(KeyboardInterrupt), interrupts_wait_for_files():
            threading.Timer(0.0005 * (number + 1), os.kill, (os.getpid(), signal.SIGINT)).start()
            for _ in range(200):
                data.to_netcdf(tmp_path / "a.nc", engine="netcdf4")
        data.to_netcdf(tmp_path / "b.nc", engine="netcdf4")  # would wait forever if the lock were held
        xr.testing.assert_identical(xr.load_dataset(tmp_path / "b.nc"), data)
    gc.enable()
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_an_interrupt_waits_while_a_compiled_module_is_imported(monkeypatch):
    """Such a module turns an interrupt into ImportError, as those of scipy do."""
    spec, create = importlib.util.find_spec("_queue"), _imp.create_dynamic
    assert isinstance(spec.loader, ExtensionFileLoader)

    def interrupted(spec):
        try:
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(0.1)
        except KeyboardInterrupt:
            raise ImportError("initialization failed") from None
        made.append(create(spec))  # the interrupt may come before the caller has the module
        return made[0]

    monkeypatch.setattr(_imp, "create_dynamic", interrupted)
    made = []
    with pytest.raises(KeyboardInterrupt), interrupts_wait_for_files():
        importlib.util.module_from_spec(spec)
        time.sleep(1)
    assert made[0].__name__ == "_queue"


def test_an_interrupt_at_once_is_not_swallowed():
    with pytest.raises(KeyboardInterrupt), interrupts_wait_for_files():
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(1)


def test_an_interrupt_before_the_command_line_is_imported_ends_in_the_sentence(tmp_path):
    (tmp_path / "portalocker.py").write_text("raise KeyboardInterrupt")
    env = os.environ | {"PYTHONPATH": str(tmp_path)}
    done = subprocess.run([*PROGRAM, "--version"], env=env, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode in STOPPED_CODES and done.stderr.startswith("trackroller: stopped. The finished chunks")
    assert len(done.stderr.splitlines()) == 1
