"""A headless Chromium that tests drive over the DevTools protocol, on a pipe and without a network."""

from __future__ import annotations

import base64
import json
import os
import select
import shutil
import subprocess
import tempfile
import time
from pathlib import Path
from typing import Any

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-extensions",
    "--hide-scrollbars",
    "--remote-debugging-pipe",
)
PATIENCE = 60  # seconds


class Browser:
    """A running browser; `open` gives a page."""

    def __init__(self) -> None:
        self._profile = tempfile.mkdtemp(prefix="trackroller-browser-")
        read_in, self._out = os.pipe()
        self._in, write_out = os.pipe()

        def pipes() -> None:  # Chromium reads from descriptor 3 and writes to 4
            os.dup2(read_in, 103)
            os.dup2(write_out, 104)
            os.dup2(103, 3)
            os.dup2(104, 4)

        self._process = subprocess.Popen(
            [str(CHROMIUM), *FLAGS, f"--user-data-dir={self._profile}"],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            close_fds=False,
            preexec_fn=pipes,
        )
        os.close(read_in)
        os.close(write_out)
        self._number = 0
        self._rest = b""
        self.events: list[dict[str, Any]] = []

    def close(self) -> None:
        """End the browser and remove its profile."""
        self._process.terminate()
        self._process.wait(timeout=PATIENCE)
        os.close(self._out)
        os.close(self._in)
        shutil.rmtree(self._profile, ignore_errors=True)

    def _message(self, until: float) -> dict[str, Any]:
        while b"\0" not in self._rest:
            if not select.select([self._in], [], [], max(0.0, until - time.monotonic()))[0]:
                raise TimeoutError("the browser does not answer")
            self._rest += os.read(self._in, 1 << 20)
        message, self._rest = self._rest.split(b"\0", 1)
        return json.loads(message)

    def call(self, method: str, session: str | None = None, **params: Any) -> dict[str, Any]:
        """Send a command and return its result; events that come meanwhile are kept in `events`."""
        self._number += 1
        told: dict[str, Any] = {"id": self._number, "method": method, "params": params}
        os.write(self._out, json.dumps(told | ({"sessionId": session} if session else {})).encode() + b"\0")
        until = time.monotonic() + PATIENCE
        while True:
            message = self._message(until)
            if message.get("id") == self._number:
                if "error" in message:
                    raise RuntimeError(f"{method}: {message['error']}")
                return message["result"]
            self.events.append(message)

    def open(self, path: Path, fragment: str = "", before: str = "", **size: int) -> Page:
        """Open a file; the script `before` runs before the scripts of the page."""
        return Page(self, path.as_uri() + fragment, before, **size)


class Page:
    """A page: scripts, pointer, keys, pictures, and the requests and messages that it made."""

    def __init__(self, browser: Browser, url: str, before: str = "", width: int = 1200, height: int = 900) -> None:
        self.browser = browser
        target = browser.call("Target.createTarget", url="about:blank")["targetId"]
        self._target = target
        self._session = browser.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Network", "Log"):
            self.call(f"{domain}.enable")
        self.resize(width, height)
        if before:
            self.call("Page.addScriptToEvaluateOnNewDocument", source=before)
        self.go(url)

    def call(self, method: str, **params: Any) -> dict[str, Any]:
        """Send a command to this page."""
        return self.browser.call(method, self._session, **params)

    def go(self, url: str) -> None:
        """Open an address and wait until the page is loaded and its explorer, if it has one, is there."""
        self.call("Page.navigate", url=url)
        ready = "document.readyState === 'complete' && document.querySelector('#explorer:not([data-ready])') === null"
        self.until(f"location.href !== 'about:blank' && {ready}")

    def close(self) -> None:
        """Close the page."""
        self.browser.call("Target.closeTarget", targetId=self._target)

    def resize(self, width: int, height: int = 900) -> None:
        """Set the size of the window in CSS pixels."""
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)

    def media(self, kind: str = "", **features: str) -> None:
        """Set the medium ('print') and media features such as prefers_color_scheme='dark'."""
        told = [{"name": name.replace("_", "-"), "value": value} for name, value in features.items()]
        self.call("Emulation.setEmulatedMedia", media=kind, features=told)

    def run(self, script: str) -> Any:
        """Return the value of an expression; promises are awaited."""
        done = self.call("Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True, userGesture=True)
        if "exceptionDetails" in done:
            problem = done["exceptionDetails"]
            raise RuntimeError(problem.get("exception", {}).get("description") or problem["text"])
        return done["result"].get("value")

    def until(self, script: str) -> None:
        """Wait until an expression is true."""
        end = time.monotonic() + PATIENCE
        while True:
            try:
                if self.run(script):
                    return
            except RuntimeError as problem:  # the page is just being replaced
                if "context" not in str(problem).lower():
                    raise
            if time.monotonic() > end:
                raise TimeoutError(script)
            time.sleep(0.02)

    def drag(self, start: tuple[float, float], end: tuple[float, float]) -> None:
        """Press the pointer at one place and release it at another; equal places are a click."""
        self._mouse("mouseMoved", start)
        self._mouse("mousePressed", start, buttons=1)
        if start != end:
            middle = ((start[0] + end[0]) / 2, (start[1] + end[1]) / 2)
            for place in (middle, end):
                self._mouse("mouseMoved", place, buttons=1)
        self._mouse("mouseReleased", end)

    def _mouse(self, kind: str, place: tuple[float, float], buttons: int = 0) -> None:
        left = (
            {"button": "left" if buttons else "none"} if kind == "mouseMoved" else {"button": "left", "clickCount": 1}
        )
        self.call("Input.dispatchMouseEvent", type=kind, x=place[0], y=place[1], buttons=buttons, **left)

    def key(self, *names: str) -> None:
        """Press keys one after the other."""
        for name in names:
            code = {"Tab": 9, "Enter": 13, " ": 32, "ArrowDown": 40, "ArrowRight": 39, "ArrowLeft": 37}.get(name, 0)
            text = {"Enter": "\r", " ": " "}.get(name, "")
            told = {"key": name, "windowsVirtualKeyCode": code} | ({"text": text} if text else {})
            self.call("Input.dispatchKeyEvent", type="keyDown", **told)
            self.call("Input.dispatchKeyEvent", type="keyUp", key=name, windowsVirtualKeyCode=code)

    def box(self, selector: str) -> tuple[float, float, float, float]:
        """Scroll to an element and return its left, top, width and height in the window."""
        script = f"""(() => {{ const e = document.querySelector({json.dumps(selector)});
            e.scrollIntoView({{block: 'center', behavior: 'instant'}});
            const b = e.getBoundingClientRect(); return [b.left, b.top, b.width, b.height]; }})()"""
        return tuple(self.run(script))

    def picture(self, path: Path, whole: bool = True) -> None:
        """Write a screenshot (PNG)."""
        data = self.call("Page.captureScreenshot", captureBeyondViewport=whole, **self._clip(whole))["data"]
        path.write_bytes(base64.b64decode(data))

    def _clip(self, whole: bool) -> dict[str, Any]:
        if not whole:
            return {}
        size = self.call("Page.getLayoutMetrics")["cssContentSize"]
        return {"clip": {"x": 0, "y": 0, "width": size["width"], "height": size["height"], "scale": 1}}

    def pdf(self) -> bytes:
        """Return the page as it prints."""
        return base64.b64decode(self.call("Page.printToPDF", preferCSSPageSize=True)["data"])

    def _events(self, method: str) -> list[dict[str, Any]]:
        self.run("0")  # events of the page come before the answer
        mine = [e for e in self.browser.events if e.get("sessionId") == self._session]
        return [e["params"] for e in mine if e["method"] == method]

    @property
    def requests(self) -> list[str]:
        """Return the addresses that the page asked for, without data and blobs."""
        every = [p["request"]["url"] for p in self._events("Network.requestWillBeSent")]
        return [url for url in every if not url.startswith(("data:", "blob:"))]

    @property
    def complaints(self) -> list[str]:
        """Return the errors and warnings of the console, thrown exceptions and violations of the policy."""
        thrown = [str(p["exceptionDetails"]) for p in self._events("Runtime.exceptionThrown")]
        said = [str(p["entry"]["text"]) for p in self._events("Log.entryAdded") if p["entry"]["level"] != "verbose"]
        console = [
            str(p["args"]) for p in self._events("Runtime.consoleAPICalled") if p["type"] in ("error", "warning")
        ]
        return thrown + said + console
