"""Designs over their conditions, against plain pandas on the raw rows."""

import json
import math

import numpy as np
import pandas as pd
import pytest
from reference_cases import solve_sliding
from synthetic_results import results_of

import trackroller as tr
from trackroller.results.candidates import lift_off_margin, slip_margin
from trackroller.results.pareto import study_pareto
from trackroller.roller.regime_limits import limits
from trackroller.study.file.load import parse_study

GRID = {
    "name": "choose",
    "method": "grid",
    "outputs": ["forces", "contact", "peak_stress", "life"],
    "contact_model": "sliding",
    "base": {"guide_overrollings_per_hour": 600},
    "factors": {
        "roller_profile_radius": {"values": [-6.5, -8, -10]},
        "material_pair": {
            "values": [["1.7225-quenched-tempered", "1.7225-normalised"], ["1.7225-normalised", "PA6"]],
        },
        "friction_coefficient": {"values": [0, 0.1, 0.3]},
        "motor_force": {"values": [0, -30]},
        "axial_force": {"values": [0, 70]},
    },
}
SAMPLE = {
    "method": "inner_outer",
    "samples": 32,
    "base": {"guide_overrollings_per_hour": 600, "motor_force": 0},
    "factors": {
        "roller_profile_radius": {"values": [-6.5, -8]},
        "contact_angle": {"values": [30, 40]},
        "friction_coefficient": {"uniform": [0.05, 0.3]},
        "axial_force": {"uniform": [0, 40]},
    },
}


def solved(**changes):
    """Return a study solved with full sliding, as its view, and its rows as one plain table."""
    study = parse_study(GRID | changes)
    ds = solve_sliding(study.design(), outputs=GRID["outputs"], life_rule=changes.get("life_rule", "elementary"))
    design = study.design()
    names = [n for n, v in design.variables.items() if v.dims == ("case",) and n != "case"]
    if "material_pair" in study.factors:
        pairs = [f"{a} / {b}" for a, b in design[["roller_material", "guide_material"]].to_dataframe().values[:, -2:]]
        ds = ds.assign_coords(material_pair=("case", np.array(pairs, dtype=object)))
    ds = ds.assign_coords({n: design[n] for n in names} | {"case": design["case"]})
    materials = {m for n in ("roller_material", "guide_material") for m in set(design[n].values.tolist())}
    known = {m: vars(study.materials.material(m)) for m in materials}
    values = {m: {k: v for k, v in own.items() if k == "name" or isinstance(v, float)} for m, own in known.items()}
    ds.attrs |= {"study": study.merged(), "materials": json.dumps(values)}
    frame = pd.DataFrame({n: design[n].values for n in names})
    for name in (
        "regime",
        "converged",
        "validity",
        "first_to_fail",
        *(f"{b}_life_hours" for b in ("roller", "guide", "pair")),
    ):
        frame[name] = ds[name].values
    frame["rolls"] = (frame["regime"] == 0) & (frame["converged"] == 1)
    outside = sum(1 << ds["validity"].attrs["flag_meanings"].split().index(f) for f in OUTSIDE)
    frame["valid"] = frame["rolls"] & ((frame["validity"] & outside) == 0)
    for body in ("roller", "guide"):
        cycles = ds["life_cycles"].sel(body=body).min("contact").values
        knee = np.array([values[m]["cycles_at_fatigue_limit"] for m in frame[f"{body}_material"]])
        frame[f"{body}_beyond"] = cycles > np.minimum(knee, 1e8)
    frame["beyond"] = np.where(frame["first_to_fail"] == 1, frame["guide_beyond"], frame["roller_beyond"])
    return ds, frame


OUTSIDE = ("half_space", "yield", "static", "conformal", "steep_friction")
LIFE = "pair_life_hours"
CHOICES = ["roller_profile_radius", "roller_material"]


def compared(frame, choices, life):
    """Return the numbers of each design by a group-by on the raw rows, the best design first."""
    frame = frame.assign(life=frame[life].where(frame["valid"]))
    groups = frame.groupby(choices)
    found = groups.agg(cases=("life", "size"), rolls=("rolls", "sum"), valid=("life", "count"), worst=("life", "min"))
    found["median"], found["best"] = groups.life.median(), groups.life.max()
    known = frame[frame["valid"]].groupby(choices)
    for code, word in enumerate(("roller", "guide", "none", "unknown")):
        found[f"first_{word}"] = known.first_to_fail.apply(lambda values, code=code: (values == code).sum())
    found["beyond"] = known.beyond.sum()
    return found.sort_values(["valid", "worst"], ascending=False)


def test_drawn_conditions_that_no_design_holds_count_as_a_life_of_0():
    """The order statistic of the raw rows of all conditions."""
    factors = SAMPLE["factors"] | {"axial_force": {"uniform": [0, 150]}}
    ds, frame = solved(**SAMPLE | {"factors": factors})
    results, choices = results_of(ds), ["roller_profile_radius", "contact_angle"]
    lives = frame["pair_life_hours"].where(frame["valid"], 0.0)
    groups = lives.groupby([frame[name] for name in choices])
    expected = groups.apply(lambda own: np.sort(own)[math.ceil(0.1 * len(own)) - 1])
    found = results.candidates().table
    assert not frame["valid"].all()
    np.testing.assert_allclose(found.set_index(choices)["b10"].sort_index(), expected.sort_index())


@pytest.mark.slow
def test_margins_against_the_searched_limits():
    """Slip margin: what the drive leaves of the motor force at which the roller skids; lift-off: 0 where it lifts."""
    cases = [tr.Case(), tr.Case(friction_coefficient=0.1, motor_force=-10), tr.Case(axial_force=78.0)]
    ds = solve_sliding(cases)
    data = {
        n: ("case", np.array([getattr(c, n) for c in cases]))
        for n in ("friction_coefficient", "motor_force", "axial_force")
    }
    results = results_of(ds.assign_coords(data))
    edges = [limits(c, "sliding").motor_force[0] for c in cases[:2]]
    expected = [1 - c.motor_force / edge for c, edge in zip(cases, edges, strict=False)]
    np.testing.assert_allclose(slip_margin(results)[:2], expected, atol=5e-5)
    loads = ds["normal_force"].values
    np.testing.assert_allclose(lift_off_margin(results), loads.min(axis=1) / loads.max(axis=1))
    assert lift_off_margin(results)[2] < 0.01  # lifts at 78.08 N


def test_roles_of_the_study_file_decide_what_a_design_is():
    ds, frame = solved(roles={"friction_coefficient": "choice", "roller_profile_radius": "condition"})
    designs = results_of(ds).candidates()
    assert set(designs.choices) == {"friction_coefficient", "material_pair"} and len(designs.size) == 6
    expected = compared(frame, ["friction_coefficient", "roller_material"], "pair_life_hours")
    np.testing.assert_allclose(designs.table["worst"].dropna(), expected["worst"].dropna())


def test_a_condition_that_is_a_goal_is_no_condition():
    ds, frame = solved(pareto={"pair_life_hours": "max", "axial_force": "max"})
    front = study_pareto(results_of(ds))
    worst = frame[frame["valid"]].groupby([*CHOICES, "axial_force"]).pair_life_hours.min()
    assert sorted(front["pair_life_hours"].values) == pytest.approx(sorted(worst))
