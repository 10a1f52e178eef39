"""Correlated factors and weighted lists: samples have both, and their distributions stay."""

import numpy as np
import pytest
from scipy.stats import kstest, norm, spearmanr

from trackroller.errors import InputError
from trackroller.methods.correlation import normal_correlation
from trackroller.methods.factor import parse
from trackroller.study.design.sampling import sample
from trackroller.study.file.load import parse_study

FACTORS = {
    "a": {"uniform": [0, 1]},
    "b": {"normal": [5, 2]},
    "c": {"loguniform": [1, 10]},
    "d": {"values": ["x", "y", "z"], "weights": [7, 2, 1]},
}
PAIRS = [["a", "b", 0.6], ["b", "c", -0.4]]
STUDY = {
    "name": "n",
    "factors": {
        "axial_force": {"uniform": [0, 20]},
        "radial_force": {"uniform": [-300, -100]},
        "friction_coefficient": {"uniform": [0.1, 0.2]},
    },
    "method": "lhs",
    "samples": 20,
}


@pytest.mark.parametrize("method", ["lhs", "sobol", "inner_outer"])
@pytest.mark.parametrize("seed", [1, 2])
def test_ranks_correlate_as_asked_and_marginals_stay_exact(method, seed):
    design = sample(FACTORS | {"d": FACTORS["d"] | {"scatter": True}}, method, 1024, seed, rank_correlations=PAIRS)
    a, b, c = (design.columns[name] for name in "abc")
    for one, other, rho in ((a, b, 0.6), (b, c, -0.4), (a, c, 0.0)):
        assert spearmanr(one, other).statistic == pytest.approx(rho, abs=0.025)
    for values, law in ((a, "uniform"), (b, norm(5, 2).cdf), (np.log10(c), "uniform")):
        assert kstest(values, law).pvalue > 0.05


def test_copula_is_gaussian():
    """The joint probability of two lower halves is 1/4 + arcsin(r) / 2 pi."""
    design = sample(FACTORS, "sobol", 4096, 3, rank_correlations=PAIRS)
    both = ((design.columns["a"] < 0.5) & (design.columns["b"] < 5)).mean()
    assert both == pytest.approx(0.25 + np.arcsin(normal_correlation(0.6)) / (2 * np.pi), abs=0.005)
    assert np.max(np.abs(normal_correlation(np.linspace(-1, 1, 9)) - np.linspace(-1, 1, 9))) < 0.02


def test_latin_hypercube_keeps_its_strata_and_the_independent_columns():
    plain, tied = sample(FACTORS, "lhs", 200, 1), sample(FACTORS, "lhs", 200, 1, rank_correlations=PAIRS)
    np.testing.assert_array_equal(np.sort(tied.unit, axis=0), np.sort(plain.unit, axis=0))
    for name in "ad":
        assert (tied.columns[name] == plain.columns[name]).all()
    assert (tied.columns["b"] != plain.columns["b"]).any()


@pytest.mark.parametrize("method", ["lhs", "sobol"])
def test_a_correlated_sample_repeats_with_its_seed_and_keeps_its_rows_where_it_grows(method):
    first, again = (sample(FACTORS, method, 300, 1, rank_correlations=PAIRS) for _ in range(2))
    np.testing.assert_array_equal(first.unit, again.unit)
    grown = sample(FACTORS, method, 600, 1, rank_correlations=PAIRS)
    assert np.array_equal(grown.unit[:300], first.unit) == (method == "sobol")
    assert spearmanr(grown.columns["a"], grown.columns["b"]).statistic == pytest.approx(0.6, abs=0.05)
    if method == "lhs":
        for values in grown.unit.T:
            assert sorted((values * 600).astype(int)) == list(range(600))
    assert (sample(FACTORS, method, 300, 2, rank_correlations=PAIRS).unit != first.unit).any()


def test_tiny_samples_are_drawn_too():
    for count in (1, 2, 5):
        assert sample(FACTORS, "lhs", count, 1, rank_correlations=PAIRS).size == count


def test_a_matrix_that_cannot_be_says_how_far_its_values_must_shrink():
    impossible = [["a", "b", 0.9], ["b", "c", 0.9], ["a", "c", -0.5]]
    with pytest.raises(InputError, match="Multiply all values by") as error:
        sample(FACTORS, "lhs", 10, 1, rank_correlations=impossible)
    text = str(error.value)
    share = float(text.split("by ")[1].split(" ")[0])
    scaled = [[one, other, share * rho] for one, other, rho in impossible]
    assert sample(FACTORS, "lhs", 10, 1, rank_correlations=scaled).size == 10


@pytest.mark.parametrize(
    ("entries", "says"),
    [
        ([["axial_force", "axal_force", 0.5]], "Did you mean"),
        ([["axial_force", "axial_force", 0.5]], "two different"),
        ([["axial_force", "radial_force", 1.0]], "below 1"),
        ([["axial_force", "radial_force", 0.5], ["radial_force", "axial_force", 0.4]], "once"),
        ("axial_force", "list"),
        ([["axial_force", "roller_material", 0.5]], "distribution"),
    ],
)
def test_wrong_correlations_are_refused_when_the_study_is_read(entries, says):
    factors = STUDY["factors"] | {"roller_material": {"values": ["PA6", "POM"]}}
    with pytest.raises(InputError, match=says):
        parse_study(STUDY | {"factors": factors, "rank_correlations": entries})


@pytest.mark.parametrize("method", ["saltelli", "morris", "central_composite", "plackett_burman"])
def test_designs_that_need_independent_factors_refuse_and_say_what_to_take(method):
    entries = [["axial_force", "radial_force", 0.5]]
    with pytest.raises(InputError, match=rf"not {method}.*Take method: lhs"):
        parse_study(STUDY | {"method": method, "rank_correlations": entries})


def test_a_studied_correlation_is_drawn_and_takes_part_in_the_growth():
    study = parse_study(STUDY | {"samples": 200, "rank_correlations": [["axial_force", "radial_force", -0.7]]})
    design = study.design()
    assert spearmanr(design["axial_force"], design["radial_force"]).statistic == pytest.approx(-0.7, abs=0.05)
    assert "rank_correlations" in study.merged()


@pytest.mark.parametrize("method", ["lhs", "sobol", "saltelli"])
def test_values_are_drawn_by_their_weights(method):
    """The strata of a Latin hypercube of 100 hold 70, 20 and 10 of each value; other samples within chance."""
    design = sample({k: FACTORS[k] for k in "ad"}, method, 128 if method != "lhs" else 100, 1)
    share = [float((design.columns["d"] == value).mean()) for value in "xyz"]
    assert share == pytest.approx([0.7, 0.2, 0.1], abs=1e-12 if method == "lhs" else 0.02)
    assert set(np.unique(design.places[:, 1])) == {0, 1, 2}


def test_equal_weights_draw_what_no_weights_draw():
    spec = {"a": {"uniform": [0, 1]}, "d": {"values": [1, 2, 3, 4]}}
    weighed = spec | {"d": {"values": [1, 2, 3, 4], "weights": [5, 5, 5, 5]}}
    plain, other = (sample(s, "lhs", 64, 1).columns["d"] for s in (spec, weighed))
    np.testing.assert_array_equal(plain, other)


@pytest.mark.parametrize(
    ("spec", "method", "says"),
    [
        ({"values": [1, 2], "weights": [1, 2]}, "grid", "equally often.*choose method: lhs"),
        ({"values": [1, 2], "weights": [1, 2]}, "morris", "equally often"),
        ({"values": [1, 2], "weights": [1, 2]}, "inner_outer", "scatter: true"),
        ({"values": [1, 2], "weights": [1]}, "lhs", "2 finite numbers"),
        ({"values": [1, 2], "weights": [1, 0]}, "lhs", "above 0"),
        ({"values": [1, 2], "weights": 3}, "lhs", "list of 2"),
        ({"uniform": [1, 2], "weights": [1, 2]}, "lhs", "not of uniform"),
        ({"values": [1, 2], "weight": [1, 2]}, "lhs", "Did you mean 'weights'"),
    ],
)
def test_weights_are_refused_where_they_mean_nothing(spec, method, says):
    other = {"values": [1, 2]} if method == "grid" else {"normal": [0, 1]}
    with pytest.raises(InputError, match=says):
        sample({"x": spec, "y": other}, method, 8, 1)


def test_weights_pass_through_a_study_file():
    pair = {"material_pair": {"values": [["PA6", "PA6"], ["POM", "PA6"]], "weights": [0.75, 0.25]}}
    study = parse_study(STUDY | {"factors": STUDY["factors"] | pair})
    assert (study.design()["roller_material"].values == "PA6").sum() == 15
    assert parse("x", {"values": [1, 2], "weights": [70, 30]}).weights == (0.7, 0.3)
