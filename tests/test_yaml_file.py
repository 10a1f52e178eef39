"""The guarded YAML loader: YAML 1.2, nothing ambiguous, nothing that grows."""

from __future__ import annotations

import math
import time

import pytest
from hypothesis import given
from hypothesis import strategies as st

from trackroller.errors import InputError, checked_text
from trackroller.files import read_text
from trackroller.yaml_file import parse_mapping, parse_yaml, write_yaml


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("30", 30),
        ("-0.5", -0.5),
        ("1e4", 1e4),
        (".5", 0.5),
        ("+1.5e-3", 1.5e-3),
        (".inf", math.inf),
        ("-.inf", -math.inf),
        ("true", True),
        ("~", None),
        ("", None),
        ('"030"', "030"),
        ("'yes'", "yes"),
        ("2026-01-01", "2026-01-01"),
        ("1.4301-annealed", "1.4301-annealed"),
        ("!!str 3", "3"),
        ("!!float 3", 3.0),
    ],
)
def test_a_value_is_read_as_yaml_1_2_has_it(text, value):
    found = parse_mapping(f"a: {text}", "file")["a"]
    assert found == value and type(found) is type(value)


@pytest.mark.parametrize(
    "text",
    [
        "030",
        "-007",
        "1:30",
        "1:30:15.5",
        "3_0",
        "1_000.5",
        "yes",
        "Off",
        "0x1F",
        "0o17",
        "0b1",
        "３０",
        "1e400",
        "9" * 400,
    ],
)
def test_an_ambiguous_value_is_refused_with_its_line_and_the_remedy(text):
    with pytest.raises(InputError, match=r"line 2.*quotes") as caught:
        parse_mapping(f"first: 1\na: {text}", "study file")
    assert text[:20] in str(caught.value)


@pytest.mark.parametrize("word", ["yes", "no", "on", "off"])
def test_a_key_is_a_text_whatever_yaml_1_1_made_of_it(word):
    assert parse_mapping(f"{word}: 1", "file") == {word: 1}


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("a: 1\na: 2", "each key once"),
        ("a: {b: 1, b: 2}", "each key once"),
        ("a: &x [*x]", "does not contain itself"),
        ("a: *nothing", "undefined alias"),
        ("a: !!python/object:os.system 1", "without tags"),
        ("a: 1\n---\nb: 1", "one document"),
        ("- 1", "mapping"),
        ("1: 2", "keys that are texts"),
        ("? [1]\n: 2", "keys that are texts"),
        ("a: [1, 2", "YAML"),
        ("a: " + "[" * 500 + "]" * 500, "levels"),
        ("\x00", "YAML"),
        ("", "mapping"),
    ],
)
def test_what_is_no_plain_mapping_is_refused(text, told):
    with pytest.raises(InputError, match=told):
        parse_mapping(text, "file")


def test_merge_keys_fill_what_a_mapping_leaves_out():
    text = "base: &b {mu: 0.1, load: 5}\none: {<<: *b, mu: 0.3}\ntwo: {<<: [{x: 1}, {x: 2, y: 3}]}"
    found = parse_mapping(text, "file")
    assert found["one"] == {"mu": 0.3, "load": 5} and found["two"] == {"x": 1, "y": 3}


def _aliases(width: int, depth: int, merge: bool) -> str:
    lines = ["a0: &a0 {x: 1}" if merge else "a0: &a0 [1, 1]"]
    for i in range(1, depth):
        many = ", ".join(f"*a{i - 1}" for _ in range(width))
        lines.append(f"a{i}: &a{i} {{<<: [{many}]}}" if merge else f"a{i}: &a{i} [{many}]")
    return "\n".join(lines)


@pytest.mark.parametrize("merge", [True, False])
@pytest.mark.parametrize("depth", [8, 12, 40])
def test_a_bomb_of_aliases_is_refused_while_it_is_read(merge, depth):
    started = time.process_time()
    with pytest.raises(InputError, match="aliases counted in full"):
        parse_yaml(_aliases(9, depth, merge), "materials file")
    assert time.process_time() - started < 2.0  # a bomb that is expanded takes minutes


def _is_allowed(text):
    """Return whether a file may hold a text; see the tests of names."""
    try:
        checked_text(text, "text", lines=True)
    except InputError:
        return False
    return True


words = st.text(st.characters(exclude_categories=("Cc", "Cf", "Cs", "Zl", "Zp", "Cn")), max_size=12).filter(_is_allowed)
plain = st.recursive(
    st.none() | st.booleans() | st.integers(-(10**15), 10**15) | st.floats(allow_nan=False) | words,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(words, inner, max_size=4),
    max_leaves=12,
)


@given(plain)
def test_what_is_written_is_read_back_as_it_was(value):
    assert parse_mapping(write_yaml({"value": value}), "file")["value"] == value


def test_only_a_regular_file_is_read(tmp_path):
    for path, told in ((tmp_path, "folder"), (tmp_path / "none.yaml", "does not exist"), ("/dev/zero", "regular file")):
        with pytest.raises(InputError, match=told):
            read_text(path, "study file")
    (tmp_path / "latin.yaml").write_bytes("a: é".encode("latin-1"))
    with pytest.raises(InputError, match="UTF-8"):
        read_text(tmp_path / "latin.yaml", "study file")
