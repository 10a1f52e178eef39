"""Carriage files: units, files of rollers, and one sentence for each mistake."""

from __future__ import annotations

import numpy as np
import pytest
from carts import ROLLER, cart, rollers_below, rollers_between, shuttle

import trackroller as tr
from trackroller.carriage.file import load_carriage
from trackroller.carriage.solve import solve_carriage
from trackroller.cli.carriage import MANY
from trackroller.errors import InputError
from trackroller.files import files_beside
from trackroller.yaml_file import write_yaml


def test_units_and_directions():
    values = cart(mass={"value": "40000 g", "at": ["0.1 m", 0, 60]})
    values["rollers"]["FL"]["pushes"] = [0, 0, -7]
    whole = load_carriage(values)
    assert whole.mass.value == 40
    assert whole.mass.at.tolist() == [100, 0, 60]
    assert whole.rollers[0].pushes.tolist() == [0, 0, -1]


def test_gradients_in_per_cent_and_degrees():
    cases = [{"name": "a", "gradient": "100 %"}, {"name": "b", "gradient": "45 deg"}]
    angles = [case.gradient for case in load_carriage(cart(cases=cases)).cases]
    assert np.allclose(angles, np.pi / 4)


def test_cases_without_shares_share_the_travel():
    assert [case.share for case in load_carriage(cart(cases=[{"name": "a"}, {"name": "b"}])).cases] == [0.5, 0.5]


def test_a_file_with_the_files_of_its_rollers(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path.parent)
    (tmp_path / "roller.yaml").write_text(write_yaml(ROLLER))
    (tmp_path / "cart.yaml").write_text(write_yaml(cart(rollers=rollers_below(roller="roller.yaml"))))
    whole = load_carriage(tmp_path / "cart.yaml")
    assert whole.rollers[0].case.friction_coefficient == 0.1
    assert whole.rollers[0].options == {"contact_model": ["sliding"]} or whole.rollers[0].options["contact_model"]


SCATTERED = {"like": "1.7225-quenched-tempered", "scatter_in_cycles": 4.0}


def with_scatter(**options):
    """Return a carriage whose roller and rail have a scatter, with options in the file of the roller."""
    roller = ROLLER | {"roller_material": SCATTERED, "guide_material": SCATTERED, "guide_overrollings_per_hour": 60}
    return cart(rollers=rollers_below(roller=roller | options))


def test_the_failures_of_a_carriage_are_those_of_the_files_of_its_rollers():
    once = solve_carriage(with_scatter() | {"failures": "10%"})
    each = solve_carriage(with_scatter(failures="10%"))
    assert np.array_equal(once["life_hours"], each["life_hours"]) and once.attrs["failure_probability"] == 0.1
    median = solve_carriage(with_scatter())
    assert np.allclose(median["life_hours"], 2.0 * once["life_hours"], rtol=1e-9)  # T_N = N_90/N_10 = 4, fatigue first
    assert median.attrs["failure_probability"] == 0.5


def test_failures_that_contradict_each_other_are_refused():
    with pytest.raises(InputError, match=r"rollers\.FL.*is another one.*Remove it there"):
        load_carriage(with_scatter(failures="5%") | {"failures": "10%"})
    load_carriage(with_scatter() | {"failures": "10%"})  # the remedy
    with pytest.raises(InputError, match=r"another name of it"):
        load_carriage(with_scatter() | {"failures": "10%", "failure_probability": 0.1})
    with pytest.raises(InputError, match="between 0 and 1"):
        load_carriage(with_scatter() | {"failures": "110%"})


def changed_roller(**more):
    rollers = rollers_below()
    rollers["FL"] |= more
    return cart(rollers=rollers)


ON_A_LINE = {name: one | {"at": [one["at"][0], 0, 0]} for name, one in rollers_below().items()}
HALF = rollers_between()
for rear in ("RL", "RR"):
    HALF[rear]["kind"] = "floating"

MAKER = {"radial_force": 800, "axial_force": 300, "basic_life": 100}
WRONG = [
    (cart(rollers=ON_A_LINE), "rolls about the x axis without any resistance"),
    (shuttle(rollers=HALF), "pitches about the y axis without any resistance. Allowed: .*locating"),
    (cart(rollers=rollers_below(kind="floating")), "at least one locating roller.*kind: locating"),
    *(
        (shuttle(cases=[{"name": "run", "payload": own}]), r"payload = .* is no share; a mass in kg seems meant")
        for own in (5, 1.5, "5", "5 kg", "500 g")
    ),
    (shuttle(cases=[{"name": "run", "payload": "150 %"}]), "a share of the payloads from 0 to 1"),
    (shuttle(cases=[{"name": "run", "payload": -0.5}]), "a share of the payloads from 0 to 1"),
    (cart(cases=[{"name": "run", "payload": 0.5}]), r"payload = 0.5 has no payload to count.*Add payloads: \["),
    (changed_roller(catalogue=MAKER, roller=ROLLER | {"catalogue": MAKER}), "FL.catalogue = .* stands in both"),
    (changed_roller(kind="fixed"), "kind = 'fixed' is not known"),
    (cart(mass={"value": 40, "at": [200, 0, 60]}), "case = 'stand' tips the carriage.*pitches about the y axis"),
    (
        cart(mass={"value": "400 N", "at": [0, 0, 0]}),
        r"mass.value = '400 N' is a force. Allowed: a mass in kg. Write 40.78",
    ),
    (cart(cases=[{"name": "hill", "gradient": 5}]), r"case 'hill'.gradient = 5 has no unit.*Write 5 % or 5 deg"),
    (cart(cases=[{"name": "hill", "gradient": "95 deg"}]), r"gradient = '95 deg'"),
    (changed_roller(pushes=[0, -1, 1]), r"pushes = .* stands at 45 deg to x_R. Allowed: a direction perpendicular"),
    (changed_roller(pushes=[0, 0, 0]), "has no direction"),
    (changed_roller(x_R=[1, 0, 0]), "x_R = .*a direction across the track"),
    (changed_roller(at=[1, 2]), r"rollers.FL.at = \[1, 2\]"),
    (cart(cases=[{"name": "c", "speed": 1, "curve_radius": 1.5}]), "curve_radius: 1.5 m if metres are meant"),
    (cart(cases=[{"name": "c", "curve_radius": "1.5 m"}]), "case 'c'.speed is missing"),
    (cart(cases=[{"name": "a", "share": 0.5}]), "is the sum of the shares"),
    (cart(cases=[{"name": "a"}, {"name": "b", "share": 0.3}]), "case 'a'.share is missing.*as other cases have one"),
    (changed_roller(x_R=[0, 1, 0.0005]), "stands at 89.9714 deg"),
    ([1, 2], "the name of a carriage file, or a mapping"),
    (cart(cases=[{"name": "a"}, {"name": "a"}]), "a name of its own"),
    (cart(drive=None, cases=[{"name": "go", "acceleration": 1}]), r"drive.at is missing.*-?40 N in case 'go'"),
    (shuttle(preload=[{"pair": ["FL", "RL"], "force": 1}]), "press against each other on one line"),
    (shuttle(preload=[{"pair": ["FL", "FX"], "force": 1}]), "'FX' is not known"),
    (shuttle(preload=[{"pair": ["FL", "FR"]}]), "either force or play"),
    (shuttle(preload=[]), "does not hold the carriage: it .*preload"),
    (cart(rollers=None), "rollers is missing"),
    (cart(wheels={}), "carriage: key = 'wheels' is not known"),
    (changed_roller(roller={"contact_angle": 95}), "contact_angle = 95"),
]


@pytest.mark.parametrize(("values", "words"), WRONG)
def test_mistakes_are_named(values, words):
    with pytest.raises(InputError, match=words) as error:
        solve_carriage(values, lives=False)
    assert len(error.value.errors) == 1


@pytest.mark.parametrize("form", ["file", "mapping"])
def test_an_error_of_a_shared_roller_stands_once(tmp_path, form):
    shared = ROLLER | {"friction_coefficient": -1}
    (tmp_path / "roller.yaml").write_text(write_yaml(shared))
    own = {"file": "roller.yaml", "mapping": shared}[form]
    (tmp_path / "cart.yaml").write_text(write_yaml(cart()))
    with pytest.raises(InputError, match="friction_coefficient = -1") as error, files_beside(tmp_path / "cart.yaml"):
        load_carriage(cart(rollers=rollers_below(roller=own)))
    assert len(error.value.errors) == 1


def test_an_option_that_the_study_of_a_carriage_contradicts_is_named_once():
    keys = {"name": "s", "carriage": cart(), "factors": {"carriage_wheelbase": {"values": [300, 400]}}}
    with pytest.raises(InputError, match="the option of the study") as error:
        tr.load_study(keys | {"contact_model": "kalker", "outputs": ["forces", "life"]})
    assert len(error.value.errors) == 1


def test_load_cases_are_counted_one_by_one_for_the_progress_bar():
    cases = [{"name": str(i), "gradient": f"{i / 1000} %"} for i in range(2000)]
    told = []
    few = load_carriage(cart(cases=cases[:MANY], rollers=rollers_below(stiffness=1e4)))
    solve_carriage(few, lives=False, advanced=told.append)
    assert told == [1] * MANY
    assert len(load_carriage(cart(cases=cases)).cases) == 2000


@pytest.mark.parametrize(("given", "share"), [(0, 0), (0.5, 0.5), ("50 %", 0.5), (1, 1), ("100 %", 1)])
def test_shares_of_the_payloads(given, share):
    whole = load_carriage(shuttle(cases=[{"name": "run", "payload": given}]))
    assert whole.cases[0].payload == pytest.approx(share, rel=1e-15)


def test_errors_have_their_line(tmp_path):
    (tmp_path / "cart.yaml").write_text(
        "mass: {value: 40 kg, at: [0, 0, 0]}\nrollers:\n  FL: {at: [0, 0, 0], pushes: 3}\n"
    )
    with pytest.raises(InputError, match=r"line 3: rollers\.FL"):
        load_carriage(tmp_path / "cart.yaml")


def test_an_undecided_arrangement_needs_a_stiffness():
    rollers = rollers_below()
    for one in rollers.values():
        del one["roller"]
    with pytest.raises(InputError, match=r"rollers.FL.roller is missing.*the stiffness"):
        solve_carriage(cart(rollers=rollers))
