"""The command that opens the live page."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer


def live_page(
    folder: Annotated[Path, typer.Argument(help="folder for studies and results")] = Path(),
    no_browser: Annotated[bool, typer.Option("--no-browser", help="print the address only")] = False,
    port: Annotated[
        int | None, typer.Option(min=1, max=65_535, help="port on 127.0.0.1; a free one if not given")
    ] = None,
) -> None:
    """Open the live page of a roller in the browser: sliders, pictures, variants, studies; Ctrl-C ends it."""
    from trackroller.app.start import serve

    serve(folder, port, not no_browser)
    os._exit(0)  # Python aborts if it is torn down while a thread of the solver is inside compiled code
