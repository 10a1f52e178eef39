"""A legend fits into its figure."""

import pytest
from matplotlib.figure import Figure

from trackroller.report.figures.panels import legend


@pytest.mark.parametrize(("text", "columns"), [("a", 3), ("mean travel speed 21.3 to 49.5", 2), ("word " * 14, 1)])
def test_a_legend_has_as_many_columns_as_fit(text, columns):
    figure = Figure(figsize=(7.5, 3), layout="constrained")
    figure.add_subplot()
    legend(figure, [(f"{text} {i}", {"color": "k"}) for i in range(3)])
    assert figure.legends[0]._ncols == columns
    assert figure.legends[0].get_window_extent().width <= figure.bbox.width
