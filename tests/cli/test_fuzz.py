"""A study, case, materials or table file with any content is read, or refused with a clean error."""

from __future__ import annotations

import copy
from pathlib import Path

import pytest
import yaml
from examples import EXAMPLES
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from trackroller.cli.case import case_of, solve_case
from trackroller.errors import InputError
from trackroller.materials import load_database
from trackroller.roller.case import Case
from trackroller.study.file.load import load_study

ROOT = Path(__file__).parents[2]
STUDIES = [yaml.safe_load(p.read_text()) for p in sorted((ROOT / "config" / "studies").glob("*.yaml"))]
MATERIALS = yaml.safe_load((ROOT / "config" / "materials.yaml").read_text()) or {}
FILES = EXAMPLES // 5  # of each of five kinds
MOST = settings(max_examples=FILES, derandomize=EXAMPLES <= 1000, suppress_health_check=list(HealthCheck))

odd = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.floats(),
    st.text(max_size=20),
    st.binary(max_size=5),
    st.dates(),
    st.sampled_from(
        [
            10**400,
            -1,
            0,
            1e308,
            float("nan"),
            float("inf"),
            "..",
            "/etc/passwd",
            "inf",
            "<b>",
            "\u202e",
            "1e5",
            "__import__('os')",
            "axial_force",
            "PA6",
            [],
            {},
            [[]],
            {"uniform": [0, 1]},
        ]
    ),
)
anything = st.recursive(
    odd,
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.dictionaries(
            st.one_of(
                st.text(max_size=8), st.integers(), st.none(), st.sampled_from(["values", "name", "base", "uniform"])
            ),
            inner,
            max_size=4,
        )
    ),
    max_leaves=8,
)


@st.composite
def broken(draw, wholes):
    """Return a good file with one to three values replaced, keys renamed or parts left out."""
    data = copy.deepcopy(draw(st.sampled_from(wholes)))
    for _ in range(draw(st.integers(1, 3))):
        place = data
        while isinstance(place, (dict, list)) and place:
            keys = list(place) if isinstance(place, dict) else list(range(len(place)))
            key = draw(st.sampled_from(keys))
            inner = place[key]
            if isinstance(inner, (dict, list)) and inner and draw(st.booleans()):
                place = inner
                continue
            kind = draw(st.sampled_from(["value", "value", "key", "drop"]))
            if kind == "value":
                place[key] = draw(anything)
            elif kind == "drop":
                del place[key]
            elif isinstance(place, dict):
                place[draw(st.text(max_size=6))] = place.pop(key)
            break
    return data


def written(path, data):
    """Return the data as YAML (Python's own tags where YAML has no word for it); text stays as it is."""
    path.write_text(
        data if isinstance(data, str) else yaml.dump(data, allow_unicode=True), encoding="utf-8", errors="replace"
    )
    return path


def read_cleanly(read, path):
    """Read a file; every error except a clean refusal goes on to pytest."""
    try:
        return read(path)
    except InputError as exc:
        assert str(exc)
        return None


@pytest.mark.slow
@MOST
@given(broken(STUDIES))
def test_study_files(tmp_path_factory, data):
    path = written(tmp_path_factory.mktemp("f") / "s.yaml", data)
    study = read_cleanly(load_study, path)
    if study is not None:
        assert Path("results", study.name).resolve().parent == Path("results").resolve()


@MOST
@given(st.text(alphabet=st.sampled_from("-:[]{}&*!|>#%@`'\"?,\n\t abc019.~<="), max_size=60))
def test_text_that_is_hardly_yaml(tmp_path_factory, text):
    folder = tmp_path_factory.mktemp("f")
    for read in (load_study, load_database, lambda p: solve_case(*case_of(p, []))):
        read_cleanly(read, written(folder / "x.yaml", text)) if text.strip() else None


@MOST
@given(broken([{**Case().as_dict(), "outputs": ["nonsense"]}]))
def test_case_files(tmp_path_factory, data):
    read_cleanly(lambda p: solve_case(*case_of(p, [])), written(tmp_path_factory.mktemp("f") / "c.yaml", data))


@MOST
@given(broken([MATERIALS] if MATERIALS else [{}]))
def test_materials_files(tmp_path_factory, data):
    read_cleanly(load_database, written(tmp_path_factory.mktemp("f") / "m.yaml", data))


@MOST
@given(
    st.lists(
        st.lists(
            st.one_of(
                st.text(max_size=6),
                st.sampled_from(
                    ["axial_force", "material_pair", "PA6 / POM", "nan", "inf", "1e400", "-", "1", '"', "typical", "-7"]
                ),
            ),
            max_size=4,
        ),
        max_size=5,
    ),
    st.sampled_from([",", ";", "\t", ",\r"]),
)
def test_tables(tmp_path_factory, rows, mark):
    folder = tmp_path_factory.mktemp("f")
    text = "\n".join(mark.join(row) for row in rows)
    (folder / "t.csv").write_text(text, encoding="utf-8", errors="replace", newline="")
    path = written(folder / "s.yaml", {"name": "t", "method": "table", "table": "t.csv"})
    read_cleanly(lambda p: load_study(p).design(), path)


@pytest.mark.parametrize(
    "raw",
    [
        b"\xff\xfe\xff",
        b"\x00",
        b"a" * 100_000,
        b"[" * 5_000,
        b"{a: " * 5_000,
        b"- " * 5_000,
        b"&a [*a]",
        b"%YAML 9.9\n---\n",
        b"a: !!binary x",
        b"? ",
        b"!!set {a}",
    ],
)
def test_raw_bytes(tmp_path, raw):
    path = tmp_path / "x.yaml"
    path.write_bytes(raw)
    for read in (load_study, load_database, lambda p: solve_case(*case_of(p, []))):
        with pytest.raises(InputError):
            read(path)
