"""The live page: one roller to play with, studies that start from it, and the server of both on this machine.

The module itself can be called: `tr.app(case)` shows the page in a notebook.
"""

from __future__ import annotations

import atexit
import subprocess
import sys
import urllib.parse
from collections.abc import Iterable
from html import escape
from pathlib import Path
from types import ModuleType
from typing import Any

from trackroller.environment import python
from trackroller.errors import WorkError


class Frame:
    """The live page in a notebook; `address` opens it elsewhere, and `close` ends its server."""

    def __init__(self, address: str, process: subprocess.Popen[str], height: int) -> None:
        self.address = address
        self.height = height
        self._process = process

    def close(self) -> None:
        """End the server; studies that run go on."""
        self._process.terminate()
        self._process.wait()

    def _repr_html_(self) -> str:
        style = f'width="100%" height="{self.height}" style="border: 0"'
        return f'<iframe src="{escape(self.address)}" title="trackroller" allow="clipboard-write" {style}></iframe>'


def frame(
    case: Any = None,
    folder: Path | str = ".",
    height: int = 820,
    port: int | None = None,
    allow_hosts: Iterable[str] = (),
) -> Frame:
    """Show the live page of one roller in a notebook.

    Parameters
    ----------
    case : Case or mapping, optional
        The roller with which the page begins; the long-lived example of the README if not given.
    folder : path
        The folder in which the page keeps studies and results.
    height : int
        Height of the frame [px].
    port : int, optional
        Port on 127.0.0.1, such as one that is forwarded; any free one if not given.
    allow_hosts : iterable of str
        Hosts, with their ports, of a forwarded port under which the page may be asked for.

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
    from trackroller.roller.case import Case  # the worker of a study starts faster without the solver
    from trackroller.roller.stored_inputs import given_inputs, setting_text

    if isinstance(case, Case):
        checked = case
    elif case is None:
        checked = Case.from_dict({})
    else:
        checked = Case.from_dict(case)
    words = {name: setting_text(value) for name, value in given_inputs(checked).items()}
    options = [f"--allow-host={host}" for host in allow_hosts]
    if port is not None:
        options.insert(0, f"--port={port}")
    command = python("trackroller.cli", "app", str(folder), "--no-browser", *options)
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, stdin=subprocess.DEVNULL)
    atexit.register(process.terminate)
    line = ""
    if process.stdout:
        line = process.stdout.readline()
    if "http://" not in line:
        raise WorkError("the server of the page does not start; `trackroller app` says why in a terminal")
    address = line[line.index("http://") :].split()[0]
    if case is not None:
        address += f"#{urllib.parse.urlencode(words or {'tab': 'roller'})}"
    return Frame(address, process, height)


class _CallableModule(ModuleType):
    __call__ = staticmethod(frame)


sys.modules[__name__].__class__ = _CallableModule
