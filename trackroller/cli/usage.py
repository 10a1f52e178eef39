"""Errors in the use of the command line, in one line each."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from typing import Any

from typer.core import TyperGroup
from typer.exceptions import TyperException

from trackroller.errors import escaped


def print_line(text: str) -> None:
    """Print a message on stderr in one line, after the name of the program."""
    print("trackroller: " + " ".join(escaped(text).split()), file=sys.stderr)


def print_doubts(texts: Iterable[str]) -> None:
    """Print a line on stderr for each sentence on an unusual value."""
    for text in texts:
        print_line(f"doubtful: {text}")


class Commands(TyperGroup):
    """Commands whose usage errors are one line on stderr."""

    def main(self, *args: Any, **settings: Any) -> Any:
        """Run a command; raise `SystemExit` with its exit code."""
        try:
            code = super().main(*args, **settings | {"standalone_mode": False})
        except TyperException as exc:
            text = exc.format_message().rstrip(".")
            context = getattr(exc, "ctx", None)
            command = "trackroller"
            if context:
                command = context.command_path
            if text:  # a group of commands without arguments has printed its help
                print_line(f"{text}. See `{command} --help`.")
            code = exc.exit_code
        raise SystemExit(code)
