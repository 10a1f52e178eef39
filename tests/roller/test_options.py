"""Options are declared once: other lists of options are derived from the declaration or compared with it."""

from __future__ import annotations

import dataclasses
import inspect
import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import trackroller as tr
from trackroller.parameters import CONTACT_MODELS, OPTIONS, options_text
from trackroller.roller.dataset import solved_by
from trackroller.roller.options import Options, model_in_use, options_of_cases
from trackroller.study.file.load import parse_study

ROOT = Path(__file__).parents[2]


def test_signature_and_docstring_of_solve_have_all_options_with_their_defaults():
    taken = {name: p for name, p in inspect.signature(tr.solve).parameters.items() if name not in ("cases", "database")}
    assert sorted(taken) == sorted(OPTIONS) == sorted(field.name for field in dataclasses.fields(Options))
    assert {p.default for p in taken.values()} == {None}, "None stands for the study file or the default of OPTIONS"
    told = re.findall(r"^    (\w+) : ", inspect.getdoc(tr.solve).replace("\n", "\n    "), flags=re.MULTILINE)
    assert told[: len(taken) + 2] == list(inspect.signature(tr.solve).parameters)


def test_every_word_of_an_option_is_explained_and_every_option_is_in_the_help():
    for option in OPTIONS.values():
        assert option.meaning and all(option.values.values()) and option.name in options_text()
        assert option.default is None or option.check(option.default) == option.default


def test_contact_models_keep_their_numbers():
    """New models come at the end, and a data set states the meaning of its own numbers."""
    assert CONTACT_MODELS[:3] == ["sliding", "kalker", "kalker_table"]
    used = xr.Dataset({"contact_model_used": ("case", [2, 0], {"flag_meanings": "sliding film kalker"})})
    assert solved_by(used).tolist() == ["kalker", "sliding"]


def test_the_table_serves_the_exact_theory_at_preview_only():
    def used(accuracy, law=""):
        return model_in_use(Options(contact_model="kalker", accuracy=accuracy), law)

    assert used("preview") == "kalker_table" and used("standard") == used("reference") == "kalker"
    assert used("preview", law='{"kind": "linear", "lowest": 0.5, "speed": 50}') == "kalker"


def test_a_spin_model_needs_the_contact_model_that_has_one():
    with pytest.raises(tr.InputError, match=r"spin_model = 'edge'.*contact_model: sliding"):
        Options(contact_model="kalker", spin_model="edge")
    grid = {"name": "g", "spin_model": ["edge", "skewed"], "factors": {"axial_force": {"values": [0.0, 10.0]}}}
    with pytest.raises(tr.InputError, match="spin_model"):
        parse_study(grid | {"contact_model": "kalker"})
    study = parse_study(grid | {"contact_model": ["sliding", "kalker"]})
    options, _ = options_of_cases(study.design(), {})
    assert [Options(**told).spin_model for told in options if told["contact_model"] == "kalker"] == ["skewed"] * 2
    assert {told["spin_model"] for told in options if told["contact_model"] == "sliding"} == {"edge", "skewed"}


DUMMY = """
import json, sys
from trackroller import parameters
from trackroller.parameters import options
parameters.OPTIONS["dummy"] = options.Option(
    "dummy", "first", "a choice for this test", {"first": "one", "second": "other"}, by_model=True)
import dataclasses
from trackroller.parameters.contact_models import DECLARED
for name in ("sliding", "kalker_table"):
    DECLARED[name] = dataclasses.replace(DECLARED[name], options=(*DECLARED[name].options, "dummy"))
import numpy as np
import trackroller as tr
from trackroller.roller.options import Options
from trackroller.roller.case import to_table
from trackroller.study.file.load import parse_study
from trackroller.study.store.fingerprint import fingerprints
from trackroller.study.file.schema import schema
from trackroller.cli.case import case_of
sys.path.insert(0, "docs")
import generate

table = to_table([tr.Case()])
def mark(**told):
    return fingerprints(table, told)[0].decode()
def refused(call):
    try:
        call()
    except tr.InputError as error:
        return str(error)
sliding = {"contact_model": "sliding"}
study = sliding | {"name": "a", "factors": {"axial_force": {"values": [1.0, 2.0]}}}
print(json.dumps({
    "schema": schema()["properties"]["dummy"],
    "help": parameters.options_text(),
    "attribute": tr.solve(tr.Case(), outputs="forces", **sliding).attrs["dummy"],
    "given": Options(dummy="second", **sliding).attributes()["dummy"],
    "without meaning": Options(dummy="second", contact_model="kalker").attributes()["dummy"],
    "set": case_of(None, ["dummy=second"])[1],
    "study": parse_study(study | {"dummy": "second"}).options["dummy"],
    "docs": "`dummy`" in generate.render(),
    "refused": [refused(lambda: Options(dummy="secnd")), refused(lambda: parse_study(study | {"dummy": "secnd"}))],
    "marks": [mark(**sliding), mark(dummy="first", **sliding), mark(dummy="second", **sliding),
              mark(contact_model="kalker"), mark(contact_model="kalker", dummy="second")],
}))
"""


@pytest.mark.long
def test_a_new_option_appears_everywhere_once_it_is_declared():
    done = subprocess.run([sys.executable, "-c", DUMMY], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert told["schema"]["enum"] == ["first", "second"] and told["schema"]["default"] == "first"
    assert told["schema"]["description"] == "a choice for this test"
    assert "dummy=first | second (first)" in told["help"] and told["docs"]
    assert (told["attribute"], told["given"], told["without meaning"]) == ("first", "second", "")
    assert told["set"] == {"dummy": "second"} and told["study"] == "second"
    assert all("Did you mean 'second'?" in words for words in told["refused"])
    plain, first, second, kalker, kalker_second = told["marks"]
    assert plain == first and len({plain, second, kalker}) == 3 and kalker == kalker_second


def used(model, **more):
    ds = tr.solve(tr.Case(), outputs="forces", contact_model=model, **more)
    return ds, solved_by(ds).item()


def test_the_table_of_the_exact_theory_is_a_model_with_a_name():
    """`kalker` at preview uses the table and says so; the table itself takes any accuracy."""
    quick, name = used("kalker", accuracy="preview")
    named, same = used("kalker_table", accuracy="preview")
    assert name == same == "kalker_table"
    np.testing.assert_array_equal(quick.spin_moment, named.spin_moment)
    exact, name = used("kalker", accuracy="standard")
    assert name == "kalker"
    fine, name = used("kalker_table", accuracy="standard")
    assert name == "kalker_table"
    np.testing.assert_array_equal(fine.lateral_force, named.lateral_force)
    np.testing.assert_allclose(fine.lateral_force, exact.lateral_force, rtol=0.02)
    assert np.all(fine.lateral_force != exact.lateral_force)


def test_where_the_table_does_not_serve_the_exact_theory_is_named():
    law = {"kind": "linear", "speed": 300.0, "lowest": 0.8}
    falling = tr.solve([tr.Case(), tr.Case(friction_law=law)], "forces", contact_model="kalker", accuracy="preview")
    assert solved_by(falling).tolist() == ["kalker_table", "kalker"]
    with pytest.raises(tr.InputError, match=r"^friction_law = .*kalker_table.*Take contact_model: kalker"):
        tr.solve(tr.Case(friction_law=law), "forces", contact_model="kalker_table")
    assert used("kalker", accuracy="preview", slip_terms="profile")[1] == "kalker"
    assert used("kalker", accuracy="preview", slip_terms="curve")[1] == "kalker_table"


@pytest.mark.parametrize("option, value", [("normal", "halfspace"), ("slip_terms", "profile")])
def test_options_that_the_table_cannot_have_are_refused(option, value):
    with pytest.raises(tr.InputError, match=rf"^{option} = .*kalker_table. Take contact_model: kalker"):
        tr.solve(tr.Case(), contact_model="kalker_table", **{option: value})


def test_the_package_shows_its_public_names_before_they_are_imported():
    """In a fresh process; importing the package alone loads neither the solver nor NumPy."""
    told = "sorted(dir(t)) == sorted(t.__all__), 'numpy' in sys.modules, t.Case().velocity"
    code = f"import sys, trackroller as t; print({told})"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True)
    assert done.stdout.split() == ["True", "False", "60.0"], done.stderr
