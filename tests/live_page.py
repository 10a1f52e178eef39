"""A running live page, as a user starts it, and requests to it."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
import urllib.error
import urllib.request
from pathlib import Path
from typing import Any

PATIENCE = 90  # seconds
STUDY = """name: small
description: What does friction do?
factors:
  friction_coefficient: {values: [0.1, 0.2, 0.3]}
  axial_force: {values: [0, 30]}
contact_model: sliding
accuracy: preview
"""
LONG = """name: long
factors: {friction_coefficient: {linspace: [0.05, 0.4, 60]}, axial_force: {linspace: [0, 60, 200]}}
outputs: [forces, peak_stress, life, shakedown]
chunk_size: 60
"""


class LivePage:
    """`trackroller app FOLDER` in a process of its own."""

    def __init__(self, folder: Path, *options: str, browser: str = "", **where: Any) -> None:
        command = [sys.executable, "-P", "-m", "trackroller.cli", "app", str(folder), *options]
        command += [] if browser else ["--no-browser"]
        self.folder = folder
        where["env"] = {**os.environ, **where.get("env", {}), **({"BROWSER": browser} if browser else {})}
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **where)
        assert self.process.stdout is not None
        self.line = self.process.stdout.readline()
        self.address = next((word for word in self.line.split() if word.startswith("http://")), "")

    @property
    def host(self) -> str:
        return self.address.split("/")[2]

    def stop(self, number: int = signal.SIGINT) -> tuple[int, str]:
        """End the server and return its exit code and what it wrote on standard error."""
        self.process.send_signal(number)
        _, said = self.process.communicate(timeout=PATIENCE)
        return self.process.returncode, said

    def get(self, path: str, **headers: str) -> tuple[int, str, Any]:
        """Return status, text and headers of a page."""
        return self._answer(urllib.request.Request(self.address + path, headers=headers))

    def send(self, name: str, body: bytes, **headers: str) -> tuple[int, Any]:
        """Send bytes to the part of the server that answers the script of the page."""
        told = {"Content-Type": "application/json"} | {key.replace("_", "-"): text for key, text in headers.items()}
        request = urllib.request.Request(f"{self.address}api/{name}", data=body, headers=told, method="POST")
        status, text, _ = self._answer(request)
        return status, json.loads(text) if text.startswith(("{", "[")) else text

    def ask(self, question: str, /, **body: Any) -> tuple[int, Any]:
        """Ask as the script of the page does."""
        return self.send(question, json.dumps(body).encode())

    def _answer(self, request: urllib.request.Request) -> tuple[int, str, Any]:
        try:
            with urllib.request.urlopen(request, timeout=PATIENCE) as answer:
                return answer.status, answer.read().decode(), answer.headers
        except urllib.error.HTTPError as error:
            return error.code, error.read().decode(), error.headers

    def entry(self, name: str) -> dict[str, Any]:
        """Return what the list of studies says of one; {} if it is not in the list."""
        return next((one for one in self.ask("listing")[1] if one["name"] == name), {})

    def until(self, name: str, *states: str, cases: int = 0) -> dict[str, Any]:
        """Wait until a study is in one of some states, with at least so many cases solved."""
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            found = self.entry(name)
            if found.get("state") in states and (found["done"] or 0) >= cases:
                return found
            time.sleep(0.2)
        raise TimeoutError(f"{name}: {found}")
