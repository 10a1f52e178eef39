"""The built site in a browser: it asks no other server, its search works from file://, and no width cuts anything."""

from __future__ import annotations

import os
import subprocess
import sys
from contextlib import closing
from pathlib import Path

import pytest
from browser import CHROMIUM, Browser

pytest.importorskip("mkdocs")
pytestmark = [pytest.mark.browser, pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium")]

ROOT = Path(__file__).parents[2]
SEARCH = """(words => {
    const field = document.querySelector('.md-search__input');
    field.focus();
    field.value = words;
    field.dispatchEvent(new KeyboardEvent('keyup', {bubbles: true}));
})"""
FOUND = "document.querySelector('.md-search-result__link')"
CUT = """[...document.querySelectorAll('pre > code, .typeset, body')]
    .filter(part => part.scrollWidth > part.clientWidth + 1 && part.clientWidth > 0)
    .map(part => part.textContent.slice(0, 60))"""


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    folder = tmp_path_factory.mktemp("site")
    words = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", str(folder)]
    env = os.environ | {"NO_MKDOCS_2_WARNING": "1"}
    done = subprocess.run(words, cwd=ROOT, env=env, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    return folder


@pytest.fixture(scope="module")
def running():
    with closing(Browser()) as browser:
        yield browser


def test_no_page_asks_another_server(site):
    for page in site.rglob("*.html"):
        assert 'src="http' not in page.read_text(encoding="utf-8"), page.name


@pytest.mark.parametrize("name", ["index.html", "tutorial/first-roller.html"])
def test_the_search_works_without_a_server(site, running, name):
    page = running.open(site / name)
    page.until("document.querySelector('.md-search__input') !== null && window.IFrameWorker !== undefined")
    page.run(f"{SEARCH}('spin pole')")
    page.until(f"{FOUND} !== null")
    assert "theory.html" in page.run(f"{FOUND}.href")
    assert page.run("performance.getEntriesByType('resource').every(e => e.name.startsWith('file:'))")
    page.close()


def test_code_and_formulas_are_not_cut(site, running):
    """On a desktop nothing is cut; on a telephone code wraps, and only a wide formula scrolls in its own row."""
    for name in ("theory.html", "how-to.html", "reference.html", "designs.html"):
        page = running.open(site / name, width=1200)
        assert page.run(CUT) == [], name
        page.resize(400)
        assert page.run("document.documentElement.scrollWidth") <= 400, name
        assert page.run("document.querySelectorAll('pre > code').length") == page.run(
            "[...document.querySelectorAll('pre > code')].filter(c => c.scrollWidth <= c.clientWidth + 1).length"
        )
        page.close()


def test_formulas_are_typeset_without_a_script(site, running):
    page = running.open(site / "theory.html")
    assert page.run("document.querySelectorAll('.formula math').length") > 30
    assert page.run("document.querySelector('.formula .words code').textContent") == "roller/geometry.py"
    assert not page.run("document.body.textContent.includes('\\\\frac')")
    page.close()
