"""A search finds the designs that a grid of all designs holds, and goes on where it was stopped."""

import itertools

import numpy as np
import pytest

import trackroller as tr
from trackroller.cli.study import print_best
from trackroller.errors import InputError
from trackroller.methods.optimise import (
    Gene,
    first_generation,
    next_generation,
    nondominated_ranks,
)
from trackroller.results.pareto import pareto_mask
from trackroller.results.search import cheaper, search_candidates
from trackroller.results.search_fitness import optimum_of, shortfall
from trackroller.study.file.load import load_study
from validation.benchmarks.optimum import hypervolume

STUDY = {
    "name": "search",
    "base": {"motor_force": -5, "guide_curve_radius": "inf", "guide_overrollings_per_hour": 600},
    "factors": {
        "roller_profile_radius": {"values": [-6.4, -6.6, -7, -7.5, -8, -9]},
        "contact_angle": {"values": [25, 30, 35, 40]},
        "friction_coefficient": {"values": [0.1, 0.2]},
    },
    "method": "optimise",
    "goals": {"pair_life_hours": "max", "mean(friction_power)": "min"},
    "budget": {"designs": 16, "population": 4},
    "outputs": ["forces", "contact", "friction_work", "peak_stress", "life"],
    "contact_model": "sliding",
    "accuracy": "preview",
}


def changed(**keys):
    return load_study({**STUDY, **keys})


def mixed(genes):
    """A front f2 = 1 - sqrt(f1) whose quarters belong to four categories; an integer is best at 7."""
    x, y, whole, kind = genes.T
    far = 1 + 4 * (y - 0.3) ** 2 + 3 * ((whole - 7) / 9) ** 2
    first = 0.25 * (kind + x)
    return np.stack([first, far * (1 - np.sqrt(first / far))], axis=1)


def evolve(seed, designs, population=24):
    kinds = [Gene(), Gene(), Gene(10), Gene(4, ordered=False)]
    genes = first_generation(kinds, population, seed)
    number = 1
    while len(genes) < designs:
        costs = mixed(genes)
        children = next_generation(kinds, genes, costs, np.zeros(len(genes)), population, (seed, number))
        genes, number = np.concatenate([genes, children]), number + 1
    return genes


def test_a_search_covers_a_known_front_of_real_integer_and_categorical_factors():
    x = np.linspace(0, 1, 2001)
    whole = hypervolume(np.stack([x, 1 - np.sqrt(x)], axis=1), [1.1, 1.1])
    shares = [hypervolume(mixed(evolve(seed, 480)), [1.1, 1.1]) / whole for seed in range(3)]
    drawn = np.random.default_rng(1).random((480, 4)) * [1, 1, 10, 4]
    drawn[:, 2:] = np.floor(drawn[:, 2:])
    assert min(shares) > 0.98 > hypervolume(mixed(drawn), [1.1, 1.1]) / whole + 0.05


def test_a_search_draws_no_design_twice_and_ends_when_all_are_drawn():
    kinds = [Gene(3), Gene(4, ordered=False)]
    genes = first_generation(kinds, 4, 1)
    for number in range(1, 30):
        costs = genes @ [[1.0], [0.3]]
        children = next_generation(kinds, genes, costs, np.zeros(len(genes)), 4, (1, number))
        if not len(children):
            break
        genes = np.concatenate([genes, children])
    assert sorted(map(tuple, genes)) == sorted(itertools.product(range(3), range(4)))


def test_generations_follow_from_the_seed_alone():
    assert np.array_equal(evolve(3, 96), evolve(3, 96)) and not np.array_equal(evolve(3, 96), evolve(4, 96))


def test_ranks_agree_with_the_pareto_set_peeled_front_by_front():
    costs = np.random.default_rng(2).integers(0, 8, (80, 3)).astype(float)
    ranks, left = nondominated_ranks(costs, np.zeros(80)), np.arange(80)
    for front in range(ranks.max() + 1):
        best = pareto_mask(costs[left], ["min"] * 3)
        assert set(left[best]) == set(np.flatnonzero(ranks == front))
        left = left[~best]
    assert nondominated_ranks(np.array([[0.0], [1.0]]), np.array([0.5, 0.0])).tolist() == [1, 0]


@pytest.mark.slow
def test_the_hypervolume_of_an_eighth_of_a_sphere():
    angles = np.linspace(0, np.pi / 2, 60)
    a, b = (grid.ravel() for grid in np.meshgrid(angles, angles))
    shell = np.stack([np.cos(a) * np.cos(b), np.cos(a) * np.sin(b), np.sin(a)], axis=1)
    assert hypervolume(shell, [1, 1, 1]) == pytest.approx(1 - np.pi / 6, rel=0.03)


@pytest.mark.long
def test_a_search_finds_the_front_of_all_designs(tmp_path):
    plan = search_candidates(changed(budget={"designs": 24, "population": 8}), tmp_path)
    solved = tr.open_study(plan.folder.root)
    grid = {**STUDY, "method": "grid", "name": "grid"}
    data = tr.run({k: v for k, v in grid.items() if k not in ("goals", "budget")}, progress=False).data
    life = data["pair_life_hours"].min("friction_coefficient").values.ravel()
    power = data["friction_power"].sum("contact").mean("friction_coefficient").values.ravel()
    wanted = pareto_mask(np.stack([life, power], axis=1), ["max", "min"])
    front = solved.pareto()
    found = front["pair_life_hours"].values[front["optimal"].values == 1]
    np.testing.assert_allclose(np.sort(found), np.sort(life[wanted]))
    with pytest.raises(InputError, match="a search prefers good designs"):
        solved.indices()


@pytest.mark.long
def test_a_search_goes_on_where_it_was_stopped(tmp_path):
    whole = tr.open_study(search_candidates(changed(), tmp_path / "whole").folder.root)
    calls = []

    def stops(cases, **how):
        calls.append(len(cases["case"]))
        if len(calls) % 4 == 0:
            raise KeyboardInterrupt
        return tr.solve(cases, **how)

    for _ in range(40):
        try:
            plan = search_candidates(changed(), tmp_path / "parts", solver=stops)
            break
        except KeyboardInterrupt:
            continue
    parts = tr.open_study(plan.folder.root)
    assert len(calls) > 8 and parts.data.drop_attrs().identical(whole.data.drop_attrs())
    assert optimum_of(parts) == optimum_of(whole)


@pytest.mark.long
def test_hours_add_up_over_runs(tmp_path):
    told = []
    tight = changed(budget={"designs": 12, "population": 4, "hours": 1e-9})
    search_candidates(tight, tmp_path, tell=told.append)
    assert [line for line in told if line.startswith("generation")][-1].startswith("generation 1:")
    search_candidates(tight, tmp_path, tell=told.append)
    assert sum(line.startswith("generation") for line in told) == 2


def test_the_table_prunes_and_elements_decide():
    assert cheaper(changed(contact_model="kalker")).config.contact_model == "kalker_table"
    assert cheaper(changed()).config.contact_model == "sliding"
    halfspace = changed(contact_model="kalker", normal="halfspace")
    assert cheaper(halfspace) is halfspace


@pytest.mark.slow
def test_best_names_the_designs_of_a_grid_too(tmp_path, capsys):
    grid = {k: v for k, v in STUDY.items() if k not in ("goals", "budget")} | {"method": "grid", "name": "grid"}
    best = tr.run(grid, progress=False, results=tmp_path).best(1)
    print_best("grid", tmp_path, tmp_path / "best.html")
    assert f"contact angle {best['contact_angle'].iloc[0]:g}°" in capsys.readouterr().out
    assert (tmp_path / "best.html").is_file()


@pytest.mark.long
@pytest.mark.parametrize(("goal", "way"), [("pair_life_hours", "max"), ("roller_profile_radius", "max")])
def test_a_search_with_one_goal_has_a_report(goal, way, tmp_path):
    solved = tr.run(changed(goals={goal: way}, budget={"designs": 8, "population": 4}), progress=False)
    assert solved.answer.question == "best"
    assert solved.report(tmp_path / "report.html").stat().st_size > 0
    assert solved.explore(tmp_path / "explorer.html").stat().st_size > 0


@pytest.mark.parametrize(
    ("keys", "says"),
    [
        ({"budget": {"desings": 8}}, "Did you mean 'designs'"),
        ({"budget": {"designs": 0}}, "budget.designs = 0"),
        ({"budget": {"hours": 0}}, "budget.hours = 0"),
        ({"goals": {"pair_life_hour": "max"}}, "Did you mean 'pair_life_hours'"),
        ({"goals": {"b10(max_pressure)": "min"}}, "b10 of a life"),
        ({"goals": {"median(pair_life_hours)": "max"}}, "mean, worst, b10 or probability of one. For example mean"),
        ({"goals": {"probability(pair_life_hours)": "max"}}, "the probability of a requirement or of a regime"),
        ({"goals": {"pair_life_hours": "up"}}, "Allowed: max, min"),
        ({"goals": {"pair_life_hours": "max", "worst(pair_life_hours)": "min"}}, "each result once"),
        ({"pareto": {"pair_life_hours": "max", "max_pressure": "min"}}, "Rename the key to goals"),
        ({"method": "grid"}, "method: optimise"),
        ({"contact_model": ["kalker", "sliding"]}, "one model"),
        (
            {"factors": {"contact_angle": {"values": [30]}, "motor_force": {"values": [0, -5]}}, "base": {}},
            "one choice",
        ),
        ({"factors": {"contact_angle": {"normal": [30, 1]}}}, "Write samples"),
    ],
)
def test_a_wrong_search_is_refused(keys, says):
    with pytest.raises(InputError, match=says.replace("(", r"\(")):
        changed(**keys).design()


@pytest.mark.slow
def test_a_target_on_a_force_decides_a_search_without_lives_and_stresses():
    """The goal asks for little force in contact 1, the target for enough of it in both conditions."""
    base = {"guide_curve_radius": "inf", "axial_force": 30, "motor_force": 0, "radial_force": -80}
    keys = {"base": base, "outputs": ["forces", "contact"], "goals": {"normal_force_1": "min"}}
    forces = {}
    for least in (None, 8.0):
        more = {} if least is None else {"analysis": {"target": {"normal_force_1": {"min": least}}}}
        results = tr.run(changed(**keys, **more), progress=False)
        rows = results.table.assign(force=np.where(results.regime == 0, results.quantity("normal_force_1")[0], -np.inf))
        worst = rows["force"].to_numpy(dtype=float).reshape(-1, 2).min(axis=1)
        if least is not None:
            assert ((shortfall(results) == 0) == (worst >= least)).all() and 0 < (worst >= least).sum() < len(worst)
        forces[least] = worst[optimum_of(results)["recommended"]]
    assert forces[None] < 8.0 <= forces[8.0]


def test_of_equal_goals_the_longer_life_is_recommended():
    from trackroller.results.search_fitness import Judged, recommended

    nothing = np.zeros(3)
    lives = np.array([1790.0, 18600.0, 4000.0])
    tied = Judged(
        np.zeros((3, 1)), np.full((3, 1), 9.0), np.full((3, 1), 9.0), nothing, nothing, lives, nothing, np.zeros((3, 0))
    )
    assert recommended(tied) == 1
