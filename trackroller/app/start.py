"""Start the live page in a folder, and say where it is."""

from __future__ import annotations

import asyncio
import contextlib
import html
import json
import os
import re
import sys
import webbrowser
from collections.abc import Iterable
from pathlib import Path

from trackroller.environment import import_nothing_from
from trackroller.errors import InputError, WorkError
from trackroller.files import check_utf_8, confine, refuse_links, try_lock, write_private

PLACE = Path(".trackroller")  # in the folder that the page works in
ADDRESS = PLACE / "address.json"
OPENS = PLACE / "open.html"
_HOST = re.compile(r"([a-z0-9]([a-z0-9._-]*[a-z0-9])?|\[[0-9a-f:.]+\])(:[0-9]{1,5})?")
# the browser shows this file first: other users of the machine can read the arguments of a process, but not this file
_OPENING = '<!doctype html>\n<meta http-equiv="refresh" content="0; url={0}">\n<a href="{0}">Open the page</a>\n'


def checked_host(name: str) -> str:
    """Return a host, with its port if it has one, as browsers write it.

    Raises
    ------
    InputError
        If the text is no host.

    Examples
    --------
    >>> checked_host("127.0.0.1:9999"), checked_host("Hub.example.org")
    ('127.0.0.1:9999', 'hub.example.org')
    """
    if not _HOST.fullmatch(name.lower()):
        allowed = "HOST or HOST:PORT, without http:// and path"
        remedy = "Write the host as the address line of the browser shows it, such as 127.0.0.1:9999."
        raise InputError("--allow-host", name, allowed, remedy)
    return name.lower()


def serve(folder: Path, port: int | None = None, browser: bool = True, allow_hosts: Iterable[str] = ()) -> None:
    """Serve the live page for a folder until Ctrl-C.

    Parameters
    ----------
    folder : pathlib.Path
        The only folder that is read and written: `studies/`, `results/`, `config/materials.yaml`.
    port : int, optional
        Port on 127.0.0.1; any free one if not given.
    browser : bool
        Whether to open the page in the browser.
    allow_hosts : iterable of str
        Further hosts, with their ports, under which the page may be asked for: those of a forwarded port.

    Raises
    ------
    InputError
        If the folder is not there, or a host is wrong.
    WorkError
        If the port is taken, or Tornado is missing.
    """
    if not folder.is_dir():
        wrong = "does not exist"
        if folder.exists():
            wrong = "is a file"
        raise InputError("folder", str(folder), "a folder", "Create it first, or give another one.", wrong)
    check_utf_8(folder.absolute(), "folder")
    hosts = [checked_host(name) for name in allow_hosts]
    import_nothing_from(folder)
    confine(folder)
    os.chdir(folder)
    PLACE.mkdir(exist_ok=True)
    refuse_links(PLACE, "folder of the page")
    with open(PLACE / "lock", "ab") as lock:
        if not try_lock(lock):
            _tell_where(browser, hosts)
            return
        print("trackroller: loading the solver; the page follows in a few seconds", file=sys.stderr, flush=True)
        with contextlib.suppress(KeyboardInterrupt):
            asyncio.run(_until_stopped(port, browser, hosts))
        for path in (ADDRESS, OPENS):
            path.unlink(missing_ok=True)
    print("\ntrackroller: the page is closed; studies that run go on.", file=sys.stderr)


async def _until_stopped(port: int | None, browser: bool, hosts: list[str]) -> None:
    try:
        from trackroller.app.server import Server  # heavy: Tornado, Matplotlib and the solver
    except ModuleNotFoundError as exc:
        if exc.name != "tornado":
            raise
        raise WorkError("the page needs Tornado. Install it: pip install 'trackroller[app]'") from None
    server = Server(port or 0, hosts)
    write_private(ADDRESS, json.dumps({"address": server.address, "hosts": hosts}))
    write_private(OPENS, _OPENING.format(html.escape(server.address)))
    print(f"trackroller: the page is at {server.address} (Ctrl-C ends it)", flush=True)
    for host in hosts:
        print(f"trackroller: at the host {host}, its address ends in /{server.token}/", flush=True)
    if browser:
        _open_page()
    await asyncio.Event().wait()


def _open_page() -> None:
    webbrowser.open(OPENS.resolve().as_uri())


def _tell_where(browser: bool, hosts: list[str]) -> None:
    """Say where the server of this folder runs that was started first."""
    try:
        known = json.loads(ADDRESS.read_text(encoding="utf-8"))
        address = known["address"]
        allowed = known["hosts"]
    except (OSError, ValueError, KeyError, TypeError):
        raise WorkError(f"{Path.cwd()}: another server of this folder is just starting. Try again.") from None
    new = [host for host in hosts if host not in allowed]
    if new:
        where = ", ".join(new)
        raise WorkError(
            f"the page of this folder runs already and does not answer at {where}. End it, and start again."
        )
    print(f"trackroller: the page of this folder runs already at {address}", flush=True)
    if browser:
        _open_page()
