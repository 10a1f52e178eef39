"""The server of the live page, on 127.0.0.1 only.

Whoever wants an answer has to know the token, which is the first part of every path. Requests of
another site are refused by the headers `Host`, `Origin` and `Sec-Fetch-Site`: a site whose name
leads to this machine has another host. Behind a forwarded port the user names the hosts that may
ask. A page runs only the script of this server, and can reach no other host.
"""

from __future__ import annotations

import asyncio
import functools
import hmac
import json
import math
import secrets
import threading
import traceback
from collections.abc import Callable, Iterable, Mapping
from importlib import import_module, resources
from typing import Any

import pydantic
import tornado.httpserver
import tornado.netutil
import tornado.web

from trackroller.app.lane import Lane
from trackroller.errors import InputError, WorkError
from trackroller.files import MAX_BYTES, long_name

HOST = "127.0.0.1"
USUAL = 80  # the port of http
LARGEST = 300_000  # bytes of a request; a study file with a table of cases names the table
FRAMES = "http://127.0.0.1:* http://localhost:*"  # a notebook on this machine may show the page
OWN = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; "
    "connect-src 'self'; "
    # and the origins of forwarded ports
    f"base-uri 'none'; form-action 'none'; frame-ancestors {FRAMES}"
)
# a sheet has its styles inside, a report its scripts too; `sandbox` keeps them away from this
# server
SHEET = (
    "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; "
    "form-action 'none'; sandbox"
)
REPORT = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src "
    "data:; base-uri 'none'; "
    "form-action 'none'; sandbox allow-scripts allow-downloads"
)
ASSETS = {
    "": ("index.html", "text/html"),
    "app.js": ("app.js", "text/javascript"),
    "app.css": ("app.css", "text/css"),
}


KINDS = {
    "pdf": "application/pdf",
    "xlsx": "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet",
}
MAPPING = pydantic.TypeAdapter(dict[str, Any])  # what every request holds as JSON
STATUS = {InputError: 422, WorkError: 409, pydantic.ValidationError: 400}


class RefusedRequest(tornado.web.HTTPError):
    """A request that is not answered, with its HTTP status and the reason in words."""

    def __init__(self, status: int, words: str) -> None:
        super().__init__(status)
        self.words = words

    def __str__(self) -> str:
        return self.words


# the thread of the solver answers
SOLVING = dict.fromkeys(
    ("picture", "curve", "find_range", "texts", "sheet", "file_of_roller"), "picture"
)
SOLVING |= {"carriage_lives": "carriage", "spectrum": "spectrum", "sized": "requirement"}
STUDIES = (
    *("checked", "listing", "text_of", "start", "resume", "pause", "delete", "headlines"),
    *("page_of", "file_of_study"),
)
PAGES = ("sheet", "page_of", "file_of_roller", "file_of_study")  # have addresses of their own
# the thread of the files
FILES = {"all_fields": "fields", "material": "materials", "save_material": "materials"}
FILES |= dict.fromkeys(STUDIES, "studies")
CARRIAGES = (
    "carriage_files",
    "open_carriage",
    "carriage_loads",
    "save_carriage",
    "carriage_spectrum",
)
FILES |= dict.fromkeys(CARRIAGES, "carriage")
_loading = threading.Lock()


@functools.cache
def answer(name: str) -> Callable[..., Any]:
    """Return the function that answers; it refuses arguments that it does not take, or of another
    type.

    Its module is imported when it is first needed: the page loads while the solver does.
    """
    with _loading:  # two threads that import modules of one circle see them unfinished
        module = import_module(f"trackroller.app.{(SOLVING | FILES)[name]}")
    return pydantic.validate_call(config=pydantic.ConfigDict(strict=True))(getattr(module, name))


def plain(value: Any) -> Any:
    """Return a value as JSON can hold it: NaN as None, and infinite numbers as the texts inf and
    -inf.
    """
    if isinstance(value, float) and not math.isfinite(value):
        if math.isnan(value):
            return None
        return "inf" if value > 0 else "-inf"
    if isinstance(value, Mapping):
        return {str(key): plain(entry) for key, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(entry) for entry in value]
    return value


class _Handler(tornado.web.RequestHandler):
    """What all answers share: who may ask, the headers, and errors in words."""

    def set_default_headers(self) -> None:
        for name, text in {
            "Content-Security-Policy": " ".join((OWN, *self.settings["server"].forwarded)),
            "X-Content-Type-Options": "nosniff",
            "Referrer-Policy": "no-referrer",
            "Cache-Control": "no-store",
            "Cross-Origin-Resource-Policy": "same-origin",
            "Server": "trackroller",
        }.items():
            self.set_header(name, text)

    def prepare(self) -> None:
        """Refuse who does not know the token, who asks under another name of this machine, and
        other sites.
        """
        server = self.settings["server"]
        headers = self.request.headers
        host = self.request.host.lower()
        if host not in server.hosts:
            where = " and ".join(sorted(server.hosts))
            way = (
                "Forward the same port number, or start the page with --allow-host and the host "
                "of the address line"
            )
            raise RefusedRequest(
                403, f"This server answers at {where} only, not at {host[:80]}. {way}."
            )
        if not hmac.compare_digest(str(self.path_args[0]).encode(), server.token.encode()):
            raise RefusedRequest(
                403,
                "The token in the address is missing or wrong. Open the address that the terminal "
                "shows.",
            )
        foreign = headers.get("Sec-Fetch-Site", "none") not in ("none", "same-origin")
        own = {f"http://{host}", *server.forwarded}  # a proxy may change the host, and the protocol
        if self.request.method == "POST" and (
            foreign or headers.get("Origin", f"http://{host}").lower() not in own
        ):
            raise RefusedRequest(403, "Another site asked. Only the page of this server may.")

    async def answered(self, question: str, newest_of: str = "", /, **arguments: Any) -> Any:
        """Answer in the thread of the solver or of the files; `newest_of` names a page that needs
        the newest only.
        """
        server: Server = self.settings["server"]
        if question in SOLVING:
            lane = server.solver
        else:
            lane = server.files
        key = question, newest_of or secrets.token_hex(8)
        return await asyncio.wrap_future(lane.submit(key, lambda: answer(question)(**arguments)))

    def write_error(self, status_code: int, **info: Any) -> None:
        """Answer with the reason in words; an error of the program leaves its traceback in the
        terminal only.
        """
        exc = info["exc_info"][1]
        exc = (long_name(exc) if isinstance(exc, OSError) else None) or exc
        self.set_status(
            next((status for kind, status in STATUS.items() if isinstance(exc, kind)), status_code)
        )
        errors = [{"field": "", "message": str(exc)}]
        if isinstance(exc, InputError):
            errors = [{"field": e.field, "message": str(e)} for e in exc.errors]
        elif isinstance(exc, pydantic.ValidationError):
            first = exc.errors()[0]
            errors[0]["message"] = (
                f"The request is wrong: {': '.join(map(str, (*first['loc'], first['msg'])))}."
            )
        elif not isinstance(exc, (tornado.web.HTTPError, WorkError)):
            errors[0]["message"] = f"Internal error, {type(exc).__name__}. The terminal shows more."
        self.finish({"errors": errors})

    def log_exception(self, typ: Any, value: Any, tb: Any) -> None:
        """Print the traceback of an error of the program; refusals and wrong input are answers."""
        if isinstance(value, OSError) and long_name(value) is not None:
            return
        if not isinstance(value, (tornado.web.HTTPError, *STATUS)):
            traceback.print_exception(typ, value, tb)


class _Page(_Handler):
    """The page itself, with its script and style."""

    def get(self, token: str, name: str) -> None:
        if name not in ASSETS:
            raise RefusedRequest(404, "There is no such page.")
        file, kind = ASSETS[name]
        self.set_header("Content-Type", f"{kind}; charset=utf-8")
        self.finish((resources.files("trackroller.app") / "assets" / file).read_bytes())


class _AnswerHandler(_Handler):
    """Answers to the script of the page: JSON in, JSON out."""

    async def post(self, token: str, name: str) -> None:
        if name not in SOLVING | FILES or name in PAGES:
            raise RefusedRequest(404, f"The page cannot ask for '{name}'.")
        if self.request.headers.get("Content-Type", "").partition(";")[0] != "application/json":
            raise RefusedRequest(415, "The request is not of the type application/json.")
        if len(self.request.body) > LARGEST:
            raise RefusedRequest(413, f"The request is larger than {LARGEST // 1000} kB.")
        body = MAPPING.validate_json(self.request.body)
        answer = await self.answered(name, str(body.pop("page", "")), **body)
        self.set_header("Content-Type", "application/json")
        self.finish(json.dumps(plain(answer), allow_nan=False).replace("<", "\\u003c"))


class _Sheet(_Handler):
    """The printable sheet of the case that the query holds as JSON."""

    async def get(self, token: str) -> None:
        page = await self.answered(
            "sheet", values=MAPPING.validate_json(self.get_query_argument("case", "{}"))
        )
        self.set_header("Content-Security-Policy", SHEET)
        self.finish(page)


class _File(_Handler):
    """A file to save: the sheet of a case as PDF or its workbook, or those of a study."""

    async def get(self, token: str, *where: str) -> None:
        *study, file = where
        if study:
            content = await self.answered("file_of_study", name=study[0], file=file)
        else:
            values = MAPPING.validate_json(self.get_query_argument("case", "{}"))
            content = await self.answered("file_of_roller", values=values, name=file)
        self.set_header("Content-Type", KINDS[file.rpartition(".")[2]])
        self.set_header("Content-Disposition", f'attachment; filename="{"-".join(where)}"')
        self.finish(content)


class _Result(_Handler):
    """Report and explorer of a study."""

    async def get(self, token: str, name: str, page: str) -> None:
        path = await self.answered("page_of", name=name, page=page)
        self.set_header("Content-Security-Policy", REPORT)
        self.finish(path.read_bytes())


class Server:
    """The server on a port of this machine.

    Parameters
    ----------
    port : int
        The port; 0 takes a free one.
    allow_hosts : iterable of str
        Hosts, with their ports, under which a forwarded port is asked for.

    Attributes
    ----------
    hosts : set of str
        What the header `Host` may hold: this machine's name and address with the port, and the
        allowed hosts.
    forwarded : list of str
        The origins of the allowed hosts.

    Raises
    ------
    WorkError
        If another program has the port.
    """

    def __init__(self, port: int = 0, allow_hosts: Iterable[str] = ()) -> None:
        self.token = secrets.token_urlsafe(24)
        self.solver = Lane("solver")
        self.files = Lane("files")
        try:
            sockets = tornado.netutil.bind_sockets(port, HOST)
        except OSError as exc:
            raise WorkError(
                f"port {port} is not free ({exc.strerror}). Give another number with --port."
            ) from None
        number = sockets[0].getsockname()[1]
        further = list(allow_hosts)
        self.hosts = {*further, *(f"{name}:{number}" for name in (HOST, "localhost"))}
        if number == USUAL:  # browsers leave it out
            self.hosts |= {HOST, "localhost"}
        self.forwarded = [
            f"{protocol}://{host}" for host in further for protocol in ("http", "https")
        ]
        self.address = f"http://{HOST}:{number}/{self.token}/"
        application = tornado.web.Application(
            [
                (r"/([^/]*)/sheet", _Sheet),
                (r"/([^/]*)/(sheet\.pdf|roller\.xlsx)", _File),
                (r"/([^/]*)/results/([^/]+)/(report\.pdf|cases\.xlsx)", _File),
                (r"/([^/]*)/results/([^/]+)/([^/]+)", _Result),
                (r"/([^/]*)/api/(\w+)", _AnswerHandler),
                (r"/([^/]*)/?(.*)", _Page),
            ],
            server=self,
            log_function=lambda handler: None,  # its lines would hold the token
        )
        self.http = tornado.httpserver.HTTPServer(
            application, max_body_size=MAX_BYTES, max_header_size=65_536
        )
        self.http.add_sockets(sockets)
        # the compiled solver is loaded before the first request
        self.solver.submit("first", lambda: answer("picture")(answer("all_fields")()["first"]))
