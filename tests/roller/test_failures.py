"""A case that fails says why and what to do, in Python, on the command line and in a study."""

from __future__ import annotations

import json

import numpy as np
import pytest
import xarray as xr
from command_line import trackroller
from reference_cases import solve_sliding

import trackroller as tr
from trackroller.roller.case import to_table
from trackroller.roller.failures import STEEP, with_reasons
from trackroller.roller.options import Options
from trackroller.study.file.load import parse_study
from trackroller.study.run import run_study
from trackroller.study.status import status_of
from trackroller.study.store.ledger import study_folder

BEYOND = {"axis_distance": 9.0, "guide_curve_radius": -5.0}  # beyond the axis of the curve
CURVE = {"contact_model": "kalker", "slip_terms": "curve"}
POINTS = [[x, 0.5 * (x * x) / -7] for x in np.linspace(-1, 1, 21).tolist()]


def said(case: dict, *, failed: bool = True, bits: int = 0, **options) -> str:
    """Return the reason of a case that fails (or just misses its tolerance), without solving it."""
    ds = xr.Dataset(
        {"regime": ((), 3 if failed else 0), "converged": ((), 0), "residual": ((), 3.21e-4), "validity": ((), bits)}
    )
    return str(with_reasons(ds, to_table(tr.Case(**case)), Options(**options))["reason"].item())


def test_hints_name_what_is_known_to_fail():
    halfspace = {"normal": "halfspace"}
    rough = said({"roller_profile": {"points": POINTS, "frame": "contact"}}, **halfspace)
    assert rough.startswith("no convergence, residual 3e-04. The roller_profile goes") and "smooth" in rough
    smoothed = {"points": POINTS, "frame": "contact", "smooth": 0.001}
    assert said({"roller_profile": smoothed}, **halfspace) == "no convergence, residual 3e-04"
    assert "steep_friction" in said({}, bits=STEEP, contact_model="kalker")


def reasons_of(**options) -> list[str]:
    """Return the reasons of cases on concave guides, whose contacts lie before and beyond the axis of the curve."""
    radii = (-8.0, -7.0, -6.0, -5.5, -5.19, -5.0, -4.5)
    told = [said({"axis_distance": 9.0, "guide_curve_radius": radius}, **options) for radius in radii]
    return ["axis of the inner curve" in words for words in told]


def test_the_axis_of_a_curve_is_named_only_where_the_contact_lies_beyond_it():
    """r_Curve + r_C,G cos(alpha) changes its sign at r_Curve = -5.196 mm; a curve of -8 mm is not the reason."""
    curve = {"slip_terms": "curve", "contact_model": "kalker"}
    assert reasons_of(**curve) == [False, False, False, False, True, True, True]
    assert not any(reasons_of(contact_model="kalker"))
    assert "axis" not in said({}, **curve) and "axis" not in said({"guide_curve_radius": float("inf")}, **curve)
    solved = tr.solve([{"axis_distance": 9.0, "guide_curve_radius": -8.0}], "forces", **curve)
    assert solved.regime.values.tolist() == [0], "the row that is not blamed on the axis has a solution"


def test_each_hint_needs_its_own_condition():
    """A hint is given for the row, the contact model in use and the options whose condition holds, and no other."""
    points = {"roller_profile": {"points": POINTS, "frame": "contact"}}
    assert "smooth" not in said(points, normal="hertz")
    assert "steep" not in said({}, contact_model="kalker", bits=STEEP << 1)
    both = said(points, normal="halfspace", contact_model="kalker", bits=STEEP)
    assert "steep_friction" in both and "smooth" in both
    only = said(BEYOND, **CURVE, bits=STEEP)
    assert "axis of the inner curve" in only and "steep" not in only


def test_a_row_that_misses_its_tolerance_has_a_reason_and_others_have_none():
    assert "misses the tolerance, residual 3e-04" in said({}, failed=False)
    found = tr.solve([tr.Case(), tr.Case(**BEYOND)], "forces", **CURVE)
    assert found["regime"].values.tolist() == [0, 3]
    assert found["reason"].values[0] == "" and "axis of the inner curve" in found["reason"].values[1]
    assert "reason" not in solve_sliding(tr.Case(), "forces")


@pytest.mark.slow
def test_a_failed_case_ends_with_exit_1_and_its_reason(tmp_path):
    (tmp_path / "case.yaml").write_text("axis_distance: 9\nguide_curve_radius: -5\nslip_terms: curve\n")
    told = trackroller("solve", "case.yaml", cwd=tmp_path, code=1).stdout
    assert told.startswith("No solution: no convergence")
    assert "nan" not in told and "normal force" not in told and "limit" not in told.partition("options")[0]
    assert "Limit" not in told and "Life by fatigue" not in told  # nothing but the reason and the inputs is known
    done = trackroller("solve", "case.yaml", "--json", cwd=tmp_path, code=1)
    assert (
        "axis of the inner curve" in json.loads(done.stdout)["reason"]["value"]
        and "axis of the inner curve" in done.stderr
    )
    trackroller("solve", "case.yaml", "-o", "out.nc", cwd=tmp_path, code=1)
    with xr.open_dataset(tmp_path / "out.nc") as ds:
        assert "axis of the inner curve" in str(ds["reason"].item())
    assert "axis of the inner curve" in trackroller("plot", "case.yaml", cwd=tmp_path, code=1).stderr
    (tmp_path / "good.yaml").write_text("guide_curve_radius: inf\ncontact_model: sliding\n")
    told = trackroller("solve", "good.yaml", cwd=tmp_path).stdout
    assert "the hours of the guide are not known" in told and "No solution" not in told


def test_a_study_keeps_the_reasons(tmp_path):
    study = parse_study(
        {
            "name": "curved",
            "outputs": ["forces"],
            "base": {"axis_distance": 9.0},
            "slip_terms": ["curve"],
            "factors": {"guide_curve_radius": {"values": [-5, -8]}},
        }
    )
    plan = run_study(study, tmp_path)
    with xr.open_dataset(plan.folder.gathered) as ds:
        assert "axis of the inner curve" in ds["reason"].values[0] and ds["reason"].values[1] == ""
    (reason,) = status_of(study, study_folder(study.name, tmp_path)).by_reason
    assert "axis of the inner curve" in reason


@pytest.mark.parametrize("shortcuts", [True, False])
def test_rows_of_a_batch_get_their_own_reason(shortcuts):
    cases = [tr.Case(**BEYOND, velocity=v) for v in (50.0, 60.0)]
    found = tr.solve([*cases, tr.Case()], "forces", **CURVE, shortcuts=shortcuts)
    assert [bool(r) for r in found["reason"].values] == [True, True, False]
