"""The page answers at this machine and where the user forwards it, and only its owner learns the address."""

from __future__ import annotations

import time
import urllib.request

import pytest
from live_page import LivePage

pytest.importorskip("tornado")


@pytest.fixture(scope="module")
def forwarded(tmp_path_factory):
    """A page that may be asked for at the end of a tunnel, and behind a proxy."""
    options = ("--allow-host", "127.0.0.1:9999", "--allow-host", "Hub.example.org")
    page = LivePage(tmp_path_factory.mktemp("forwarded"), *options)
    yield page
    page.stop()


def origins(page):
    """Return hosts and origins as browsers send them, and whether a page that allows two hosts answers."""
    port = page.host.split(":")[1]
    return {
        (f"localhost:{port}", f"http://localhost:{port}"): True,
        (f"LOCALHOST:{port}", f"http://localhost:{port}"): True,
        ("127.0.0.1:9999", "http://127.0.0.1:9999"): True,
        ("hub.example.org", "https://hub.example.org"): True,
        (f"localhost:{port}", "https://hub.example.org"): True,  # a proxy that changes the host
        (f"localhost:{port}", "http://localhost:9999"): False,
        ("localhost:9999", "http://localhost:9999"): False,
        ("hub.example.org:8888", "https://hub.example.org:8888"): False,
        (f"hub.example.org:{port}", f"http://hub.example.org:{port}"): False,
        (f"evil.example:{port}", f"http://evil.example:{port}"): False,  # a name that leads to this machine
        (f"127.0.0.1:{port}@evil.example", "http://evil.example"): False,
        (f"localhost.evil.example:{port}", f"http://localhost.evil.example:{port}"): False,
        ("127.0.0.1", "http://127.0.0.1"): False,
        (f"127.0.0.1:{port}", "http://127.0.0.1:9998"): False,
    }


@pytest.mark.slow
def test_the_page_answers_at_localhost_and_where_the_user_allows_it(forwarded):
    for (host, origin), allowed in origins(forwarded).items():
        status, found = forwarded.send("listing", b"{}", Host=host, Origin=origin)
        assert (status == 200) == allowed, (host, origin, found)
        status, text, headers = forwarded.get("", Host=host)
        if status == 200:
            policy = headers["Content-Security-Policy"]
            assert policy.endswith("https://hub.example.org") and "http" not in policy.partition("frame-ancestors")[0]
        elif "@" not in host:  # the server library itself refuses a name that no browser sends, without words
            assert "--allow-host" in text and "localhost:" in text


@pytest.mark.slow
def test_other_hosts_are_refused_where_none_is_allowed(live):
    own = {f"{name}:{live.host.split(':')[1]}" for name in ("localhost", "127.0.0.1")}
    for host, origin in origins(live):
        status, found = live.send("listing", b"{}", Host=host, Origin=origin)
        assert (status == 200) == (host.lower() in own and origin == f"http://{host.lower()}"), (host, origin)
        assert host.lower() in own or "@" in host or "--allow-host" in found["errors"][0]["message"]


@pytest.mark.parametrize("host", ["http://127.0.0.1:9999", "*", "a b", "", "x/y", "127.0.0.1:port", "-", "a;b"])
def test_a_wrong_host_is_bad_input(tmp_path, host):
    page = LivePage(tmp_path, f"--allow-host={host}")
    assert page.process.wait(60) == 2
    told = page.process.stderr.read()
    assert "--allow-host" in told and "address line" in told and len(told.splitlines()) == 1


def test_a_second_start_says_that_the_first_does_not_answer_there(forwarded):
    second = LivePage(forwarded.folder, "--allow-host", "hub.example.org")
    assert second.process.wait(60) == 0 and forwarded.address in second.line
    second = LivePage(forwarded.folder, "--allow-host", "other.example.org")
    assert second.process.wait(60) == 1 and "other.example.org" in second.process.stderr.read()


def test_the_address_is_for_its_owner_only(tmp_path):
    """Neither the arguments of the browser nor a file that others can read hold the token."""
    told, place = tmp_path / "arguments", tmp_path / "folder"
    (place / ".trackroller").mkdir(parents=True)
    for name in ("address.json", "open.html"):
        (place / ".trackroller" / name).write_text("")
        (place / ".trackroller" / name).chmod(0o644)
    browser = tmp_path / "browser"
    browser.write_text(f'#!/bin/sh\necho "$@" > {told}.part; mv {told}.part {told}\n')
    browser.chmod(0o755)
    page = LivePage(place, browser=f"{browser} %s")
    while not told.exists():
        time.sleep(0.05)
    token, opened = page.address.split("/")[3], told.read_text().strip()
    assert len(token) > 30 and token not in opened and opened.startswith("file://")
    assert f'url={page.address}"' in urllib.request.urlopen(opened).read().decode()
    for file in (place / ".trackroller").iterdir():
        assert file.name == "lock" or file.stat().st_mode & 0o777 == 0o600, file
    page.stop()
    assert {file.name for file in (place / ".trackroller").iterdir()} == {"lock"}
