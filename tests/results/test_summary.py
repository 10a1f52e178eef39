"""`print` of the results of a study: ten lines, with the numbers of its table."""

import numpy as np

import trackroller as tr


def test_printed_results_are_ten_lines_with_the_numbers_of_the_table():
    factors = {"axial_force": {"values": [0, 300]}, "friction_coefficient": {"values": [0.1, 0.2]}}
    study = {"name": "small", "factors": factors, "base": {"motor_force": 0}, "description": "what friction does"}
    required = {"requirement": {"pair_life_hours": {"min": 5}}, "contact_model": "sliding", "accuracy": "preview"}
    results = tr.run(study | required, progress=False)
    lines = str(results).splitlines()
    assert lines == repr(results).splitlines() and 5 < len(lines) <= 10
    assert lines[0] == "Study 'small': what friction does" and "axial_force (2)" in lines[2]
    assert "2 rolling" in lines[4] and "2 lift off" in lines[4]
    name = results.life[0]
    lives = results.column(name)[results.rolling]
    (told,) = [line for line in lines if f"({name})" in line]
    assert f"{np.nanmin(lives):.4g} to {np.nanmax(lives):.4g} h" in told
    assert "at least 5" in lines[-2] and ".answer" in lines[-1]
