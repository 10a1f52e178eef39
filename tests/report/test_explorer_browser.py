"""The explorer in a real browser without a network: selection, display, search, export and bad input."""

from __future__ import annotations

import csv
import json
import re
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest
import yaml
from browser import CHROMIUM, Browser
from synthetic_results import PAIRS, grid_study, results_of, sampled_study

from trackroller.report.explorer.page import write_explorer
from trackroller.report.numbers import BEYOND
from trackroller.results.pareto import pareto, study_pareto
from trackroller.results.sensitivity import analyse
from trackroller.study.file.load import parse_study

pytestmark = [pytest.mark.browser, pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium")]

AXE = Path(__file__).resolve().parents[2] / "web" / "node_modules" / "axe-core" / "axe.min.js"
FACTORS = {
    "friction_coefficient": [0.05, 0.2, 0.3, 0.4],
    "roller_profile_radius": [-8.0, -7.0, -6.4],
    "material_pair": list(PAIRS),
    "motor_force": [-30.0, 0.0],
    "axial_force": [0.0, 30.0, 130.0],
    "guide_curve_radius": [220.0, float("inf")],
}
TWELVE = {
    **{name: [0.1, 0.2] for name in ("friction_coefficient",)},
    **{"roller_profile_radius": [-8.0, -7.0], "guide_curve_radius": [220.0, float("inf")], "motor_force": [-30.0, 0.0]},
    **{"axial_force": [0.0, 30.0], "radial_force": [-200.0, -150.0], "contact_angle": [30.0, 35.0]},
    **{"axis_distance": [21.0, 21.75], "velocity": [30.0, 60.0], "guide_profile_radius": [6.0, 5.9]},
    **{"guide_overrollings_per_hour": [100.0, 600.0], "material_pair": list(PAIRS[:2])},
}


def as_table(ds):
    """Return the results as those of a table of cases, from which `pareto` can restore the design."""
    told = yaml.safe_load(ds.attrs["study"]) | {"method": "table", "factors": {}}
    return ds.assign_attrs(study=yaml.safe_dump(told))


def failed(ds):
    """Return the study with no solution in any case."""
    ds = ds.copy(deep=True)
    ds["regime"][:] = 3
    ds["validity"][:] = 0
    for name, variable in ds.data_vars.items():
        if variable.dtype.kind == "f":
            ds[name] = variable * np.nan
    return ds


@pytest.fixture(scope="module")
def browser():
    with closing(Browser()) as running:
        yield running


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    return tmp_path_factory.mktemp("explorer")


def written(ds, folder, name):
    return write_explorer(results_of(ds), folder / f"{name}.html")


def with_known_lives(ds):
    """Leave out the lives of rollers that skid, lift off or break: they have none, in the page as in the package."""
    known = (ds["regime"] == 0) & ((ds["validity"] & 4) == 0)
    return ds.assign({name: ds[name].where(known) for name in ds.data_vars if "life" in name})


@pytest.fixture(scope="module")
def grid():
    return with_known_lives(grid_study(FACTORS))


@pytest.fixture(scope="module")
def sample():
    return with_known_lives(as_table(sampled_study(400)))


@pytest.fixture(scope="module")
def pages(place, grid, sample):
    return {"grid": written(grid, place, "grid"), "sample": written(sample, place, "sample")}


@pytest.fixture
def page(browser, pages):
    opened = browser.open(pages["grid"])
    yield opened
    assert opened.complaints == []
    assert set(opened.requests) <= {pages["grid"].as_uri()}
    opened.close()


def shown(page):
    return [
        int(page.run(f"document.querySelector('[data-count={n}]').value")) for n in ("selected", "valid", "left-out")
    ]


SELECTIONS = {
    "grid": (
        {},
        {"friction_coefficient": [0.1, 0.35]},
        {"material_pair": list(PAIRS[1:3])},
        {"regime": ["full_slip", "lift_off"]},
        {"roller_life_hours": [100, None], "motor_force": [0, 0]},
        {"guide_curve_radius": [300, None]},
        {"axial_force": [0, 30], "peak_stress_roller": [None, 400], "regime": ["rolling"]},
    ),
    "sample": (
        {"friction_coefficient": [0.1, 0.2], "axial_force": [0, 60]},
        {"material_pair": [PAIRS[0]], "roller_life_hours": [50, 5000]},
        {"motor_force": [-30, -30], "roller_profile_radius": [-8, None]},
    ),
}


def expected(results, wanted):
    """Mark the cases that a selection holds, by pandas."""
    from trackroller.parameters import REGIMES

    mask = np.ones(len(results.table), bool)
    for name, told in wanted.items():
        if name == "regime":
            mask &= np.isin(np.array(REGIMES)[results.regime.astype(int)], told)
        elif isinstance(told[0], str):
            mask &= results.table[name].isin(told).to_numpy()
        else:
            low, high = (-np.inf if told[0] is None else told[0]), (np.inf if told[1] is None else told[1])
            mask &= ((results.table[name] >= low) & (results.table[name] <= high)).to_numpy()
    return mask


def test_counts_and_rows_of_ten_selections_are_those_of_the_data_set(browser, pages, grid, sample):
    for name, ds in (("grid", grid), ("sample", sample)):
        results, page = results_of(ds), browser.open(pages[name])
        for wanted in SELECTIONS[name]:
            mask = expected(results, wanted)
            page.run(f"trackroller.select({json.dumps(wanted)})")
            assert page.run("trackroller.selected()") == np.flatnonzero(mask).tolist()
            valid = int((mask & results.valid).sum())
            assert shown(page) == [mask.sum(), valid, mask.sum() - valid]
        page.close()


QUESTIONS = (
    ({"roller_life_hours": "max", "peak_stress_guide": "min"}, {}, ()),
    (
        {"roller_life_hours": "max", "peak_stress_roller": "min"},
        {"normal_force_1": [30, None]},
        ("normal_force_1 >= 30",),
    ),
    ({"roller_life_hours": "max", "friction_coefficient": "max"}, {}, ()),
    (
        {"roller_life_hours": "max", "axial_force": "max", "friction_coefficient": "max"},
        {"peak_stress_roller": [None, 400.5]},
        ("peak_stress_roller <= 400.5",),
    ),
    (
        {"roller_life_hours": "max", "axial_force": "max"},
        {"regime": ["rolling", "lift_off"]},
        ("regime != full_slip", "regime != failed"),
    ),
)


def test_ten_pareto_sets_are_those_of_the_package(browser, pages, grid, sample):
    for name, ds in (("grid", grid), ("sample", sample)):
        page, sizes = browser.open(pages[name]), []
        for goals, limits, constraints in QUESTIONS:
            out = pareto(results_of(ds), goals, constraints)
            wanted = out["row"].values[out["optimal"].values == 1].tolist()
            assert page.run(f"trackroller.pareto({json.dumps(goals)}, {json.dumps(limits)})") == wanted
            told = [text for text in constraints if text != "regime != failed"]
            if told:
                assert page.run(f"trackroller.pareto({json.dumps(goals)}, {json.dumps(told)})") == wanted
            sizes.append(len(wanted))
        assert max(sizes) > 3 and min(sizes) > 0
        page.close()


def robust_study():
    """Return an inner/outer design of six points, in which a longer life costs friction power."""
    study = parse_study(
        {
            "name": "robust",
            "method": "inner_outer",
            "samples": 50,
            "outputs": ["forces", "friction_work", "life"],
            "factors": {
                "velocity": {"values": [30.0, 45.0, 60.0]},
                "roller_material": {"values": ["POM", "PA6"]},
                "friction_coefficient": {"uniform": [0.1, 0.3]},
            },
            "pareto": {"b10(roller_life_hours)": "max", "mean(friction_power)": "min"},
        }
    )
    ds = study.design()
    friction, speed = ds["friction_coefficient"].values, ds["velocity"].values
    pom = np.where(ds["roller_material"].values.astype(str) == "POM", 1.0, 0.4)
    ds["roller_life_hours"] = ("case", speed**2 * pom / friction, {"units": "h"})
    ds["friction_power"] = ("case", friction * speed, {"units": "W"})
    ds["regime"] = ("case", np.zeros(ds.sizes["case"], np.int8))
    return ds.assign_attrs(study=study.merged())


def test_goals_that_are_statistics_compare_design_points(browser, place):
    ds = robust_study()
    page = browser.open(written(ds, place, "robust"))
    said = page.run("document.querySelector('#explorer').textContent")
    assert "statistics over its scatter" in said and "it stands in the report" in said and page.complaints == []
    page.close()
    sens = analyse(results_of(ds))
    front = study_pareto(results_of(ds, sens))
    best = np.flatnonzero(front["optimal"].values == 1)
    assert 1 < len(best) < front.sizes["row"] == 6
    page = browser.open(write_explorer(results_of(ds, sens), place / "robust.html"))
    marks = page.run("[...document.querySelectorAll('[data-list=design] tbody tr')].map(e => e.lastChild.textContent)")
    assert marks.count("yes") == len(best) and marks.count("no") == 6 - len(best)
    found = []
    for i in np.flatnonzero(np.array(marks) == "yes"):
        page.run(f"document.querySelectorAll('[data-list=design] input')[{i}].click()")
        found.append(page.run("trackroller.selected()"))
        page.run(f"document.querySelectorAll('[data-list=design] input')[{i}].click()")
    points = [front.isel(row=i) for i in best]
    own = [
        (ds["velocity"] == p["velocity"]) & (ds["roller_material"].astype(str) == str(p["roller_material"].item()))
        for p in points
    ]
    assert sorted(found) == sorted(np.flatnonzero(rows).tolist() for rows in own) and len(found[0]) == 50
    assert page.complaints == []
    page.close()


def test_the_constraints_of_the_study_stand_among_the_limits(browser, place, grid):
    constraints = ["peak_stress_roller < 200 or axial_force == 0", "regime != full_slip"]
    told = yaml.safe_load(grid.attrs["study"]) | {"constraints": constraints}
    told["factors"] = {name: told["factors"][name] for name in grid.dims if name in told["factors"]}
    ds = grid.assign_attrs(study=yaml.safe_dump(told, sort_keys=False))
    out = pareto(results_of(ds), {"roller_life_hours": "max", "axial_force": "max"}, constraints)
    page = browser.open(written(ds, place, "constraints"))
    asked = "{roller_life_hours: 'max', axial_force: 'max'}, {constraints: ['met']}"
    wanted = out["row"].values[out["optimal"].values == 1].tolist()
    assert page.run(f"trackroller.pareto({asked})") == wanted != page.run(f"trackroller.pareto({asked[:48]})")
    assert constraints[0] in page.run("document.querySelector('#explorer').textContent")
    results = results_of(ds)
    lost = int((results.inside & ~results.valid).sum())
    assert lost and f"{lost} constraints not met" in page.run("document.querySelector('.counts').textContent")
    assert shown(page)[1] == results.valid.sum()
    page.run("trackroller.select({constraints: ['not met']})")
    met = (results.table["peak_stress_roller"] < 200) | (results.table["axial_force"] == 0)
    assert shown(page)[0] == int((~met | (results.regime == 1)).sum()) > 0
    page.close()


def head_of(page, name):
    """Return where the head of an axis can be held, and the place of the axis and its ends below it."""
    left, top, width, height = page.box(f"[data-head={name}]")
    _, above, _, whole = page.run(
        "(b => [b.left, b.top, b.width, b.height])(document.querySelector('#explorer .stack').getBoundingClientRect())"
    )
    heads = page.run("Math.max(...[...document.querySelectorAll('[data-head]')].map(e => e.offsetHeight))")
    ends = above + heads + 10, above + whole - 42
    return (left + width / 2, top + height / 2), left + 12, ends


def axes_of(page):
    return page.run("[...document.querySelectorAll('[data-head]')].map(e => e.dataset.head)")


def test_a_brush_drawn_with_the_pointer_selects_and_a_click_takes_it_back(page, grid):
    _, x, (top, bottom) = head_of(page, "roller_life_hours")
    page.drag((x, top + 12), (x, (top + bottom) / 2))
    selected, valid, rest = shown(page)
    rows = page.run("trackroller.selected()")
    lives = grid["roller_life_hours"].values.ravel()
    assert 0 < selected < lives.size and selected == len(rows) == valid + rest
    assert np.nanmin(lives[rows]) > np.nanmax(np.delete(lives, rows))  # the upper part of the axis
    assert "brush.roller_life_hours" in page.run("trackroller.fragment()")
    page.drag((x, bottom - 20), (x, bottom - 20))
    assert shown(page)[0] == lives.size
    _, x, (top, bottom) = head_of(page, "material_pair")
    page.drag((x, bottom - 0.1 * (bottom - top)), (x, bottom - 0.1 * (bottom - top)))  # the lowest of five levels
    assert shown(page)[0] == lives.size // 5


def test_heads_of_axes_move_and_flip_them_by_pointer_and_by_keyboard(browser, pages, grid):
    page = browser.open(pages["grid"])
    before = axes_of(page)
    hold, *_ = head_of(page, before[1])
    page.drag(hold, (head_of(page, before[4])[0][0] + 5, hold[1]))
    moved = [before[0], *before[2:5], before[1], *before[5:]]
    assert axes_of(page) == moved
    page.run(f"document.querySelector('[data-head={before[1]}]').focus()")
    page.key("ArrowLeft", "ArrowLeft", "ArrowLeft")
    assert axes_of(page) == before
    assert page.run("document.activeElement.dataset.head") == before[1]
    flipped = []
    lives = grid["roller_life_hours"].values.ravel()
    for turn in ("drag", "click", "Enter", "drag"):
        hold, x, (top, bottom) = head_of(page, "roller_life_hours")
        if turn == "Enter":
            page.run("document.querySelector('[data-head=roller_life_hours]').focus()")
            page.key("Enter")
        else:
            page.drag(hold, (hold[0], hold[1] + (60 if turn == "drag" else 0)))
        page.drag((x, top + 12), (x, (top + bottom) / 2))
        rows = page.run("trackroller.selected()")
        kept, other = lives[rows], np.delete(lives, rows)
        flipped.append(bool(np.nanmax(kept) < np.nanmin(other)))  # the upper part of the axis holds the short lives
        assert flipped[-1] or np.nanmin(kept) > np.nanmax(other)
        page.drag((x, bottom - 20), (x, bottom - 20))
    assert flipped == [True, False, True, False]
    page.run("document.querySelector('[data-head=roller_life_hours]').click()")
    fragment = page.run("trackroller.fragment()")
    assert page.complaints == []
    page.close()
    again = browser.open(pages["grid"], fragment)
    label = "document.querySelector('[data-head=roller_life_hours]').getAttribute('aria-label')"
    assert axes_of(again) == before and "falls upwards" in again.run(label)
    again.close()


LABELS = """(() => {
    const seen = document.querySelectorAll('#explorer .axes button, #explorer .tick:not(.hidden)');
    const boxes = [...seen].map(e => [e.textContent, e.getBoundingClientRect(), e.scrollWidth > e.clientWidth + 1]);
    const before = (p, q) => p <= q + .5;
    const apart = (a, b) => before(a.right, b.left) || before(b.right, a.left)
        || before(a.bottom, b.top) || before(b.bottom, a.top);
    const all = document.querySelector('#explorer .stack').getBoundingClientRect();
    const inside = b => before(all.left, b.left) && before(b.right, all.right) && before(b.bottom, all.bottom);
    const texts = list => list.map(([text]) => text);
    const later = (b, i) => texts(boxes.slice(i + 1).filter(([, c]) => !apart(b, c)));
    const hit = boxes.flatMap(([text, b], i) => later(b, i).map(other => [text, other]));
    const [cut, out] = [boxes.filter(b => b[2]), boxes.filter(([, b]) => !inside(b))].map(texts);
    return {cut, out, hit, texts: texts(boxes)};
})()"""


@pytest.mark.parametrize("width", [400, 1200])
def test_labels_of_axes_are_whole_and_apart_and_every_axis_can_be_reached(browser, place, pages, width):
    many = written(grid_study(TWELVE), place, "labels")
    for path in (pages["grid"], pages["sample"], many):
        page = browser.open(path, width=width)
        found = page.run(LABELS)
        assert found["hit"] == [] and found["cut"] == [] and found["out"] == []
        if path == pages["grid"]:
            assert "1.7225-quenched-tempered on 1.7225-normalised" in found["texts"]
        for name in axes_of(page):
            page.run(f"document.querySelector('[data-head={name}]').focus()")
            left, right = page.run(
                "(b => [b.left, b.right])(document.activeElement.closest('.axis').getBoundingClientRect())"
            )
            assert left >= -1 and right <= width + 1
        assert page.run("document.documentElement.scrollWidth") <= width
        if path != many and width == 1200:  # no scrolling is needed for a usual study
            assert page.run("(e => e.scrollWidth <= e.clientWidth)(document.querySelector('.lines'))")
        page.close()


def test_fields_brush_with_the_keyboard_alone(page, grid):
    page.run("[...document.querySelectorAll('summary')].find(e => e.textContent.startsWith('Brushes')).focus()")
    page.key("Enter")
    page.run("document.querySelector('#explorer .brushes input[type=number]').focus()")
    page.call("Input.insertText", text="500")
    page.key("Tab")
    lives = grid["roller_life_hours"].values.ravel()
    assert shown(page)[0] == (lives >= 500).sum() > 0
    page.run(
        "[...document.querySelectorAll('fieldset')].find(e => e.textContent.startsWith('Friction'))"
        ".querySelector('input').focus()"
    )
    page.key(" ")
    first = np.broadcast_to(np.arange(4)[:, None], (4, lives.size // 4)).ravel()
    assert shown(page)[0] == ((lives >= 500) & (first != 0)).sum()


COMPARED = (
    "[...document.querySelectorAll('.pinned tbody tr:not(.part)')].map(e => [...e.children].map(c => c.textContent))"
)


def test_any_number_of_cases_stand_side_by_side_with_the_rows_that_differ(page, grid):
    page.run("trackroller.select({axial_force: [0, 30], regime: ['rolling']})")
    page.box("#explorer .cases")
    page.run("document.querySelector('#explorer .cases').focus()")
    page.key("Enter")
    alone = page.run(COMPARED)
    page.key("ArrowDown", "Enter", "ArrowDown", "Enter", "ArrowDown", "Enter")
    one, two, three, four = page.run("trackroller.selected()")[:4]
    heads = page.run("[...document.querySelectorAll('.pinned thead th')].map(e => e.textContent)")
    numbers = zip("ABCD", (one, two, three, four), strict=True)
    assert heads == [f"{letter}: case {number} Unpin" for letter, number in numbers]
    rows = page.run(COMPARED)
    assert 0 < len(rows) < len(alone) and all(len(set(values)) > 1 for _, *values in rows)
    assert "Life of the roller" in [words for words, *_ in rows]
    said = page.run("document.querySelector('.pinned').textContent")
    counted = re.search(r"The (\d+) cases differ in (\d+) of (\d+)", said)
    assert [int(number) for number in counted.groups()] == [4, len(rows), len(alone)]
    page.run("document.querySelector('.pinned input').focus()")
    page.key(" ")
    whole = page.run(COMPARED)
    assert [words for words, *_ in whole] == [words for words, _ in alone]
    assert [row for row in whole if len(set(row[1:])) > 1] == rows
    assert "pins=" + "%2C".join(map(str, (one, two, three, four))) in page.run("trackroller.fragment()")
    commands = page.run("[...document.querySelectorAll('.pinned .command code')].map(e => e.textContent)")
    assert commands[1] == f"trackroller repeat friction-and-fit {one}"
    assert commands[0].startswith("trackroller solve --set") and "axis_distance=21.75" in commands[0]
    level = grid["roller_profile_radius"].values[np.unravel_index(one, grid["regime"].shape)[1]]
    assert f"--set roller_profile_radius={level}" in commands[0]


def test_a_life_beyond_the_data_never_stands_alone(browser, place):
    ds = with_known_lives(grid_study({"axial_force": [0.0, 10.0], "material_pair": list(PAIRS[:2])}, unlimited=True))
    ds["roller_life_hours"][0, 0] = 1e12
    ds["life_cycles"][0, 0] = 1e15
    ds["roller_life_hours"][1, 0], ds["life_cycles"][1, 0] = 1.0, 1e4
    ds["roller_life_hours"][0, 1] = ds["life_cycles"][0, 1] = np.inf
    page = browser.open(written(ds, place, "beyond"))
    for row in (0, 2, 1):
        page.run(f"trackroller.pin({row})")
    (lives,) = [cells[1:] for cells in page.run(COMPARED) if cells[0] == "Life of the roller"]
    assert lives == [f"1·10¹² h ({BEYOND})", "1 h", f"no failure ({BEYOND})"]
    column = (
        "[...document.querySelectorAll('.head > *')].findIndex(e => e.textContent.startsWith('Life of the roller'))"
    )
    cells = page.run(f"[...document.querySelectorAll('.rows .row')].map(e => e.children[{column}].textContent)")
    assert cells[0].endswith(f"({BEYOND})") and cells[2] == "1"
    page.close()


def test_pinned_cases_tell_how_far_they_are_from_lift_off(page, grid):
    regime = np.moveaxis(grid["regime"].values, grid["regime"].dims.index("axial_force"), -1)
    numbers = np.moveaxis(
        np.arange(grid["regime"].size).reshape(grid["regime"].shape), grid["regime"].dims.index("axial_force"), -1
    )
    lifts = (regime == 2).argmax(axis=-1) * (regime == 2).any(axis=-1)
    place = np.argwhere((regime[..., 0] != 2) & (lifts > 0))[0]
    row, end = int(numbers[(*place, 0)]), int(lifts[tuple(place)])
    page.run(f"trackroller.pin({row})")
    told = page.run("[...document.querySelectorAll('.pinned tbody tr')].map(e => e.textContent)")
    ends = FACTORS["axial_force"][end - 1 : end + 1]
    (lift,) = [t for t in told if t.startswith("Lift-off by axial force")]
    assert [float(number) for number in re.findall(r"[\d.]+", lift)] == ends
    least = grid["normal_force"].values.reshape(-1, 2)[row].min()
    (said,) = [t for t in told if t.startswith("Least normal force (0 at lift-off)")]
    assert float(re.search(r"\)([\d.]+) N", said)[1]) == pytest.approx(least, rel=5e-3)
    assert "--report sheet.html" in page.run("document.querySelector('.pinned').textContent")


def test_one_click_hides_what_skids_lifts_or_lies_outside_the_model(page, grid):
    results = results_of(grid)
    left, top, width, height = page.box("[data-hide]")
    click = [(left + width / 2, top + height / 2)] * 2
    page.drag(*click)
    assert page.run("trackroller.selected()") == np.flatnonzero(results.inside).tolist()
    assert shown(page) == [results.inside.sum(), results.inside.sum(), 0] and results.inside.sum() < results.inside.size
    assert page.run("document.querySelector('[data-hide]').getAttribute('aria-pressed')") == "true"
    page.drag(*click)
    assert shown(page)[0] == results.inside.size
    page.run("document.querySelector('[data-hide]').focus()")
    page.key(" ")
    assert shown(page)[0] == results.inside.sum()


def designs_of(results):
    """Return for each case its roller radius and material pair, and for each design its worst valid life, by pandas."""
    keys = ["roller_profile_radius", "material_pair"]
    lives = results.table["roller_life_hours"].where(results.valid)
    return keys, lives.groupby([results.table[k] for k in keys]).min()


def test_designs_and_conditions_are_chosen_in_their_lists(page, grid):
    results = results_of(grid)
    keys, worst = designs_of(results)
    assert "unknown" in page.run("document.querySelector('[data-list=design]').textContent")  # the hours of the guide
    cells = "[...document.querySelectorAll('[data-list=%s] tbody tr')].map(e => [...e.cells].map(c => c.textContent))"
    designs, conditions = page.run(cells % "design"), page.run(cells % "condition")
    assert len(designs) == len(worst) == 15 and len(conditions) == results.valid.size // 15
    page.run("document.querySelectorAll('[data-list=design] input')[2].focus()")
    page.key(" ")
    rows = page.run("trackroller.selected()")
    (design,) = {tuple(key) for key in results.table.loc[rows, keys].to_numpy()}
    own = (results.table[keys] == design).all(axis=1)
    assert rows == np.flatnonzero(own).tolist() and len(rows) == len(conditions)
    radius, _, life, valid = designs[2][2:]
    assert float(radius.replace("−", "-")) == design[0] and valid == f"{results.valid[own].sum()} of {len(rows)}"
    assert float(life.split(" (")[0].replace(",", "")) == pytest.approx(worst[design], rel=5e-3)
    page.run("document.querySelector('[data-list=condition] summary').click()")
    left, top, width, height = page.box("[data-list=condition] tbody tr:last-child input")
    page.drag((left + width / 2, top + height / 2), (left + width / 2, top + height / 2))
    (both,) = page.run("trackroller.selected()")
    assert both in rows
    page.drag((left + width / 2, top + height / 2), (left + width / 2, top + height / 2))
    assert page.run("trackroller.selected()") == rows
    assert page.run("trackroller.select({design: [1, 3]})") == 3 * len(conditions)
    hardest = page.run("trackroller.select({condition: [1, 1]}), trackroller.selected()")
    names = [n for n in results.factors if n not in keys]
    held = results.table.assign(valid=results.valid).groupby(names)["valid"].sum()
    assert results.valid[hardest].sum() == held.min() and len(hardest) == 15


def test_the_worst_case_of_each_design_is_an_axis(page, grid):
    results = results_of(grid)
    keys, worst = designs_of(results)
    _, x, (top, bottom) = head_of(page, "design_worst")
    page.drag((x, top - 4), (x, (top + bottom) / 2))
    rows = page.run("trackroller.selected()")
    found = {tuple(key) for key in results.table.loc[rows, keys].to_numpy()}
    assert 0 < len(found) < len(worst) and len(rows) == len(found) * results.valid.size // len(worst)
    assert min(worst[key] for key in found) > max(worst[key] for key in worst.index if key not in found)


def test_without_a_design_that_repeats_no_list_of_designs_appears(browser, pages):
    page = browser.open(pages["sample"])
    assert page.run("document.querySelector('[data-list]')") is None
    assert not {"design", "design_worst", "condition"} & set(axes_of(page))
    assert "Choices" not in page.run("[...document.querySelectorAll('h4')].map(e => e.textContent)")
    page.close()


def test_a_cloud_hides_no_colour(browser, place):
    """Of 20,000 points on nearly the same place, the rare pair and every regime stay visible."""
    ds = as_table(sampled_study(20_000))
    ds["material_pair"][:] = np.where(np.arange(20_000) % 4000 == 7, PAIRS[2], PAIRS[0])
    page = browser.open(written(ds, place, "cloud"))
    fields = "[...document.querySelectorAll('#explorer select')]"
    page.run(f"(f => {{ f.value = 'material_pair'; f.dispatchEvent(new Event('change')); }})({fields}[2])")
    seen = page.run(
        """(() => { const c = document.querySelector('#explorer .pair canvas');
        const d = new Uint32Array(c.getContext('2d').getImageData(0, 0, c.width, c.height).data.buffer);
        const n = {}; for (const v of d) n[v] = (n[v] ?? 0) + 1; return n; })()"""
    )
    shades = page.run(
        "[...document.querySelectorAll('.legend .sign.disc')].slice(0, 2).map(e => getComputedStyle(e).color)"
    )
    codes = [sum(int(v) << 8 * i for i, v in enumerate(re.findall(r"\d+", rgb))) + (255 << 24) for rgb in shades]
    points = 5  # cases of the rare pair; a point has at least 9 pixels
    assert len(set(codes)) == 2 and all(seen.get(str(code), 0) >= 5 * points for code in codes)
    page.close()


def test_table_and_commands_are_copied(browser, pages):
    stub = "Object.defineProperty(navigator, 'clipboard', {value: {writeText: async t => { window.copied = t; }}})"
    page = browser.open(pages["grid"], before=stub)
    page.run("trackroller.select({axial_force: [30, 30], friction_coefficient: [0.3, 0.3]}); trackroller.pin(9)")
    page.run("document.querySelector('.pinned .command button').click()")
    assert page.run("window.copied") == page.run("trackroller.commands(9)[0]")
    page.run("[...document.querySelectorAll('.tools button')].find(b => b.textContent === 'Copy').click()")
    lines = page.run("window.copied").splitlines()
    assert lines[0].startswith("case\tfriction_coefficient\t") and len(lines) == 1 + shown(page)[0]
    page.close()


def test_a_sorted_table_starts_with_the_largest_and_ends_with_missing_values(page, grid):
    head = "[...document.querySelectorAll('.head button')].find(b => b.textContent.startsWith('Life of the roller'))"
    page.run(f"{head}.click(); {head}.click()")
    lives = grid["roller_life_hours"].values.ravel()
    best = page.run("document.querySelector('.rows [role=rowheader]').textContent")
    assert (
        lives[int(best)] == np.nanmax(lives)
        and page.run(f"{head}.parentElement.getAttribute('aria-sort')") == "descending"
    )
    page.run("document.querySelector('.cases').focus()")
    page.key("End")
    last = page.run("[...document.querySelectorAll('.rows [role=rowheader]')].at(-1).textContent")
    assert np.isnan(lives[int(last)]) == np.isnan(lives).any()


def test_a_touched_case_is_told_in_words(page):
    page.run("document.querySelector('#explorer canvas[tabindex]').focus()")
    page.key("ArrowRight")
    told = page.run("document.querySelector('.hovered').textContent")
    assert re.match(r"Case \d+ · Friction coefficient 0\.05 · ", told)
    assert "Life of the roller" in told and "Regime: " in told and "lags" in told


def test_slices_of_a_grid_follow_the_slider(page, grid):
    before = page.run("trackroller.slice()")
    slider = "document.querySelector('label[data-factor=axial_force] input')"
    page.run(f"{slider}.value = '0'; {slider}.dispatchEvent(new Event('input'))")
    after = page.run("trackroller.slice()")
    numbers = np.arange(grid["regime"].size).reshape(grid["regime"].shape)
    # held: the middle level of every other factor
    assert before == numbers[:, 1, 2, 0, 1, 0].tolist() and after == numbers[:, 1, 2, 0, 0, 0].tolist()


def test_medians_of_a_sample_lie_within_their_band(browser, pages, sample):
    page = browser.open(pages["sample"])
    (life, *_), _ = page.run("trackroller.slice()")
    valid = sample["roller_life_hours"].values[results_of(sample).valid]
    assert len(life) > 5 and all(s["low"] <= s["median"] <= s["high"] for s in life)
    assert {s["median"] for s in life} <= set(valid.tolist())
    page.close()


def test_the_selection_is_exported_with_every_digit(page, grid, tmp_path):
    page.browser.call("Browser.setDownloadBehavior", behavior="allow", downloadPath=str(tmp_path))
    page.run("trackroller.select({roller_life_hours: [1000, null]})")
    page.run("[...document.querySelectorAll('#explorer button')].find(b => b.textContent === 'Export CSV').click()")
    target = tmp_path / "friction-and-fit-selection.csv"
    for _ in range(100):
        if target.exists():
            break
        page.run("new Promise(r => setTimeout(r, 100))")
    with target.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    lives = grid["roller_life_hours"].values.ravel()
    assert [int(row["case"]) for row in rows] == np.flatnonzero(lives >= 1000).tolist()
    assert [float(row["roller_life_hours"]) for row in rows] == lives[lives >= 1000].tolist()
    assert {row["regime"] for row in rows} <= {"rolling", "full_slip", "lift_off"}


def test_texts_that_a_spreadsheet_would_run_are_exported_inert(browser, grid, place, tmp_path):
    path = written(grid, place, "hostile")
    text = path.read_text(encoding="utf-8")
    assert "POM / POM" in text
    path.write_text(text.replace("POM / POM", "=1+1"), encoding="utf-8")
    page = browser.open(path)
    page.browser.call("Browser.setDownloadBehavior", behavior="allow", downloadPath=str(tmp_path))
    page.run("[...document.querySelectorAll('#explorer button')].find(b => b.textContent === 'Export CSV').click()")
    target = tmp_path / "friction-and-fit-selection.csv"
    page.run("new Promise(r => setTimeout(r, 1000))")
    with target.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert {"PA6 / 1.7225-normalised", "'=1+1"} <= {row["material_pair"] for row in rows}
    assert min(float(row["roller_profile_radius"]) for row in rows) < 0
    page.close()


def test_the_address_holds_the_view_and_wrong_addresses_do_no_harm(browser, pages):
    page = browser.open(pages["grid"])
    page.run(
        "trackroller.select({friction_coefficient: [0.1, 0.3], roller_life_hours: [100, null], design: [1, 4]});"
        "for (const row of [7, 3, 5]) trackroller.pin(row)"
    )
    rows, fragment = page.run("trackroller.selected()"), page.run("trackroller.fragment()")
    page.close()
    again = browser.open(pages["grid"], fragment)
    assert again.run("trackroller.selected()") == rows
    heads = again.run("[...document.querySelectorAll('.pinned thead th')].map(e => e.textContent)")
    assert [head.split()[2] for head in heads] == ["7", "3", "5"] and rows
    again.close()
    wrong = "#explore&brush.__proto__=[1]&brush.nothing=[1,2]&x=constructor&pins=a,-1,99999999&axes=7&slice=[1,[2]]"
    payload = "&colour=%3Cimg%20src%3Dx%20onerror%3Dalert(1)%3E&brush.regime={%22a%22:1}&sort=%3Cb%3E"
    page = browser.open(pages["grid"], wrong + payload)
    assert (
        shown(page)[0] == grid_size()
        and page.complaints == []
        and page.run("document.querySelectorAll('#explorer img').length") == 0
    )
    page.close()


def grid_size():
    return int(np.prod([len(levels) for levels in FACTORS.values()]))


def pressed(page, words):
    page.run(f"[...document.querySelectorAll('#explorer button')].find(b => b.textContent === {words!r}).click()")


GOALS_OF = (
    {"roller_life_hours": [100, None]},
    {"friction_coefficient": [0.05, 0.2, 0.4], "axial_force": [0, 30]},
    {"regime": ["rolling", "lift_off"], "peak_stress_roller": [None, 400.5]},
    {"guide_curve_radius": [300, None], "motor_force": [0, 0]},
)


def test_goals_compare_the_selected_cases_and_ask_the_same_in_a_study_file(page, grid):
    for wanted in GOALS_OF:
        page.run(f"trackroller.select({json.dumps(wanted)})")
        pressed(page, "Find the Pareto set")
        said = page.run("[...document.querySelectorAll('#explorer [role=status]')].map(e => e.textContent).join('|')")
        asked = page.run("[...document.querySelectorAll('#explorer .command code')].map(e => e.textContent).join('')")
        question = yaml.safe_load(asked)
        out = pareto(results_of(grid), question["pareto"], question["constraints"])
        front = out["row"].values[out["optimal"].values == 1].tolist()
        assert int(re.search(r"(\d+) cases are beaten", said)[1]) == len(front) > 0
        pressed(page, "Show the set only")
        assert page.run("trackroller.selected()") == front
        pressed(page, "Clear the selection")
        assert shown(page)[0] == grid_size()
    page.run(f"trackroller.select({{material_pair: [{PAIRS[0]!r}], axial_force: [30, 30]}})")
    asked = page.run("[...document.querySelectorAll('#explorer .command code')].map(e => e.textContent).join('')")
    assert asked.splitlines()[-1].startswith("#") and asked.endswith("Material pair")
    assert yaml.safe_load(asked)["constraints"] == ["axial_force >= 30", "axial_force <= 30"]


def test_names_of_users_stay_text(browser, place):
    evil = ["<img src=x onerror=document.title=1>", "'\"></script><script>document.title=2</script>"]
    ds = grid_study({"material_pair": list(PAIRS[:2]), "axial_force": [0.0, 30.0]}).assign_coords(material_pair=evil)
    page = browser.open(written(ds, place, "evil"))
    page.run("trackroller.pin(0)")
    text = page.run("document.querySelector('#explorer').textContent")
    assert evil[0] in text and page.run("document.images.length") == 0
    assert page.run("document.title").startswith("friction-and-fit") and page.complaints == []
    page.close()


def test_the_policy_forbids_requests_and_eval(page):
    tried = "['https://example.org/', 'data:,x'].map(u => fetch(u).then(() => 'open', () => 'closed'))"
    assert page.run(f"Promise.all({tried})") == ["closed", "closed"]
    assert page.run(
        "new Promise(r => { const s = document.createElement('script'); s.textContent = 'window.bad = 1';"
        " document.body.append(s); setTimeout(() => r(window.bad === undefined), 50); })"
    )
    page.browser.events.clear()  # the complaints of this test are wanted


def test_rows_are_read_without_the_browsers_own_inflate(browser, pages):
    page = browser.open(pages["grid"], before="delete window.DecompressionStream; delete Uint8Array.fromBase64")
    assert page.run("document.querySelector('#explorer').dataset.ready") == "yes" and shown(page)[0] == grid_size()
    page.close()


STUDIES = {
    "one": lambda: grid_study({"axial_force": [0.0, 30.0]}).isel(axial_force=[1]),
    "two": lambda: grid_study({"axial_force": [0.0, 30.0]}),
    "single": lambda: grid_study({"friction_coefficient": np.linspace(0.02, 0.4, 20).tolist()}),
    "twelve": lambda: grid_study(TWELVE),
    "failed": lambda: failed(grid_study({"axial_force": [0.0, 30.0], "radial_force": [-200.0, -100.0]})),
}


@pytest.mark.parametrize("name", STUDIES)
def test_studies_of_every_form_open_without_a_complaint(browser, place, name):
    ds = STUDIES[name]()
    page = browser.open(written(ds, place, name))
    results = results_of(ds)
    assert shown(page) == [len(results.table), results.valid.sum(), len(results.table) - results.valid.sum()]
    page.run("trackroller.pin(0); trackroller.select({regime: ['rolling', 'failed']})")
    assert shown(page)[0] == np.isin(results.regime, [0, 3]).sum()
    if name == "failed":
        assert "failed" in page.run("document.querySelector('.counts').textContent")
    assert page.complaints == []
    page.close()


def processor_seconds(page):
    """Return the processor time that the page took since `Performance.enable`."""
    told = page.call("Performance.getMetrics")["metrics"]
    return next(metric["value"] for metric in told if metric["name"] == "TaskDuration")


def test_a_selection_among_a_hundred_thousand_cases_holds_the_cases_that_are_shown(browser, place):
    ds = sampled_study(100_000)
    path = written(ds, place, "large")
    page = browser.open(path)
    rows = np.array(page.run("trackroller.selected()"))
    page.call("Performance.enable", timeDomain="threadTicks")
    page.run("delete document.querySelector('#explorer').dataset.ready")  # so that `go` waits for the page opened anew
    page.go(path.as_uri())
    assert processor_seconds(page) < 3 and path.stat().st_size < 6e6
    mask = (ds["friction_coefficient"] <= 0.2).values[rows]
    page.run("trackroller.select({friction_coefficient: [0.02, 0.2]})")
    assert shown(page)[0] == mask.sum() and 40_000 < len(rows) <= 50_000
    assert page.run("trackroller.selected()") == rows[mask].tolist()
    assert page.run("document.querySelectorAll('.cases .row').length") < 60 and page.complaints == []
    page.close()


@pytest.mark.long
def test_a_larger_study_shows_a_stated_sample_with_its_own_pareto_set(browser, place):
    """Of 60,000 cases at most 50,000 are shown: rare states, and the sets that `pareto` finds for its goals."""
    ds = as_table(sampled_study(60_000))
    goals = {"roller_life_hours": "max", "peak_stress_roller": "min"}
    told = yaml.safe_load(ds.attrs["study"]) | {"pareto": goals}
    ds = ds.assign_attrs(study=yaml.safe_dump(told))
    page = browser.open(written(ds, place, "sampled"))
    said = page.run("document.querySelector('#explore p').textContent")
    results, rows = results_of(ds), page.run("trackroller.selected()")
    assert said.startswith(f"{len(rows):,} of 60,000 cases")
    assert 49_900 < len(rows) <= 50_000 and len(rows) == shown(page)[0] == len(set(rows)) and max(rows) < 60_000
    assert shown(page)[1] == results.valid[rows].sum()
    for regime in np.unique(results.regime):
        share = (results.regime == regime).mean()
        assert (results.regime[rows] == regime).mean() == pytest.approx(share, rel=0.02)
    out = pareto(results_of(ds), goals)
    wanted = out["row"].values[out["optimal"].values == 1].tolist()
    assert page.run(f"trackroller.pareto({json.dumps(goals)})") == wanted
    assert page.complaints == []
    page.close()


SVG = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 400 300"><rect width="400" height="300"/></svg>'


@pytest.mark.skipif(not AXE.is_file(), reason="needs axe-core: run `npm ci` in web/")
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_axe_finds_nothing_serious(browser, pages, scheme):
    page = browser.open(pages["grid"])
    page.media(prefers_color_scheme=scheme)
    page.run("trackroller.pin(0); trackroller.pin(5); document.querySelectorAll('details').forEach(d => d.open = true)")
    page.run(AXE.read_text(encoding="utf-8") + "; 0")
    found = page.run(
        "axe.run(document, {resultTypes: ['violations']})"
        ".then(r => r.violations.map(v => [v.impact, v.id, v.nodes.slice(0, 3).map(n => n.html)]))"
    )
    assert [v for v in found if v[0] in ("serious", "critical")] == []
    page.close()


def test_paper_shows_the_static_report_only(browser, pages):
    page = browser.open(pages["grid"])
    page.media("print")
    assert page.run("getComputedStyle(document.querySelector('#explore')).display") == "none"
    page.close()
