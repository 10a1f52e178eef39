"""Ctrl-C at a random moment: the command ends, says in one sentence what is kept, and goes on when started again."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time

import pytest
import xarray as xr

from trackroller.files import interrupts_wait_for_files

TRIES = int(os.environ.get("INTERRUPT_TRIES", "12"))
STUDY = """
name: stopped
factors:
  axial_force: {linspace: [0, 60, 60]}
  friction_coefficient: {linspace: [0.05, 0.4, 40]}
outputs: [forces, contact]
contact_model: sliding
chunk_size: 400
"""
WORDS = [sys.executable, "-m", "trackroller.cli", "run", "study.yaml", "-q"]


def stopped_after(seconds, place, *more):
    """Start a run, interrupt it, and return its exit code, what it printed, and how long it took to end."""
    process = subprocess.Popen([*WORDS, *more], cwd=place, stderr=subprocess.PIPE, text=True)
    time.sleep(seconds)
    process.send_signal(signal.SIGINT)
    begun = time.monotonic()
    try:
        _, told = process.communicate(timeout=60)
    except subprocess.TimeoutExpired:
        process.kill()
        pytest.fail(f"the run hangs after an interrupt at {seconds} s")
    return process.returncode, told, time.monotonic() - begun


# a shell reports 130 for both: Python ends by the signal itself where it met it in code that it had made from text
STOPPED_CODES = (130, -signal.SIGINT)


def interrupted_runs(place, tries, seed):
    (place / "study.yaml").write_text(STUDY)
    begun = time.monotonic()
    subprocess.run([*WORDS, "--results", "calm"], cwd=place, check=True, capture_output=True)
    whole = time.monotonic() - begun
    chance, codes = random.Random(seed), []
    for number in range(tries):
        results = f"rough-{number // 8}"  # some start afresh, the others go on
        code, told, _ = stopped_after(chance.uniform(0.15, 1.2) * whole, place, "--results", results)
        codes.append(code)
        assert code in (0, *STOPPED_CODES), told
        if code in STOPPED_CODES:
            assert told.strip().splitlines()[-1].startswith("trackroller: stopped. The finished chunks"), told
        assert "Traceback" not in told, told
    for results in {f"rough-{number // 8}" for number in range(tries)}:
        subprocess.run([*WORDS, "--results", results], cwd=place, check=True, capture_output=True)
        sets = [xr.load_dataset(place / name / "stopped" / "study.nc").drop_attrs() for name in (results, "calm")]
        xr.testing.assert_identical(*sets)
    assert set(STOPPED_CODES) & set(codes)


@pytest.mark.slow
def test_interrupted_runs_end_with_a_sentence_and_go_on(tmp_path):
    interrupted_runs(tmp_path, TRIES, seed=2)


def test_an_interrupt_waits_while_a_file_is_written_and_comes_afterwards(tmp_path):
    """An interrupt that a process sends to itself every millisecond never leaves the lock of the library held."""
    data = xr.Dataset({"a": ("x", [1.0] * 1000)})
    for number in range(8):
        with pytest.raises(KeyboardInterrupt), interrupts_wait_for_files():
            signal.signal(signal.SIGVTALRM, lambda *_: os.kill(os.getpid(), signal.SIGINT))
            signal.setitimer(signal.ITIMER_VIRTUAL, 0.0005 * (number + 1))
            for _ in range(200):
                data.to_netcdf(tmp_path / "a.nc", engine="netcdf4")
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
        data.to_netcdf(tmp_path / "b.nc", engine="netcdf4")  # would wait forever if the lock were held
        xr.testing.assert_identical(xr.load_dataset(tmp_path / "b.nc"), data)
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_an_interrupt_at_once_is_not_swallowed():
    with pytest.raises(KeyboardInterrupt), interrupts_wait_for_files():
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(1)
