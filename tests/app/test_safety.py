"""The server answers its own page only, in its own folder only, and says in words why it refuses."""

from __future__ import annotations

import http.client
import json
import signal
import socket
import urllib.request

import pytest
from live_page import LONG, STUDY, LivePage

from trackroller.app.server import LARGEST

ATTACKS = [
    "results/..%2f..%2fsecret/report.html",
    "results/small/..%2f..%2fsecret.html",
    "../secret",
    "results/%2e%2e/x",
]

LARGE = {"axial_force": {"linspace": [0, 30, 1000]}, "velocity": {"linspace": [1, 9, 1000]}}


def message(found):
    return found["errors"][0]["message"]


def test_a_request_without_the_token_is_refused(live):
    wrong = LivePage.__new__(LivePage)
    for address in (f"http://{live.host}/", f"http://{live.host}/wrong/", live.address[:-3] + "/"):
        wrong.address = address
        status, text, headers = wrong.get("")
        assert (status, "token" in text) == (403, True)
        assert "no-store" in headers["Cache-Control"]
        status, found = wrong.ask("picture", values={})
        assert (status, "token" in message(found)) == (403, True)


@pytest.mark.parametrize(
    "headers",
    [
        {"Origin": "http://evil.example"},
        {"Origin": "null"},
        {"Sec_Fetch_Site": "cross-site"},
        {"Sec_Fetch_Site": "same-site"},
        {"Host": "evil.example"},
        {"Content_Type": "text/plain"},
        {"Content_Type": "application/x-www-form-urlencoded"},
    ],
    ids=lambda h: " ".join(map(str, *h.items())),
)
def test_another_site_is_refused(live, headers):
    status, found = live.send("picture", b'{"values": {}}', **headers)
    assert status in (403, 415)
    assert message(found).endswith(".")


@pytest.mark.long
def test_the_page_trusts_its_own_script_only(live):
    _, text, headers = live.get("")
    policy = headers["Content-Security-Policy"]
    assert "script-src 'self'" in policy and "connect-src 'self'" in policy and "unsafe" not in policy
    assert "default-src 'none'" in policy and "http" not in policy.partition("frame-ancestors")[0]
    assert "<script>" not in text and " style=" not in text and " on" not in text.partition("<body>")[2]
    _, sheet, headers = live.get("sheet?case=%7B%7D")
    assert "sandbox" in headers["Content-Security-Policy"] and "Track roller" in sheet


@pytest.mark.parametrize(
    "body", [b"", b"{", b"[]", b"1", b'"text"', b"[" * 50_000, b"\xff\xfe", b"{}", b'{"values": [1]}']
)
def test_malformed_bodies_are_refused_in_words(live, body):
    status, found = live.send("picture", body)
    assert status == 400
    assert message(found).startswith("The request ")


def test_large_bodies_are_refused(live):
    status, found = live.send("picture", b" " * (LARGEST + 1))
    assert (status, "larger than" in message(found)) == (413, True)
    connection = http.client.HTTPConnection(live.host, timeout=30)
    connection.putrequest("POST", "/" + live.address.split("/", 3)[3] + "api/picture")
    connection.putheader("Content-Length", "4000000000")
    connection.endheaders()
    assert connection.getresponse().status in (400, 413)
    assert live.ask("picture", values={})[0] == 200


@pytest.mark.parametrize("path", ATTACKS)
def test_no_path_leads_out_of_the_folder(live, path):
    (live.folder.parent / "secret.html").write_text("secret")
    status, text, _ = live.get(path)
    assert status in (403, 404, 422)
    assert "secret" not in text.replace("/secret", "").replace("secret.html", "").replace("..secret", "")


@pytest.mark.parametrize("name", ["../outside", "/etc", "a/b", "", ".", "con", "x" * 300, 7, None, ["a"]])
@pytest.mark.parametrize("action", ["text_of", "pause", "resume", "delete"])
def test_names_of_studies_are_no_paths(live, name, action):
    status, found = live.ask(action, name=name, confirm=name)
    assert status in (400, 409, 422)
    assert message(found)


def test_a_link_in_the_results_is_not_followed(live):
    target = live.folder.parent / "elsewhere"
    target.mkdir(exist_ok=True)
    (target / "study.nc").write_text("")
    (live.folder / "results").mkdir(exist_ok=True)
    (live.folder / "results" / "linked").symlink_to(target)
    assert live.ask("delete", name="linked", confirm="linked")[0] == 422
    assert (target / "study.nc").exists()
    assert "linked" not in [one["name"] for one in live.ask("listing")[1]]


@pytest.mark.slow
def test_a_million_cases_are_refused_before_they_are_drawn(live):
    _, found = live.ask("checked", study={"name": "big", "factors": LARGE})
    assert "at most 200,000 cases" in message(found)
    text = "name: big\ndesign: sobol\nsamples: 1000000\nfactors: {velocity: {uniform: [1, 9]}}"
    _, found = live.ask("checked", text=text)
    assert "at most 200,000 cases" in message(found)
    assert live.ask("start", text="name: big\nfactors: {velocity: {linspace: [1, 9, 1000000]}}")[0] == 422
    until = "until: {half_width: 0.001, of: [roller_life_hours], at_most: 300000}"
    goals = "goals: {roller_life_hours: max}\nbudget: {designs: 300000}"
    for grows in (f"method: sobol\n{until}", f"method: optimise\n{goals}"):
        _, found = live.ask(
            "checked", text=f"name: big\nfactors: {{roller_profile_radius: {{uniform: [-8, -7]}}}}\n{grows}"
        )
        assert "at most 200,000 cases" in message(found), found["errors"]


@pytest.mark.parametrize("table", ["/etc/passwd", "../../secret.csv", "linked.csv"])
def test_a_study_reads_tables_of_its_folder_only(live, table):
    secret = live.folder.parent / "secret.csv"
    secret.write_text("axial_force\n4711\n")
    (live.folder / "studies").mkdir(exist_ok=True)
    if not (live.folder / "studies" / "linked.csv").is_symlink():
        (live.folder / "studies" / "linked.csv").symlink_to(secret)
    for question in ("checked", "start"):
        _, found = live.ask(question, text=f"name: stolen\ndesign: table\ntable: {table}")
        assert found["errors"][0]["field"] == "table"
        assert "root:" not in message(found) and "4711" not in message(found)
    (live.folder / "studies" / "own.csv").write_text("axial_force\n10\n20\n")
    assert live.ask("checked", text="name: fine\ndesign: table\ntable: own.csv")[1]["errors"] == []


def test_markup_in_names_stays_text(live):
    nasty = '<img src=x onerror="alert(1)">'
    _, found = live.ask(
        "checked", text=f"name: fine\ndescription: '{nasty}'\nfactors: {{velocity: {{values: [1, 2]}}}}"
    )
    assert found["study"]["description"] == nasty
    status, found = live.ask("picture", values={"roller_material": nasty})
    assert status == 422 and nasty in message(found)
    raw = live.get("")[1]
    assert nasty not in raw


def test_only_this_machine_is_served(live):
    port = int(live.host.split(":")[1])
    for host in {info[4][0] for info in socket.getaddrinfo(socket.gethostname(), None, socket.AF_INET)} - {"127.0.0.1"}:
        with pytest.raises(OSError):
            socket.create_connection((host, port), timeout=2).close()


def test_a_second_start_says_where_the_first_runs(live):
    second = LivePage(live.folder)
    assert live.address in second.line and "already" in second.line
    assert second.process.wait(30) == 0


def test_a_taken_port_is_named(live, tmp_path):
    second = LivePage(tmp_path, "--port", live.host.split(":")[1])
    code, said = second.process.wait(60), second.process.stderr.read()
    assert code == 1
    assert "is not free" in said and "Traceback" not in said


@pytest.mark.long
def test_a_study_survives_its_server_and_is_found_again(tmp_path):
    first = LivePage(tmp_path)
    assert first.ask("start", text=LONG) == (200, {"name": "long"})
    first.until("long", "running", cases=60)
    assert first.ask("start", text=LONG)[0] == 409
    assert first.ask("delete", name="long", confirm="long")[0] == 409
    first.stop(signal.SIGKILL)
    second = LivePage(tmp_path)
    assert second.until("long", "running")["total"] == 12_000
    assert second.ask("pause", name="long")[0] == 200
    paused = second.until("long", "paused")
    assert 0 < paused["done"] < 12_000
    assert second.ask("resume", name="long")[0] == 200
    second.until("long", "running", cases=paused["done"])
    assert second.ask("pause", name="long")[0] == 200
    second.until("long", "paused")
    code, said = second.stop()
    assert code == 0
    assert said.rstrip().splitlines()[-1] == "trackroller: the page is closed; studies that run go on."


@pytest.mark.long
def test_a_study_runs_to_its_report_and_is_deleted_after_asking(live):
    assert live.ask("start", text=STUDY)[0] == 200
    done = live.until("small", "done")
    assert (done["total"], done["done"], done["failed"], done["question"]) == (6, 6, 0, "What does friction do?")
    status, text, headers = live.get("results/small/report.html")
    assert status == 200 and "<title>" in text and "sandbox" in headers["Content-Security-Policy"]
    assert live.get("results/small/explorer.html")[0] == 200
    for address, head in {"results/small/cases.xlsx": b"PK", "roller.xlsx?case={}": b"PK"}.items():
        with urllib.request.urlopen(live.address + address) as answer:
            assert "attachment" in answer.headers["Content-Disposition"] and answer.read().startswith(head)
    one = live.ask("headlines", name="small")[1]
    assert one["cases"] == 6 and one["factors"]["Axial force F_ax"] == "0, 30 N"
    assert live.ask("delete", name="small", confirm="")[0] == 422
    assert live.ask("delete", name="small", confirm="small")[0] == 200
    assert live.entry("small") == {}
    assert json.loads(json.dumps(live.ask("text_of", name="small")[1]))["text"] == STUDY


@pytest.mark.parametrize("question", ["text_of", "headlines", "delete"])
def test_a_name_that_is_too_long_is_refused_in_words(live, question):
    status, answer = live.ask(question, name="n" * 300)
    assert status in (404, 422)
    assert "nternal error" not in answer["errors"][0]["message"]
