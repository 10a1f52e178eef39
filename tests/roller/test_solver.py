"""The entry point: labels, units, groups, options, bad input."""

import numpy as np
import pytest
from reference_cases import solve_sliding

import trackroller as tr
from trackroller import parameters
from trackroller.roller.block_results import BlockResults, join
from trackroller.roller.dataset import VARIABLES, validity_bit


def test_single_case_has_no_case_dimension_and_a_batch_has():
    """Case, mapping, list and data set are all accepted and give the same numbers."""
    import xarray as xr

    one = solve_sliding(tr.Case())
    many = solve_sliding([tr.Case(), {"friction_coefficient": 0.1}])
    design = xr.Dataset({"friction_coefficient": ("case", [0.3, 0.1])})
    from_design = solve_sliding(design)
    assert "case" not in one.dims and many.sizes["case"] == 2
    np.testing.assert_array_equal(many.peak_stress, from_design.peak_stress)
    np.testing.assert_array_equal(one.peak_stress, many.peak_stress[0])


def test_every_variable_is_labelled():
    """Each variable has units, a long name, and dimensions of the table; flags have meanings."""
    ds = solve_sliding([tr.Case()], outputs=parameters.OUTPUT_GROUPS)
    for name in ds.data_vars:
        assert ds[name].attrs["units"] and ds[name].attrs["long_name"]
        if name in VARIABLES:
            assert ds[name].dims == ("case", *VARIABLES[name].dims)
    flags = {"regime", "converged", "validity", "validity_body", "contact_model_used", "first_to_fail"}
    flags |= {"limiting_mechanism", "limit_state"}
    # of another `life_criterion`, of a tolerance, and of a bound in place of a number
    elsewhere = {"fatigue_stress", "error_over_tolerance", "utilisation_at_most"}
    assert {v.name for v in VARIABLES.values()} == (set(ds.data_vars) - flags) | elsewhere
    assert ds.regime.attrs["flag_meanings"].split() == list(parameters.REGIMES)


def test_validity_flags_name_the_body():
    """A plastic body exceeds its own strength, not that of the steel; the case has the flags of both."""
    ds = solve_sliding([tr.Case(), tr.Case(roller_material="PA6"), tr.Case(guide_material="PA6")])
    static, body = validity_bit("static"), ds.validity_body.transpose("case", "body").values
    assert (body & static > 0).tolist() == [[False, False], [True, False], [False, True]]
    np.testing.assert_array_equal(body[:, 0] | body[:, 1], ds.validity)


def test_only_what_is_asked_for():
    """Each group adds its own variables and no others."""
    ds = solve_sliding(tr.Case(), outputs="forces")
    assert "normal_force" in ds and "peak_stress" not in ds and "max_pressure" not in ds


def test_netcdf_round_trip(tmp_path):
    """A result written and read by plain xarray keeps numbers, units and flags."""
    import xarray as xr

    ds = solve_sliding([tr.Case()])
    ds.to_netcdf(tmp_path / "r.nc")
    back = xr.open_dataset(tmp_path / "r.nc")
    np.testing.assert_array_equal(back.peak_stress, ds.peak_stress)
    assert back.normal_force.attrs["units"] == "N"


def test_sections_pass_through_the_peak():
    """The largest von Mises stress on the two sections comes close to the peak and never above it."""
    ds = solve_sliding(tr.Case(), outputs=("peak_stress", "subsurface"))
    for plane in ("xz", "yz"):
        top = ds[f"von_mises_{plane}"].max(dim=[d for d in ds[f"von_mises_{plane}"].dims if d.startswith("section")])
        assert np.all(top <= ds.peak_stress * 1.003) and np.all(top > 0.9 * ds.peak_stress)


def test_life_of_both_bodies():
    """The weaker contact decides; the guide's hours need its overrollings per hour."""
    ds = solve_sliding(tr.Case(guide_overrollings_per_hour=600.0))
    assert float(ds.roller_life_hours) == pytest.approx(float(ds.life_hours.sel(body="roller").min()))
    assert float(ds.guide_life_hours) == pytest.approx(float(ds.life_cycles.sel(body="guide").min()) / 600)
    assert np.isnan(solve_sliding(tr.Case()).guide_life_hours)
    slow = solve_sliding(tr.Case(velocity=30.0))
    assert float(slow.roller_life_hours) == pytest.approx(2 * float(ds.roller_life_hours))


def test_life_of_the_pair():
    """The pair lasts until its first body fails; without hours of the guide the roller stands for it, and says so."""
    rates = [1e-3, 1e6, None, 600.0, 600.0]
    cases = [tr.Case(guide_overrollings_per_hour=rate) for rate in rates]
    cases[3] = tr.Case(guide_overrollings_per_hour=600.0, axial_force=500.0)
    cases[4] = tr.Case(guide_overrollings_per_hour=600.0, radial_force=-0.05, axial_force=0.0, motor_force=0.0)
    ds = solve_sliding(cases, life_rule="unlimited")
    first = [ds.first_to_fail.attrs["flag_meanings"].split()[i] for i in ds.first_to_fail.values]
    assert first == ["roller", "guide", "unknown", "unknown", "none"]
    roller, guide, pair = (ds[f"{name}_life_hours"].values for name in ("roller", "guide", "pair"))
    assert pair[:2].tolist() == [roller[0], guide[1]] and guide[1] < roller[1]
    assert pair[2] == roller[2] and np.isnan(guide[2]) and np.isnan(pair[3]) and np.isposinf(pair[4])
    assert "guide_overrollings_per_hour is not given" in ds.pair_life_hours.attrs["comment"]


@pytest.mark.parametrize(
    "values, words",
    [
        ({"friction_coefficent": 0.1}, ("friction_coefficent", "friction_coefficient")),
        ({"friction_coefficient": -0.1}, ("friction_coefficient", "-0.1", ">= 0")),
        ({"friction_coefficient": float("nan")}, ("friction_coefficient", "nan")),
        ({"roller_profile_radius": -5.9}, ("roller_profile_radius", "conform or interlock")),
        ({"guide_curve_radius": -10.0}, ("guide_curve_radius", "inner curve")),
        ({"contact_angle": 90}, ("contact_angle", "90")),
        ({"radial_force": 10}, ("radial_force", "10")),
        ({"axis_distance": 4.0}, ("axis_distance", "rolling radius")),
        ({"roller_material": "1.7225-normalized"}, ("1.7225-normalized", "1.7225-normalised")),
        ({"axial_force": "much"}, ("axial_force", "much")),
        ({"velocity": True}, ("velocity", "True")),
    ],
)
def test_bad_values_are_named_with_the_remedy(values, words):
    """The message names the field, the value and what is allowed."""
    with pytest.raises(tr.InputError) as caught:
        solve_sliding(values)
    for word in words:
        assert word in str(caught.value)


@pytest.mark.parametrize(
    "option, value",
    [
        ("outputs", "force"),
        ("contact_model", "slidng"),
        ("spin_model", "skew"),
        ("hertz", "exakt"),
        ("accuracy", "high"),
        ("accuracy", 0.0),
        ("life_rule", "miner"),
        ("stress_bodies", "one"),
    ],
)
def test_bad_options_are_refused(option, value):
    """Unknown options are refused with the known ones named."""
    with pytest.raises(tr.InputError, match=option):
        tr.solve(tr.Case(), **{option: value})


def test_friction_from_the_database():
    """A case without friction coefficient takes the typical value of its pair, 'upper' the upper one."""
    pair = dict(roller_material="PA6", friction_coefficient=None)
    named = solve_sliding([pair, {**pair, "friction_coefficient": "upper"}], outputs=("contact",))
    explicit = solve_sliding([{**pair, "friction_coefficient": mu} for mu in (0.22, 0.30)], outputs=("contact",))
    np.testing.assert_array_equal(named.max_shear, explicit.max_shear)


def test_empty_batch():
    """No cases give an empty data set, not an error."""
    assert solve_sliding([]).sizes["case"] == 0


def test_a_table_of_hertz_is_refused_where_there_is_no_ellipse():
    with pytest.raises(tr.InputError, match=r"hertz = 'published'.*normal: halfspace"):
        solve_sliding(tr.Case(), hertz="published", normal="halfspace")


def test_blocks_keep_the_flags_of_each_body():
    """Rows that are taken from joined blocks keep the validity flags of roller and guide."""
    n = 3
    plain = {name: np.arange(n) for name in ("regime", "converged", "bits", "model", "rung", "stopped")}
    blocks = [
        BlockResults({"force": np.arange(n) + k}, **plain, bodies=np.arange(2 * n).reshape(n, 2) + k) for k in (0, 10)
    ]
    found = join(blocks).take(np.array([4, 0]))
    assert found.bodies.tolist() == [[12, 13], [0, 1]]
    assert found.values["force"].tolist() == [11, 0]
    assert join([blocks[0], BlockResults({}, **plain)]).take(np.array([0])).bodies is None
