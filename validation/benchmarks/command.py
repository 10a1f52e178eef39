"""The command line that all benchmarks share.

A benchmark is a module with a function `measure`, whose parameters all have defaults: each is an option of its command
line. `measure` returns numbers, texts, lists and mappings. Every benchmark prints them as JSON, and writes them to a
file with `--output FILE`.
"""

from __future__ import annotations

import argparse
import inspect
import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from trackroller.files import write_text


def plain(value: Any) -> Any:
    """Return a value in the types of JSON: arrays as lists, infinities and NaN as words."""
    if isinstance(value, dict):
        return {str(name): plain(inner) for name, inner in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(inner) for inner in value]
    if isinstance(value, (np.ndarray, np.generic)):
        return plain(value.tolist())
    return str(value) if isinstance(value, float) and not math.isfinite(value) else value


def options_of(measure: Callable[..., Any], doc: str) -> argparse.ArgumentParser:
    """Return a parser with one option for each parameter of `measure`; a default that is False becomes a switch.

    Parameters
    ----------
    measure : callable
        Function whose parameters all have a default: a number, a text, a tuple of such or False.
    doc : str
        Help text, the docstring of the module.
    """
    parser = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name, parameter in inspect.signature(measure).parameters.items():
        flag, default = f"--{name.replace('_', '-')}", parameter.default
        if default is False:
            parser.add_argument(flag, action="store_true")
        elif isinstance(default, tuple):
            parser.add_argument(flag, nargs="+", type=type(default[0]), default=default)
        else:
            parser.add_argument(flag, type=type(default), default=default)
    return parser


def run(measure: Callable[..., Any], doc: str | None, words: list[str] | None = None) -> None:
    """Measure with the options of the command line and print what was found, with the options, as JSON.

    Parameters
    ----------
    measure : callable
        See `options_of`.
    doc : str
        Docstring of the module.
    words : list of str, optional
        Words of the command line; those of the process if not given.
    """
    parser = options_of(measure, doc or "")
    parser.add_argument("--output", type=Path, help="write the JSON to this file too")
    options = vars(parser.parse_args(words))
    output = options.pop("output")
    if options.get("cases", 1) < 1:
        parser.error(f"--cases {options['cases']} is not allowed: give 1 or more")
    text = json.dumps(plain({"options": options, **measure(**options)}), indent=1, allow_nan=False) + "\n"
    print(text, end="")
    if output:
        write_text(output, text)
