"""The files around the package agree with it."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import yaml

import trackroller as tr

ROOT = Path(__file__).parents[2]


def test_one_version_stands_in_every_file():
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    meta = json.loads((ROOT / "codemeta.json").read_text(encoding="utf-8"))
    newest = re.search(r"^## (\S+)", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"), re.M)
    assert newest is not None
    assert {citation["version"], meta["version"], newest[1]} == {tr.__version__}


def test_a_citation_has_what_its_format_demands():
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert {"cff-version", "message", "title", "authors"} <= set(citation)
    assert re.fullmatch(r"10\.\d{4,9}/\S+", citation["references"][0]["doi"])


def test_the_contributing_page_lists_every_folder_of_the_package():
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    rooms = {path.parent.name for path in (ROOT / "trackroller").glob("*/__init__.py")}
    assert rooms == set(re.findall(r"^\| `(\w+)/`", text, re.M))


def test_the_licence_of_every_locked_package_is_listed():
    compared = subprocess.run([sys.executable, ROOT / "docs" / "licences.py"], check=False)
    assert compared.returncode == 0, "run: python docs/licences.py --write"
