"""The program that measures the coverage of intervals of probabilities, on few seeds."""

import numpy as np

from validation.benchmarks import probability_intervals as program


def test_our_intervals_hold_the_truth_where_wilsons_do_not():
    """Ours cover at least 88 %; Wilson's stay below 85 % for a mean of four points."""
    unit = program.DESIGNS["sobol"](1 << 15, 1)
    exact = np.mean([event(unit) for event, _ in program.EVENTS.values()], axis=1)
    found = program.coverage("lhs", 100, 60, exact)
    assert (found["ours"] >= 0.88).all()
    shared = list(program.EVENTS).index("mean of four points, product")
    assert found["wilson"][shared] < 0.85 < found["ours"][shared]
    one = list(program.EVENTS).index("one factor, 50 %")
    assert found["ours half"][one] < 0.6 * found["wilson half"][one]
