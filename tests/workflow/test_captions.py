"""Texts of a user arrive as text in the page of `snakemake --report`, whatever markup they look like."""

from __future__ import annotations

import html
import json
import re
from types import SimpleNamespace

import jinja2
import pytest
from docutils.core import publish_parts
from workflow_place import ROOT

from trackroller.cli.workflow import captions
from trackroller.study.file.load import load_study
from trackroller.study.store.folder import StudyFolder

NASTY = [
    ".. include:: {secret}",
    "see\n\n.. include:: {secret}\n   :literal:\n",
    "see\n\n.. raw:: html\n\n   <script>alert(1)</script>\n",
    ".. raw:: html\n   :file: {secret}",
    ".. csv-table::\n   :file: {secret}",
    ".. |it| include:: {secret}\n\n|it|",
    ".. role:: raw-html(raw)\n   :format: html\n\n:raw-html:`<script>`",
    "`here <javascript:alert(1)>`_ and http://evil.example and a@evil.example",
    "__ http://evil.example",
    "|name| :math:`x` a_ b__ [1]_ *so* **so** ``so``",
    "=====\nTitle\n=====",
    "+---+---+\n| a | b |\n+---+---+",
    "1. a\n2. b",
    "\u2022 a bullet",
    "- a\n* b\n>>> c\n| d\n:e: f\n-o g",
    "text::\n\n    literal",
    "<img src=x onerror=alert(1)> {{{{ 7 * 7 }}}} {{% raw %}}",
    "ends in \\",
    "a minus \u22125 N/mm\u00b2, 0.3 \u00b1 0.1 (mu_max)",
]


def page(name, texts, wildcards=None):
    """Return a caption as Snakemake's report makes it: a template, and its text read as reStructuredText."""
    source = (ROOT / "workflow" / "report" / name).read_text(encoding="utf-8")
    given = SimpleNamespace(config={"captions": texts}, wildcards=SimpleNamespace(**wildcards or {}))
    return publish_parts(jinja2.Environment().from_string(source).render(snakemake=given), writer="html")["body"]


def words(text):
    return " ".join(text.split())


@pytest.mark.parametrize("text", NASTY)
def test_every_text_of_a_user_stays_a_text(tmp_path, text):
    secret = tmp_path / "secret"
    secret.write_text("4711,secret\n")
    text = text.format(secret=secret)
    factors = {"friction_coefficient": {"values": [0.1, 0.2]}}
    study = load_study({"name": "nasty", "description": text, "factors": factors})
    folder = StudyFolder(tmp_path / "nasty")
    (folder.root / "figures").mkdir(parents=True)
    drawn = [{"name": "levels", "sentence": text, "caption": f"Levels of {text}"}]
    (folder.root / "figures" / "index.json").write_text(json.dumps(drawn))
    texts = captions(study, folder)
    for made, shown in {
        page("report.rst", texts): f"Study nasty: {text}",
        page("figure.rst", texts, {"name": "levels"}): f"{text} Levels of {text}",
    }.items():
        assert set(re.findall(r"<[^>]*>", made)) == {"<p>", "</p>"}, made
        assert words(shown) in words(html.unescape(re.sub(r"<[^>]*>", "", made)))
        assert "4711" not in made
