"""Start the live page in a folder, say where it is, and show it in a notebook."""

from __future__ import annotations

import asyncio
import atexit
import contextlib
import json
import os
import subprocess
import sys
import urllib.parse
import webbrowser
from collections.abc import Mapping
from html import escape
from pathlib import Path
from typing import Any

from trackroller.errors import InputError, WorkError
from trackroller.files import try_lock

PLACE = Path(".trackroller")  # in the folder that the page works in
USUAL_PORT = 8750


def serve(folder: Path, port: int | None = None, browser: bool = True) -> None:
    """Serve the live page for a folder until Ctrl-C.

    Parameters
    ----------
    folder : pathlib.Path
        The only folder that is read and written: `studies/`, `results/`, `config/materials.yaml`.
    port : int, optional
        Port on 127.0.0.1; 8750 or any free one if not given.
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
    try:
        server = Server(USUAL_PORT if port is None else port)
    except WorkError:
        if port is not None:
            raise
        server = Server()
    with open(PLACE / "address.json", "w", opener=lambda path, flags: os.open(path, flags, 0o600)) as file:
        json.dump({"address": server.address}, file)
    print(f"trackroller: the page is at {server.address} (Ctrl-C ends it)", flush=True)
    server.warm_up()
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


class Frame:
    """The live page in a notebook; `address` opens it elsewhere, and `close` ends its server."""

    def __init__(self, address: str, process: subprocess.Popen[str], height: int) -> None:
        self.address, self.height, self._process = address, height, process

    def close(self) -> None:
        """End the server; studies that run go on."""
        self._process.terminate()
        self._process.wait()

    def _repr_html_(self) -> str:
        address = escape(self.address, quote=True)
        style = f'width="100%" height="{self.height}" style="border: 0"'
        return f'<iframe src="{address}" title="trackroller" allow="clipboard-write" {style}></iframe>'


def frame(case: Any = None, folder: Path | str = ".", height: int = 820) -> Frame:
    """Show the live page of one roller in a notebook.

    Parameters
    ----------
    case : Case or mapping, optional
        The roller with which the page begins; the long-lived example of the README if not given.
    folder : path
        The folder in which the page keeps studies and results.
    height : int
        Height of the frame [px].

    Returns
    -------
    Frame
        A notebook shows it as a frame. Its server ends with Python.

    Raises
    ------
    InputError
        If the case is wrong.
    WorkError
        If the server does not start.

    Examples
    --------
    >>> import trackroller as tr
    >>> page = tr.app({"axial_force": 70})
    >>> page.address.endswith("#axial_force=70.0")
    True
    >>> page.close()
    """
    from trackroller.roller.case import Case  # the command line starts faster without the solver
    from trackroller.roller.record import given_inputs

    checked = case if isinstance(case, Case) else Case.from_dict(case or {})
    words = {n: json.dumps(v) if isinstance(v, (Mapping, list)) else str(v) for n, v in given_inputs(checked).items()}
    command = [sys.executable, "-m", "trackroller.cli", "app", str(folder), "--no-browser"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, stdin=subprocess.DEVNULL)
    atexit.register(process.terminate)
    line = process.stdout.readline() if process.stdout else ""
    if "http://" not in line:
        raise WorkError("the server of the page does not start; `trackroller app` says why in a terminal")
    address = line[line.index("http://") :].split()[0]
    hash_ = "" if case is None else f"#{urllib.parse.urlencode(words or {'tab': 'roller'})}"
    return Frame(address + hash_, process, height)
