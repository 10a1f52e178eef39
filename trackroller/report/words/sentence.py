"""A sentence on a study as an object that can be checked, and how its words are put around its numbers.

A `Sentence` holds its text, and what it claims as plain values. The words stand in
`templates/sentences/`, one file a subject and one block a kind; the claims are the variables of the block.
"""

from __future__ import annotations

import functools
import inspect
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import jinja2

from trackroller.report import numbers


@dataclass(frozen=True)
class Sentence:
    """One statement on a study.

    Attributes
    ----------
    kind : name of the kind of sentence; each kind has its own check in the truth test
    text : the sentence
    values : what it claims, in plain numbers and names
    """

    kind: str
    text: str
    values: Mapping[str, Any] = field(default_factory=dict)


def say(subject: str, kind: str, /, **values: Any) -> Sentence:
    """Return a sentence.

    Parameters
    ----------
    subject : name of the file with the words
    kind : name of the block in this file
    **values : what the sentence claims; a block that names another value raises an error
    """
    return Sentence(kind, phrase(subject, kind, **values), values)


def phrase(subject: str, kind: str, /, **values: Any) -> str:
    """Return the words of a block with its values, in one line."""
    template = _environment().get_template(f"{subject}.txt.j2")
    text = "".join(template.blocks[kind](template.new_context(values)))
    return re.sub(r"[ \n]+", " ", text).strip(" ")


@functools.cache
def _environment() -> jinja2.Environment:
    loader = jinja2.PackageLoader("trackroller.report", "templates/sentences")
    # plain text for terminals and figures, too: a page escapes it when the text is put in
    environment = jinja2.Environment(loader=loader, undefined=jinja2.StrictUndefined, trim_blocks=True)
    environment.filters |= {name: value for name, value in vars(numbers).items() if inspect.isfunction(value)}
    environment.filters["joint"] = lambda loop: "" if loop.first else " and " if loop.last else ", "
    known = ("BEYOND", "NO_FAILURE", "GUIDE_UNKNOWN")
    environment.globals |= {"inf": math.inf} | {name: getattr(numbers, name) for name in known}
    return environment
