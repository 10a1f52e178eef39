"""Figures of studies and cases: drawn when the data allow, complete, and never a reason for a run to fail."""

from __future__ import annotations

import itertools
import json
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from matplotlib.text import Text
from reference_cases import solve_sliding
from synthetic_results import PAIRS, grid_study, results_of, sampled_study

import trackroller as tr
from trackroller.errors import InputError
from trackroller.materials import builtin_database
from trackroller.report.figures import style
from trackroller.report.figures.contact import plot_case
from trackroller.report.figures.contact_outline import case_name
from trackroller.report.figures.contact_sections import sections, surface_stress
from trackroller.report.figures.loads import forces_against_axial, stress_against_fit
from trackroller.report.figures.maps import regime_map
from trackroller.report.figures.panels import CLASSES, capped
from trackroller.report.figures.sensitivity import morris_plane
from trackroller.report.figures.study import OF_CASES, draw_all
from trackroller.report.numbers import level_text, number, rounded
from trackroller.results.case_columns import at_surface
from trackroller.results.factor_levels import spaced_by_ratio
from trackroller.results.sensitivity import analyse

ALL = {
    "stress_against_fit",
    "life_map",
    "forces_against_axial_force",
    "regime_map",
}
SMALL = {
    "friction_coefficient": [0.05, 0.3],
    "roller_profile_radius": [-8.0, -7.0, -6.4],
    "motor_force": [-30.0, 0.0],
    "material_pair": list(PAIRS[:2]),
    "axial_force": [0.0, 30.0, 130.0],
}


def drawn(ds: xr.Dataset, folder) -> set[str]:
    ds.to_netcdf(folder / "study.nc")
    return {info.name for info in draw_all(results_of(folder / "study.nc"), folder / "figures")}


@pytest.fixture
def unsaved(monkeypatch):
    """Render each figure once and write no file, for tests that look at what is drawn."""
    paths = (Path("figure.svg"), Path("figure.png"))
    monkeypatch.setattr(style, "save", lambda figure, out_dir, name: (figure.draw_without_rendering(), paths)[1])


@pytest.fixture(scope="module")
def grid(tmp_path_factory):
    folder = tmp_path_factory.mktemp("grid")
    return folder, drawn(grid_study(SMALL), folder)


@pytest.mark.slow
def test_a_full_grid_gets_every_figure_as_svg_and_png_with_captions(grid):
    folder, names = grid
    assert names == ALL
    index = json.loads((folder / "figures" / "index.json").read_text())
    assert {i["name"] for i in index} == ALL
    for item in index:
        assert item["caption"].endswith(".") and not item["sentence"]
        assert (folder / "figures" / f"{item['name']}.png").read_bytes()[:4] == b"\x89PNG"
        ET.parse(folder / "figures" / f"{item['name']}.svg")


def test_figures_are_the_wide_column_and_nothing_is_cut_off(grid):
    """Every figure is 170 mm wide and has no ink in the outermost pixels."""
    from matplotlib.image import imread

    folder, names = grid
    for name in names:
        image = imread(folder / "figures" / f"{name}.png")[..., :3]
        assert image.shape[1] == pytest.approx(170 / 25.4 * 300, abs=2)
        border = np.concatenate([image[:3].ravel(), image[-3:].ravel(), image[:, :3].ravel(), image[:, -3:].ravel()])
        assert border.min() > 0.97, name


@pytest.mark.slow
@pytest.mark.parametrize("make", [lambda: grid_study(SMALL), lambda: sampled_study(200)])
def test_every_text_has_at_least_seven_points(make):
    results = results_of(make())
    with style.look():
        for draw in OF_CASES:
            figure = (draw(results) or [None])[0]
            texts = figure.findobj(Text) if figure else []
            small = {t.get_text(): t.get_fontsize() for t in texts if t.get_text().strip() and t.get_fontsize() < 7}
            assert not small, draw.__name__


def test_a_sample_shows_medians_and_bands_and_is_not_coloured_by_its_own_fit():
    ds = sampled_study(300)
    names = ["friction_coefficient", "roller_profile_radius", "axial_force", "motor_force", "material_pair"]
    share = xr.DataArray([[0.1, 0.3, 0.1, 0.0, 0.2]], {"output": ["peak_stress_roller"], "factor": names})
    results = results_of(ds, xr.Dataset({"first": share}, attrs={"method": "lhs"}))
    with style.look():
        figure, info = stress_against_fit(results)
        forces, _ = forces_against_axial(results)
    assert "medians" in info.caption and "5 to 95 %" in info.caption
    names = [text.get_text() for text in figure.legends[0].get_texts()]
    assert sorted(names) == sorted(level_text("material_pair", pair) for pair in PAIRS[:3])
    one = ds.isel(case=results.column("regime") != 2)
    for axes in forces.axes[:1]:
        median = np.median(axes.lines[0].get_ydata())
        own = one["normal_force"].sel(contact=1, case=one["motor_force"] == -30)
        assert median == pytest.approx(float(own.median()), rel=0.15)
        assert all(len(line.get_xdata()) <= CLASSES for line in axes.lines) and len(axes.collections) == len(axes.lines)


def test_materials_of_the_same_stresses_share_a_line():
    factors = SMALL | {"material_pair": [PAIRS[0], PAIRS[1], PAIRS[3]]}
    ds = grid_study(factors)
    with style.look():
        figure, _ = stress_against_fit(results_of(ds, analyse(results_of(ds))))
    names = [text.get_text() for text in figure.legends[0].get_texts()]
    assert any(" and " in name for name in names) and len(names) == 4  # two lines, two kinds of marks


@pytest.mark.slow
def test_the_same_study_gives_the_same_svg(grid, tmp_path):
    folder, _ = grid
    for draw in (regime_map, forces_against_axial):
        with style.look():
            figure, info = draw(results_of(grid_study(SMALL)))
            again, _ = style.save(figure, tmp_path, info.name)
        assert again.read_bytes() == (folder / "figures" / f"{info.name}.svg").read_bytes()


@pytest.mark.slow
def test_a_sample_along_case_gets_every_figure(tmp_path, unsaved):
    assert drawn(sampled_study(200), tmp_path) == ALL


@pytest.mark.slow
def test_unlimited_lives_are_drawn_above_the_finite_ones(tmp_path, unsaved):
    values, top = capped(np.array([10.0, np.inf, np.nan, 0.0]))
    assert top == 100.0 and values[1] == 100.0 and np.isnan(values[2:]).all()
    assert "life_map" in drawn(grid_study(SMALL, unlimited=True), tmp_path)


def test_a_loads_only_study_gets_forces_and_regimes_only(tmp_path):
    ds = grid_study(
        {"axial_force": [0.0, 60.0, 130.0], "radial_force": [-200.0, -100.0]},
        only=("normal_force", "lateral_force", "driving_force"),
    )
    assert drawn(ds, tmp_path) == {"forces_against_axial_force", "regime_map"}


@pytest.mark.slow
@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_nothing_but_nan_or_inf_never_fails_a_run(tmp_path, value):
    ds = grid_study(SMALL)
    for name, variable in ds.data_vars.items():
        if variable.dtype.kind == "f":
            ds[name] = variable * np.nan + value if np.isnan(value) else xr.full_like(variable, value)
    drawn(ds, tmp_path)
    assert (tmp_path / "figures" / "index.json").is_file()


def test_every_case_failed_still_leaves_an_index(tmp_path):
    ds = grid_study(SMALL)
    ds["regime"][:] = 3
    for name, variable in ds.data_vars.items():
        if variable.dtype.kind == "f":
            ds[name] = variable * np.nan
    assert drawn(ds, tmp_path) == set()


def test_one_case_alone_draws_nothing_and_raises_nothing(tmp_path):
    assert drawn(sampled_study(1), tmp_path) == set()


EFFECTS = {
    "name": "effects",
    "contact_model": "sliding",
    "outputs": ["forces"],
    "method": "morris",
    "factors": {"friction_coefficient": {"uniform": [0.05, 0.3]}, "axial_force": {"uniform": [0, 40]}},
    "analysis": {"outputs": ["normal_force_1"]},
}


def test_one_effect_has_no_spread_and_no_figure(tmp_path):
    solved = tr.run(EFFECTS | {"samples": 1}, progress=False)
    sens = solved.analysis
    one = sens.sel(output="normal_force_1")
    assert np.isfinite(one["mu_star"]).any() and np.isnan(one["sigma"]).all()
    assert morris_plane(sens, "normal_force_1") is None
    assert "normal force" in solved.report(tmp_path / "report.html").read_text(encoding="utf-8")


def test_a_factor_with_one_valid_effect_is_left_out_of_the_figure_and_named():
    solved = tr.run(EFFECTS | {"samples": 2}, progress=False)
    sens = solved.analysis
    assert list(sens["effects_used"].sel(output="normal_force_1").values) == [1, 2]  # one row slips
    figure, info = morris_plane(sens, "normal_force_1")
    assert info.caption.endswith("Not drawn, because one effect has no spread: friction coefficient.")
    assert [text.get_text() for text in figure.legends[0].get_texts()][-1] == "Axial force"


def test_parameters_computed_from_factors_are_no_factors_but_can_be_drawn():
    ds = sampled_study(100)
    study = "factors: {ratio: {uniform: [1, 2]}, roller_profile_radius: {expression: -6 * ratio}}"
    ds = ds.assign_coords(ratio=("case", -ds["roller_profile_radius"].values / 6))
    ds.attrs["study"] = study
    results = results_of(ds)
    assert results.factors == ("ratio",) and results.behind("roller_profile_radius") == ("case",)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (1234.5, "1234"),
        (12345.0, "12,300"),
        (2.5e9, "2.5·10⁹"),
        (-7.0, "−7"),
        (np.inf, "∞"),
        (np.nan, "–"),
    ],
)
def test_numbers_read_as_an_engineer_writes_them(value, text):
    assert number(value) == text


def test_a_long_title_is_wrapped_within_the_figure():
    with style.look():
        figure = style.new_figure(40, 80)
        figure.subplots()
        style.head(figure, "Held: " + "roller profile radius −7 mm; " * 8)
        figure.draw_without_rendering()
        box = figure._suptitle.get_window_extent()
    assert box.x1 <= figure.bbox.x1 and box.height > 2 * figure._suptitle.get_fontsize()


def test_a_material_has_the_same_colour_in_every_list():
    steel, polyamide = "1.7225-normalised", "PA6"
    alone = dict(zip((steel, polyamide), style.colours([steel, polyamide], True), strict=True))
    pairs = style.colours([f"{polyamide} on {steel}", f"{steel} on itself", "my own on itself"], True)
    assert pairs[:2] == [alone[polyamide], alone[steel]] and pairs[2] not in alone.values()
    guides = style.colours([f"{steel} on {polyamide}", f"{steel} on itself"], True)
    assert guides == [alone[polyamide], alone[steel]]


@pytest.mark.parametrize(
    ("values", "logarithmic"),
    [(np.linspace(0.02, 0.4, 20), False), (np.geomspace(0.02, 0.4, 20), True), (np.array([0.0, 1.0, 100.0]), False)],
)
def test_only_levels_that_are_spaced_by_ratio_get_a_logarithmic_axis(values, logarithmic):
    assert spaced_by_ratio(values, 4.0) == logarithmic


OUTPUTS = ("forces", "contact", "peak_stress", "tractions", "subsurface")


@pytest.fixture(scope="module")
def solved():
    return solve_sliding(tr.Case(), outputs=OUTPUTS)


@pytest.mark.slow
def test_a_case_gets_shear_energy_and_sections_of_both_contacts(solved, tmp_path):
    infos = plot_case(solved, tmp_path)
    assert [i.name for i in infos] == ["contact_shear", "contact_energy", "contact_1_stress", "contact_2_stress"]
    for info in infos:
        drawn = ET.parse(tmp_path / f"{info.name}.svg").getroot()
        assert float(drawn.get("width").removesuffix("pt")) == pytest.approx(170 / 25.4 * 72)
        assert info.caption and info.sentence


def test_the_surface_map_is_highest_where_a_peak_at_the_surface_is_marked(solved):
    """The search finds the peak by quadrature over the ellipse, the map by convolution of the tractions on a grid."""
    found = 0
    for contact, body in itertools.product((1, 2), ("roller", "guide")):
        part = solved.sel(contact=contact, body=body)
        x, y, stress = surface_stress(solved, contact, body)
        assert stress.max() < 1.01 * float(part["peak_stress"])
        if at_surface(part) == 1:
            found += 1
            j, i = np.unravel_index(np.argmax(stress), stress.shape)
            assert stress.max() == pytest.approx(float(part["peak_stress"]), rel=0.02)
            assert (x[i], y[j]) == pytest.approx((float(part["peak_x"]), float(part["peak_y"])), abs=2 * (x[1] - x[0]))
    assert found
    with style.look():
        figure, info = sections(solved, 2)
    assert [axes.get_title(loc="left") for axes in figure.axes[2:6:3]] == ["Roller, surface", "Guide, surface"]
    assert "Default case" in info.caption
    bare = solved.drop_vars("shear_lateral")
    assert surface_stress(bare, 2, "roller") is None and len(sections(bare, 2)[0].axes) == 5


def test_a_case_is_named_by_what_differs_from_the_defaults():
    case = tr.Case(motor_force=0.0, axial_force=10.0, roller_material="PA6")
    named = case_name(solve_sliding(case, outputs=("forces",)))
    assert named == "axial force 10 N, free rolling and PA6 on 1.7225-normalised"


@pytest.mark.slow
def test_frictionless_and_tall_contacts_are_drawn(tmp_path, unsaved):
    """mu = 0 has no tractions to show; an ellipse longer in the rolling direction has its panels side by side."""
    free = solve_sliding(tr.Case(friction_coefficient=0.0, motor_force=0.0), outputs=OUTPUTS)
    assert {i.name for i in plot_case(free, tmp_path / "free")} == {"contact_1_stress", "contact_2_stress"}
    tall = solve_sliding(tr.Case(roller_profile_radius=5.0), outputs=("forces", "contact", "tractions"))
    assert {i.name for i in plot_case(tall, tmp_path / "tall")} == {"contact_shear", "contact_energy"}


@pytest.mark.slow
def test_a_lifted_contact_is_left_out(solved, tmp_path, unsaved):
    ds = solved.copy()
    for name, variable in ds.data_vars.items():
        if "contact" in variable.dims and variable.dtype.kind == "f":
            ds[name] = variable.where(ds["contact"] == 2)
    names = {i.name for i in plot_case(ds, tmp_path)}
    assert names == {"contact_shear", "contact_energy", "contact_2_stress"}


def test_several_cases_at_once_are_refused(tmp_path):
    ds = solve_sliding([tr.Case(), tr.Case()], outputs=("forces",))
    with pytest.raises(InputError, match="one case"):
        plot_case(ds, tmp_path)


def test_drawing_leaves_the_callers_matplotlib_alone(grid):
    """No change of rcParams and no pyplot figure left open."""
    import matplotlib
    import matplotlib.pyplot as plt

    before = matplotlib.rcParams["font.size"]
    with style.look():
        pass
    assert matplotlib.rcParams["font.size"] == before and not plt.get_fignums()


@pytest.mark.parametrize("motor_force", [-30.0, 0.0])
def test_a_case_that_lifts_off_is_solved_and_drawn(tmp_path, motor_force, unsaved):
    """A case without a contact to draw raises no error."""
    ds = solve_sliding(tr.Case(axial_force=150.0, motor_force=motor_force), outputs=OUTPUTS)
    assert int(ds["regime"]) == 2
    assert "contact_1_stress" not in {i.name for i in plot_case(ds, tmp_path)}


def test_numbers_are_rounded_once():
    """Rounding 288,549 to four figures and then to three gives 288,000; the nearest is 289,000."""
    assert (rounded(288_549), number(288_549), rounded(288_549, 4)) == ("289,000", "289,000", "288,500")
    for value in np.random.default_rng(1).uniform(0, 1, 2000) * 10.0 ** np.arange(-6, 14).repeat(100):
        for figures in (2, 3, 4):
            text = rounded(value, figures).translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")).replace(",", "")
            mantissa, _, power = text.partition("·10")
            assert float(f"{mantissa}e{power or 0}") == pytest.approx(float(f"{value:.{figures}g}"), rel=1e-12)
    assert (rounded(9999.6), rounded(-0.0), rounded(0.0009999), rounded(99999, 2)) == (
        "10,000",
        "0",
        "0.001",
        "100,000",
    )


def test_no_material_has_the_colour_of_a_contact_or_of_a_body():
    names = [*builtin_database().names(), *(f"steel {i}" for i in range(200))]
    assert len(set(style.PAIR)) == 2 and not set(style.PAIR) & set(style.colours(names, True))


def test_effects_of_one_trajectory_have_no_spread_and_no_figure():
    effects = {"mu_star": [[1.0, 2.0]], "sigma": [[np.nan, np.nan]]}
    indices = {name: (("output", "factor"), values) for name, values in effects.items()}
    assert morris_plane(xr.Dataset(indices, coords={"output": ["slip"]}), "slip") is None
