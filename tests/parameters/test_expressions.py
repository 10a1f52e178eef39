"""Expressions over columns: NaN is never decided, and odd literals are refused in words."""

import random

import numpy as np
import pytest

from trackroller.errors import InputError
from trackroller.parameters import expressions
from trackroller.parameters.expressions import comparisons, condition, evaluate, names

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


def test_expressions_compute_what_they_say():
    """Arithmetic, functions, comparisons with texts, constants."""
    columns = {"a": np.array([1.0, 4.0]), "mode": np.array(["free", "driven"], dtype=object)}
    np.testing.assert_allclose(evaluate("2 * a ** 2 - sqrt(a) + max(a, 2)", columns), [2 - 1 + 2, 32 - 2 + 4])
    np.testing.assert_allclose(evaluate("where(mode == 'free', 0, -30)", columns), [0, -30])
    np.testing.assert_allclose(evaluate("where(a >= 2, cos(pi), +a)", columns), [1, -1])
    assert names("sin(a) + b * pi") == {"a", "b"}


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("__import__('os').system('true')", "character 1"),
        ("a.real", "names joined by a point at character 1"),
        ("a[0]", "neither arithmetic nor a comparison"),
        ("(lambda: a)()", "character 1"),
        ("[x for x in a]", "neither arithmetic nor a comparison at character 1"),
        ("a if a else a", "if and else at character 1"),
        ("open('f')", "character 1"),
        ("a +", "syntax error"),
        ("a + True", "character 5"),
        ("a + 'x'", "text"),
        ("sqrt(a, a)", "takes 1"),
        ("10 * tan(contact_angle)", r"contact_angle is in degrees. Write tan\(radians\(contact_angle\)\)"),
        ("9**9**9**9 * aa", "Did you mean 'a'"),
        ("(" * 400, "syntax error|nested"),
        ("a" * 600, "500 characters"),
        (3, "text"),
    ],
)
def test_unsafe_or_wrong_expressions_are_refused_with_their_place(text, says):
    """Nothing but arithmetic is evaluated; the message tells where."""
    with pytest.raises(InputError, match=says):
        evaluate(text, {"a": np.array([1.0, 2.0])})


def test_one_parser_serves_factors_constraints_and_stop_conditions():
    """A condition splits into comparisons; NaN meets no condition, not even !=."""
    assert names("peak_stress_roller_1 > 2 * R_m or slip < pi") == {"peak_stress_roller_1", "R_m", "slip"}
    parts = comparisons("peak_stress_roller_1 > 2 * R_m or regime == full_slip", "stop_if")
    assert [(p.name, p.symbol, p.limit) for p in parts] == [
        ("peak_stress_roller_1", ">", "2 * R_m"),
        ("regime", "==", "full_slip"),
    ]
    values = {"slip": np.array([0.1, np.nan, 0.3]), "max_pressure_1": np.array([[1.0], [2.0]])}
    found = condition("slip != 0.3 and max_pressure_1 < 2", values)
    np.testing.assert_array_equal(found, [[True, False, False], [False, False, False]])
    with pytest.raises(InputError, match="joined by 'or'"):
        comparisons("slip > 0.1 and slip < 0.2", "stop_if")
    with pytest.raises(InputError, match="neither arithmetic nor a comparison"):
        evaluate("(slip + 1)[1]", values)


def test_a_chain_of_comparisons_may_mix_constants_and_columns():
    columns = {"a": np.array([-1.0, 0.5, 3.0, 9.0]), "b": np.array([1.0, 1.0, 0.2, 1.0])}
    assert condition("0 < a < 10 * b", columns).tolist() == [False, True, False, True]
    assert condition("0 < 1 < a and 2 > 1", columns).tolist() == [False, False, True, True]
