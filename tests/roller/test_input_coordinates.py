"""The data set of `solve` carries its inputs as coordinates, with units."""

import pytest

import trackroller as tr

OPTIONS = {"contact_model": "sliding", "accuracy": "preview"}


def test_one_case_carries_its_inputs(tmp_path):
    case = tr.Case(radial_force=-150, motor_force=0, permissible_wear_depth=0.1, roller_material="PA6")
    ds = tr.solve(case, outputs=("forces", "wear"), **OPTIONS)
    assert (ds.radial_force.item(), ds.radial_force.units) == (-150.0, "N")
    assert ds.permissible_wear_depth.item() == 0.1 and ds.roller_material.item() == "PA6"
    assert "guide_overrollings_per_hour" not in ds.coords, "it is not given"
    assert not {"radial_force", "roller_material"} & set(ds.data_vars)
    ds.to_netcdf(tmp_path / "case.nc")
    import xarray as xr

    assert xr.load_dataset(tmp_path / "case.nc").axial_force.item() == 30.0


def test_many_cases_carry_theirs_along_case():
    cases = [tr.Case(motor_force=0, axial_force=force) for force in (0, 10, 20)]
    ds = tr.solve(cases, outputs=("forces",), **OPTIONS)
    assert ds.axial_force.dims == ("case",) and ds.axial_force.values.tolist() == [0.0, 10.0, 20.0]
    upper = ds.normal_force.swap_dims(case="axial_force").sel(axial_force=10.0, contact=2)
    assert upper.item() == pytest.approx(ds.normal_force.values[1, 1])
    assert ds.guide_material.values.tolist() == ["1.7225-normalised"] * 3


def test_friction_of_the_pair_is_a_number():
    ds = tr.solve(tr.Case(friction_coefficient=None, motor_force=0), outputs=("forces",), **OPTIONS)
    assert ds.friction_coefficient.item() == pytest.approx(0.19)


def test_a_profile_stands_in_the_place_of_the_radius():
    options = OPTIONS | {"contact_model": "kalker", "normal": "halfspace"}
    ds = tr.solve(tr.Case(roller_profile={"arc": -7}, motor_force=0), outputs=("forces",), **options)
    assert "roller_profile_radius" not in ds.coords and "guide_profile_radius" in ds.coords
