"""Numbers on pages have the digits that a reader needs."""

import json

from trackroller.report.numbers import level_text, near, symbol


def test_ends_of_a_range_are_rounded_to_the_range():
    assert near(0.24983, 0.25) == "0.25" and near(1.6e-5, 0.25) == "0"
    assert near(39.994, 12.0) == "40" and near(-250.3, 100.0) == "−250"


def test_a_friction_law_is_named_in_a_few_words():
    law = json.dumps({"kind": "linear", "speed": 50, "lowest": 0.3})
    assert level_text("friction_law", law) == "linear to 0.3 at 50 mm/s"


def test_each_symbol_of_a_parameter_or_result_can_be_drawn():
    from matplotlib.mathtext import MathTextParser

    from trackroller.parameters import PARAMETERS
    from trackroller.roller.dataset import VARIABLES

    parser = MathTextParser("agg")
    for one in (*PARAMETERS.values(), *VARIABLES.values()):
        parser.parse(symbol(one.symbol))
    assert symbol("h/G_3") == r"$h$/$G_\mathrm{3}$"
    assert symbol("alpha") == r"$\alpha$"
