"""Every mutation finds its formula: the text that it changes stands once in the file that it names."""

from __future__ import annotations

import pytest

from validation.mutations import MUTATIONS, ROOT


@pytest.mark.parametrize("name", MUTATIONS)
def test_a_mutation_finds_its_formula_and_its_tests(name):
    mutation = MUTATIONS[name]
    text = (ROOT / "trackroller" / mutation.path).read_text(encoding="utf-8")
    assert text.count(mutation.before) == 1
    assert mutation.after != mutation.before
    assert all((ROOT / "tests" / test).is_file() for test in mutation.tests)
