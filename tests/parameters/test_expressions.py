"""Expressions over columns: NaN is never decided, and odd literals are refused in words."""

import random

import numpy as np
import pytest

from trackroller.errors import InputError
from trackroller.parameters import expressions

COLUMNS = {
    "n": np.array([2.0, 1.0, np.nan]),
    "x": np.array([0.0, -1.0, 3.0]),
    "m": np.array(["PA6", "POM", "PA6"], dtype=object),
    "given": np.array([0.1, None, 2.0], dtype=object),
}


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("where(n, 1, 0)", [1, 1, np.nan]),
        ("where(n > 1, 1, 0)", [1, 0, np.nan]),
        ("where(not n > 1, 1, 0)", [0, 1, np.nan]),
        ("where(n != 1, 1, 0)", [1, 0, np.nan]),
        ("where(x > 0 or n > 1, 1, 0)", [1, 0, np.nan]),
        ("where(sqrt(x) > 1, 1, 0)", [0, np.nan, 1]),
        ("where(given > 1, 1, 0)", [0, np.nan, 1]),
        ("where(where(n > 1, 'a', 'b') == 'a', 1, 0)", [1, 0, np.nan]),
        ("where(m == 'PA6', x, n)", [0, 1, 3]),
        ("(n > 1) * 2", [2, 0, np.nan]),
        ("n ** 0", [1, 1, np.nan]),
        ("1 ** n", [1, 1, np.nan]),
    ],
)
def test_what_needs_a_value_that_is_not_known_is_not_known(text, values):
    assert np.array_equal(expressions.evaluate(text, COLUMNS), values, equal_nan=True)


@pytest.mark.parametrize("name", [n for n, (_, arity) in expressions.FUNCTIONS.items() if arity < 3])
def test_every_function_keeps_nan(name):
    arity = expressions.FUNCTIONS[name][1]
    for place in range(arity):
        args = ["1"] * arity
        args[place] = "n"
        assert np.isnan(expressions.evaluate(f"{name}({', '.join(args)})", COLUMNS)[2])


@pytest.mark.parametrize("text", ["n > 1", "n != 1", "not n > 1", "n > 1 or x > 0", "where(n > 1, 'a', 'b') != 'a'"])
def test_a_condition_does_not_hold_where_a_value_is_not_known(text):
    assert not expressions.condition(text, COLUMNS)[2]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("where(x, 'a', 2)", "a text beside a number"),
        ("where(m, 1, 2)", "a text as its condition"),
        ("'3' * 2", "arithmetic with a text"),
        ("'3'", "gives a text"),
        ("9" * 400, "too large"),
        ("1e400 * x", "too large"),
        ("x + 1e-400", "too small"),
    ],
)
def test_odd_literals_are_refused_in_words(text, words):
    with pytest.raises(InputError, match=words):
        expressions.evaluate(text, COLUMNS)


@pytest.mark.parametrize(
    ("text", "remedy"),
    [
        ("x^2", r"the sign \^ .*Write \*\* for a power"),
        ("x²", r"Write \*\* for a power"),
        ("x // 2", "Write / for a quotient"),
        ("0,5*x", "Write decimals with a point"),
        ("max(0,5; x)", "Separate the arguments of a function by commas"),
        ("x < 1,5", "Write decimals with a point"),
        ("2(x)", r"Write \* for a product"),
        ("2x", r"Write \* for a product"),
        ("x × 2", r"Write \* for a product"),
        ("x − 1", "Write - for a minus"),
        ("x if n > 1 else 2", r"Write where\(condition, one, other\)"),
        ("ln(x)", r"= 'ln' is not known. Allowed: the functions .* Write log\."),
        ("np.sqrt(x)", r"= 'np.sqrt' is not known. .*Write sqrt\(...\)"),
        ("math.pi * x", "Write sqrt.* and pi without"),
        ("x <> 2", "Write != "),
        ("x => 2", "Write <= or >="),
        ("x && n", "Write and, or"),
        ("sqrt(x", "Close each bracket once"),
        ("x = 2", "Write == "),
        ("lambda: 1", "neither arithmetic nor a comparison"),
    ],
)
def test_signs_of_other_languages_are_refused_with_what_to_write(text, remedy):
    with pytest.raises(InputError, match=remedy) as caught:
        expressions.evaluate(text, COLUMNS)
    assert not any(word in str(caught.value) for word in ("binop", "tuple", "ifexp", "attribute"))


def test_any_row_of_tokens_is_evaluated_or_refused():
    pick = random.Random(3)
    words = "n x m given 1 2.5 'a' b'a' inf pi 1e999 None True ... lambda if else is in and or not".split()
    words += "+ - * / ** % , < > == != ( ) [ ] { } := @ // ~ & where( min( max( sqrt( round( sign(".split()
    words += ["9" * 350, "\ud800", "\0", "f'{x}'"]
    calls = (expressions.evaluate, expressions.condition)
    for _ in range(4000):
        text = " ".join(pick.choice(words) for _ in range(pick.randint(1, 10)))
        for call in calls:
            try:
                call(text, COLUMNS)
            except InputError as error:
                assert str(error)
