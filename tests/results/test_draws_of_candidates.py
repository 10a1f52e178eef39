"""Designs are compared over draws of the use: rows that repeat others, or stand at ends of ranges, are none."""

import math

import numpy as np
import pandas as pd

import trackroller as tr

LIFE = "pair_life_to_first_limit_hours"
STEEL = dict.fromkeys(("roller_material", "guide_material"), "1.7225-quenched-tempered")
FACTORS = {
    "roller_profile_radius": {"values": [-6.4, -7.5]},
    "friction_coefficient": {"uniform": [0.08, 0.25]},
    "radial_force": {"uniform": [-200, -80]},
}


def run(design, samples, **keys):
    study = {
        "name": "drawn",
        "base": {"motor_force": 0, "axial_force": 10, "guide_overrollings_per_hour": 200, **STEEL},
    }
    study |= {"factors": FACTORS, "method": design, "samples": samples, "contact_model": "sliding"}
    return tr.run(study | {"accuracy": "preview"} | keys, progress=False)


def test_the_mixed_rows_of_saltelli_do_not_narrow_an_interval():
    """Each base sample has the rows A, AB_1 to AB_3 and B; only A and B share no value with another row."""
    results = run("saltelli", 32, second_order=False)
    frame = pd.DataFrame({n: results.table[n].to_numpy() for n in FACTORS}).assign(life=results.column(LIFE))
    own = frame[np.isin(np.arange(len(frame)) % 5, (0, 4))]
    table = results.candidates().table
    for _, one in table.iterrows():
        lives = np.sort(own["life"][own["roller_profile_radius"] == one["roller_profile_radius"]])
        assert one["cases"] == len(lives)
        assert one["b10"] == lives[math.ceil(0.1 * len(lives)) - 1]
        assert one["b10_high"] in lives
        assert one["b10_low"] in lives
