"""Start the live page in a folder, and say where it is."""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
import sys
import webbrowser
from pathlib import Path

from trackroller.errors import InputError, WorkError
from trackroller.files import try_lock

PLACE = Path(".trackroller")  # in the folder that the page works in


def serve(folder: Path, port: int | None = None, browser: bool = True) -> None:
    """Serve the live page for a folder until Ctrl-C.

    Parameters
    ----------
    folder : pathlib.Path
        The only folder that is read and written: `studies/`, `results/`, `config/materials.yaml`.
    port : int, optional
        Port on 127.0.0.1; any free one if not given.
    browser : bool
        Whether to open the page in the browser.

    Raises
    ------
    InputError
        If the folder is not there.
    WorkError
        If the port is taken, or Tornado is missing.
    """
    if not folder.is_dir():
        raise InputError("folder", str(folder), "a folder that exists", "Create it first, or give another one.")
    os.chdir(folder)
    PLACE.mkdir(exist_ok=True)
    with open(PLACE / "lock", "ab") as lock:
        if not try_lock(lock):
            _tell_where(browser)
            return
        print("trackroller: loading the solver; the page follows in a few seconds", file=sys.stderr, flush=True)
        with contextlib.suppress(KeyboardInterrupt):
            asyncio.run(_until_stopped(port, browser))
        (PLACE / "address.json").unlink(missing_ok=True)
    print("\ntrackroller: the page is closed; studies that run go on.", file=sys.stderr)


async def _until_stopped(port: int | None, browser: bool) -> None:
    try:
        from trackroller.app.server import Server  # heavy: Tornado, Matplotlib and the solver
    except ModuleNotFoundError as exc:
        if exc.name != "tornado":
            raise
        raise WorkError("the page needs Tornado. Install it: pip install 'trackroller[app]'") from None
    server = Server(port or 0)
    with open(PLACE / "address.json", "w", opener=lambda path, flags: os.open(path, flags, 0o600)) as file:
        json.dump({"address": server.address}, file)
    print(f"trackroller: the page is at {server.address} (Ctrl-C ends it)", flush=True)
    if browser:
        webbrowser.open(server.address)
    await asyncio.Event().wait()


def _tell_where(browser: bool) -> None:
    """Say where the server of this folder runs that was started first."""
    try:
        address = json.loads((PLACE / "address.json").read_text(encoding="utf-8"))["address"]
    except (OSError, ValueError, KeyError):
        raise WorkError(f"{Path.cwd()}: another server of this folder is just starting. Try again.") from None
    print(f"trackroller: the page of this folder runs already at {address}", flush=True)
    if browser:
        webbrowser.open(address)
