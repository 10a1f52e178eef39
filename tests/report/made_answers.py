"""Made answers: a record for each question and kind, with values that are difficult to show."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pandas as pd

from trackroller.results.answer import Answer, Caution, Column, Curve, Required

LIFE = ("pair_life_to_first_limit_hours", "Life to the first limit", "h")
STRESS = ("peak_stress_roller", "Peak stress of the roller", "MPa")
GROOVE = Column("roller_profile_radius", "Groove", "mm", "Radius of the groove of the roller", "level", role="name")
AXIS = Column("axis_distance", "Axis distance", "mm", "From axis to axis", "level", role="name")
STEEL = Column("roller_material", "Roller material", "", "Material of the roller", "level", role="name")
VERDICT = Column("state", "Verdict", "", "Low end over (1 + error) reaches the requirement: met", "state")
LOW = Column("low", "worst", "h", "smallest life over the conditions, low to high", "number", until="high", role="bar")
MEDIAN = Column("median", "Median", "h", "Median life over the held conditions", "number", role="bar")
BEST = Column("best", "Best", "h", "Largest life over the conditions", "number", role="bar")
WORST = Column("worst", "Worst condition", "", "Levels of the worst condition", "text")
ENDS = Column("ends", "Ends by", "", "Limit that ends the worst condition", "text")
HOLDS = Column("holds", "Holds", "", "Conditions that the candidate holds", "count")
MEETS = Column("meets", "Meets", "", "Conditions whose life over (1 + error) reaches the requirement", "count")
RATIO = Column(
    "ratio", "To leader", "", "Life over that of the leader in the same condition", "ratio", until="ratio_high"
)
RATING = Column("rating", "By rating", "h", "Standard rating in its worst condition", "number", until="rating_high")
RATED = Column("rated", "Rating", "", "Requirement by the rating", "state")
ERROR = Column("error", "Error", "", "Told 95 % error of the life", "error")
DECIDE = (VERDICT, GROOVE, AXIS, LOW, MEDIAN, BEST, WORST, ENDS, HOLDS, MEETS, RATIO, RATING, RATED, ERROR)
FACTS = {
    "name": "grooves",
    "description": "Which groove and axis distance last five years of two shifts at every load and speed?",
    "date": "2026-11-29",
    "cases": 288,
    "candidates": 12,
    "conditions": [12, 12],
    "models": "kalker",
    "accuracy": "preview",
}
NOT_CHECKED = {"roller": ("bearing", "catalogue", "heat", "wear"), "guide": ("wear",)}
WARNINGS = (
    Caution("extrapolated", 288, 288, "life beyond the S-N data (5,000,000 cycles): all candidates"),
    Caution("second_model", 5, 12, "by rating open: 6.3 / 26 mm, 6.2 / 21.75 mm; missed: 6.3 / 21.75 mm", "candidates"),
    Caution(
        "at_end", 1, 1, "groove 6.2 mm: smallest of 6.2 to 7; axis distance 26 mm: largest of 18 to 26", "candidates"
    ),
    Caution("not_given", 288, 288, "guide profile radius 6 mm, contact angle 30° (values of the example)"),
)


def required(least: float = 20_000.0, **more: Any) -> Required:
    return Required(LIFE[0], LIFE[1], "h", least, **more)


def curve(name: str, title: str, units: str, levels: tuple[Any, ...], middle: list[float], **more: Any) -> Curve:
    values = np.asarray(middle, dtype=float)
    known = values[np.isfinite(values) & (values > 0)]
    settings = {"role": "choice", "logarithmic": False, "ordered": not isinstance(levels[0], str), "shape": "fall"}
    height = float(known.max() / known.min()) if known.size else math.nan
    return Curve(
        name, title, units, **{**settings, **more}, levels=levels, middle=values, low=values / 7, high=values * 6,
        height=height, rows=288,
    )  # fmt: skip


CURVES = (
    curve("roller_profile_radius", "Groove", "mm", (6.2, 6.3, 6.5, 7.0), [299_000, 121_000, 36_800, 7_050]),
    curve("radial_force", "Radial force", "N", (60.0, 100.0, 150.0), [194_000, 56_500, 19_700], role="condition"),
    curve("roller_material", "Material", "", ("1.7225-normalised", "POM", "a very long material"), [5e4, 3e3, 2e5]),
    curve("velocity", "Velocity", "m/min", (60.0, 120.0), [70_900, 35_400], role="condition", left_out=14),
)
COUNTS = pd.DataFrame(
    {
        "factor": ["all", *["radial force"] * 3, *["velocity"] * 2],
        "level": ["", "60 N", "100 N", "150 N", "60 m/min", "120 m/min"],
        "fatigue of the roller": [246, 96, 90, 60, 130, 116],
        "wear of the guide": [26, 0, 6, 20, 10, 16],
        "skids": [16, 0, 0, 16, 4, 12],
    }
)


def decide_table(rows: int, span: float = 400.0) -> pd.DataFrame:
    """Return candidates whose lives fall over a span."""
    fall = np.geomspace(212_000, 212_000 / span, rows)
    verdicts = np.where(fall > 50_000, "met", np.where(fall > 15_000, "open", "missed"))
    return pd.DataFrame(
        {
            "state": verdicts,
            "roller_profile_radius": np.round(np.linspace(6.2, 7.0, rows), 3),
            "axis_distance": np.resize([26.0, 21.75, 18.0], rows),
            "low": fall,
            "high": fall * np.resize([1.0, 1.0, 3.0], rows),
            "median": fall * 4.3,
            "best": fall * 20,
            "worst": "radial force 150 N, velocity 120 m/min",
            "ends": "fatigue of the roller",
            "holds": 12,
            "meets": np.resize([12, 12, 10, 6], rows),
            "ratio": fall / fall[0] * 0.9,
            "ratio_high": fall / fall[0],
            "rating": fall / 7,
            "rating_high": fall / 2.7,
            "rated": np.where(fall > 150_000, "met", "missed"),
            "error": np.resize([0.48, 0.35, 0.05], rows),
        }
    )


def decide(kind: str = "build", rows: int = 12, **changes: Any) -> Answer:
    head = {
        "names": [{"roller_profile_radius": 6.2, "axis_distance": 26.0}],
        "low": 212_000.0,
        "high": 212_000.0,
        "ends": "fatigue",
        "body": "roller",
        "error": 0.48,
        "extrapolated": True,
    }
    settings: dict[str, Any] = {
        "output": LIFE,
        "table": decide_table(rows),
        "columns": DECIDE,
        "required": (required(),),
        "curves": CURVES,
        "ends": COUNTS,
        "not_checked": NOT_CHECKED,
        "warnings": WARNINGS,
        "facts": FACTS | {"candidates": rows},
    }
    head |= changes.pop("headline", {})
    return Answer("decide", kind, head, **{**settings, **changes})


def long_names() -> Answer:
    """Return candidates with many choices, long levels, ranges over decades, and lives without an end."""
    choices = {
        "roller_material": Column("roller_material", "Roller material", "", "", "level", role="name"),
        "guide_material": Column("guide_material", "Guide material", "", "", "level", role="name"),
        "roller_profile_radius": GROOVE,
        "motor_force": Column("motor_force", "Drive", "N", "Motor force", "level", role="name"),
    }
    table = decide_table(5, 1e9)
    table["roller_material"] = ["1.7225-quenched-tempered", "POM", "PA6", "EN AW-7075-T6-hard-anodised", "steel"]
    table["guide_material"] = "1.7225-normalised and ground on both sides"
    table["motor_force"] = [-30.0, 0.0, 30.0, -120.0, 0.0]
    table.loc[0, ["low", "high", "median", "best"]] = [math.inf, math.inf, math.inf, math.inf]
    table.loc[1, ["low", "high"]] = [0.0, math.inf]
    table.loc[2, ["low", "high", "median", "best"]] = [6.0, 730_000.0, math.nan, math.nan]
    table.loc[4, ["low", "high", "median", "best"]] = [0.0, 0.0, 0.0, 0.0]
    table["worst"] = [f"radial force {force} N, friction coefficient 0.3, driven −30 N" for force in range(5)]
    names = [{name: table[name].iloc[0] for name in choices}]
    lost = {"count": 20, "of": 54, "where": "all 12 driven at friction 0.05"}
    exceeded = {"limit": "the catalogue load", "body": "roller", "use": 2.62, "hours": 3.0}
    second = {"limit": "rating", "verdict": "missed"}
    head = {"names": names, "low": math.inf, "high": math.inf, "not_held": lost, "elsewhere": True}
    head |= {"exceeded": exceeded, "second": second, "ends": "wear", "ends_high": "fatigue", "error": math.nan}
    columns = (VERDICT, *choices.values(), LOW, MEDIAN, BEST, WORST, ENDS, HOLDS, MEETS, RATIO, RATING, RATED, ERROR)
    return decide(rows=5, table=table, columns=columns, headline=head)


def years() -> Answer:
    """Return a requirement in years on a duty."""
    duty = {"hours_per_day": 16.0, "days_per_year": 250.0}
    return decide(required=(required(20_000.0, years=5.0),), facts=FACTS | {"duty": duty})


def stresses() -> Answer:
    """Return a decision on a stress that must not exceed a value, with one row."""
    table = pd.DataFrame({"state": ["open"], "low": [419.96], "high": [419.96], "error": [0.002], "holds": [11]})
    low = Column("low", "Worst", "MPa", "Largest stress", "number", until="high", role="bar")
    bound = Required(STRESS[0], STRESS[1], "MPa", most=420.0)
    head: dict[str, Any] = {"names": [], "low": 419.96, "high": 419.96, "ends": "", "body": ""}
    head |= {"error": 0.002, "extrapolated": False}
    facts = FACTS | {"candidates": 1, "conditions": [1, 1]}
    return decide(
        output=STRESS, table=table, columns=(VERDICT, low, HOLDS, ERROR), required=(bound,), headline=head, facts=facts
    )


SHARE = Column("share", "Share", "", "Share of the drawn conditions that reach the requirement", "share", role="bar")
WILSON = Column("share_low", "95 %", "", "Wilson's interval", "share", until="share_high", role="bar")


def shares() -> Answer:
    """Return candidates with drawn conditions, judged by shares."""
    table = pd.DataFrame(
        {
            "roller_profile_radius": [6.2, 6.6, 8.0],
            "share": [1.0, 0.76, 0.0],
            "share_low": [0.97, 0.71, 0.0],
            "share_high": [1.0, 0.81, 0.03],
            "n": [128, 256, 128],
            "tenth": [113_000.0, 11_800.0, 770.0],
        }
    )
    drawn = Column("n", "n", "", "Conditions drawn", "count")
    tenth = Column("tenth", "Tenth part", "h", "Life that nine of ten conditions reach", "number")
    rng = np.random.default_rng(1)
    values = [rng.lognormal(mean, 0.6, 128) for mean in (12.4, 9.9, 7.1)]
    head = {"names": [{"roller_profile_radius": 6.2}], "share": 1.0, "share_low": 0.97, "share_high": 1.0, "n": 128}
    return decide(
        table=table,
        columns=(GROOVE, SHARE, WILSON, drawn, tenth),
        required=(required(15_000.0, probability=0.95),),
        headline=head | {"wanted": 0.95},
        picture={"values": values},
        facts=FACTS | {"candidates": 3, "conditions": [128, 256], "drawn": True},
    )


def how_sure(listed: bool = False) -> Answer:
    rng = np.random.default_rng(2)
    life = rng.lognormal(9.0, 0.8, 200)
    life[:3] = 0.0
    head: dict[str, Any] = {"share": 0.82, "share_low": 0.78, "share_high": 0.85, "wanted": 0.95, "n": 500}
    if listed:
        head = {"meets": 14, "of": 20, "low": 312.0, "high": 312.0, "ends": "wear", "body": "guide", "error": 0.04}
    one = decide(rows=1)
    return Answer(
        "how sure", "shares" if not listed else "loads", head, LIFE, one.table, DECIDE, required=(required(5_000.0),),
        curves=CURVES, picture={"values": [life]}, not_checked=NOT_CHECKED,
        warnings=WARNINGS[:2], facts=FACTS | {"candidates": 1},
    )  # fmt: skip


def what_matters(indices: bool = True) -> Answer:
    factors = [
        {"title": "Roller steel", "units": "", "index": 0.8, "index_low": 0.49, "index_high": 1.04, "height": 99.0,
         "from": "normalised", "to": "quenched-tempered", "at_from": 206.0, "at_to": 20_500.0},
        {"title": "Groove", "units": "mm", "index": 0.24, "index_low": 0.11, "index_high": 0.41, "height": 96.0,
         "from": 6.2, "to": 7.5, "at_from": 22_900.0, "at_to": 237.0},
    ]  # fmt: skip
    if not indices:
        factors = [{**one, "index": math.nan} for one in factors]
    table = pd.DataFrame(
        {
            "factor": ["Roller steel", "Groove", "Radial force", "Friction"],
            "role": ["choice", "choice", "condition", "condition"],
            "index": [0.8, 0.24, 0.18, 0.009],
            "index_low": [0.49, 0.11, 0.12, 0.0],
            "index_high": [1.0, 0.41, 0.25, 0.02],
            "height": [99.0, 96.0, 37.0, 1.9],
            "shape": ["groups", "fall", "fall", "hump"],
            "at_smallest": [206.0, 22_900.0, 16_400.0, 2_200.0],
            "at_largest": [20_500.0, 237.0, 447.0, 1_290.0],
            "lost": 0,
        }
    )
    columns = (
        Column("factor", "Factor", "", "Factor of the study", "text", role="name"),
        Column("role", "Role", "", "Choice: the design may change it. Condition: it may not", "text"),
        Column("index", "Index", "", "Total index, cut to 0 to 100 %", "share", role="bar"),
        Column("index_low", "95 %", "", "Interval of the total index", "share", until="index_high", role="bar"),
        Column("height", "Height", "", "Largest over smallest life of the effect curve", "ratio"),
        Column("at_smallest", "At smallest", "h", "Life of the curve at the smallest level", "number"),
        Column("at_largest", "At largest", "h", "Life of the curve at the largest level", "number"),
        Column("shape", "Shape", "", "Rise, fall, hump, cliff or groups of the curve", "text"),
        Column("lost", "Rows lost", "", "Rows that skid or lift off", "count"),
    )
    pairs = np.array([[0, 0.07, 0.01, 0], [0.07, 0, 0.03, 0], [0.01, 0.03, 0, 0], [0, 0, 0, 0]])
    titles = ["roller steel", "groove", "radial force", "friction"]
    return Answer(
        "what matters", "indices", {"factors": factors}, LIFE, table, columns, curves=CURVES,
        picture={"pairs": pairs, "titles": titles}, ends=COUNTS, not_checked=NOT_CHECKED, warnings=WARNINGS[3:],
        facts=FACTS | {"description": "What decides the life?", "candidates": 0},
    )  # fmt: skip


def best(kind: str = "front") -> Answer:
    x = np.append(np.linspace(14, 25, 60), 18.9)
    life = 2_550 * (x / 14) ** 7.5 * np.append(np.resize([1.0, 0.6], 60), 1.0)
    names = ("Smallest", "Knee", "Longest life")
    designs = [
        {
            "name": {"axis_distance": distance},
            "at": "knee" if name == "Knee" else "corner",
            "goals": [
                {"words": "Axis distance", "units": "mm", "value": distance},
                {"words": "life", "units": "h", "value": life},
            ],
            "required": [],
            "stopped": name == "Longest life",
        }
        for name, distance, life in zip(names, (14.0, 18.9, 25.0), (2_550.0, 27_900.0, 201_000.0), strict=True)
    ]
    table = pd.DataFrame(
        {
            "design": names,
            "axis_distance": [14.0, 18.9, 25.0],
            "reference": [2_550.0, 27_900.0, 201_000.0],
            "search": [3_150.0, 31_200.0, 204_000.0],
            "binds": ["axis distance: end of its range", "both goals", "nothing yet"],
            "corner": ["solved", "", "stopped before"],
            "ratio": 1.05,
        }
    )
    columns = (
        Column("design", "Design", "", "Corner or knee", "text", role="name"),
        Column("axis_distance", "Axis distance", "mm", "Goal: smallest", "number"),
        Column("reference", "At reference", "h", "Life in the worst condition at reference accuracy", "number"),
        Column("search", "In the search", "h", "Life in the worst condition in the search", "number"),
        Column("binds", "Binds", "", "Requirement, limit or end of a range that holds the design", "text"),
        Column("corner", "Corner", "", "Solved: no design lies beyond", "text"),
        Column("ratio", "Profile ratio", "", "Groove over guide", "level"),
    )
    picture: dict[str, Any] = {
        "goals": np.column_stack([life, x]), "front": np.append(np.resize([True, False], 60), True),
        "named": np.array([0, 60, 58]), "words": ["life to the first limit", "axis distance"], "units": ["h", "mm"],
    }  # fmt: skip
    if kind != "front":
        picture = {**picture, "goals": life[:, None], "words": ["life to the first limit"], "units": ["h"]}
        picture |= {"named": np.array([60]), "history": np.maximum.accumulate(np.geomspace(100, 3e4, 61))}
    head: dict[str, Any] = {
        "designs": designs if kind == "front" else designs[1:2],
        "binds": "axis distance: end of its range",
    }
    if kind == "one":
        head["accuracy"] = "reference"
    if kind in ("none", "open", "solve_finer"):
        near = {"name": {"axis_distance": 18.9}, "holds": 12, "meets": 9, "of": 12, "low": 850.0}
        head = {"designs": [], "nearest": near}
    if kind == "open":
        head["measure"] = WEAR
    return Answer(
        "best", kind, head, LIFE, table if kind == "front" else table[1:2], columns, picture=picture,
        required=() if kind == "front" else (required(),), curves=CURVES[:2], not_checked=NOT_CHECKED,
        warnings=WARNINGS[2:], facts=FACTS | {"candidates": 32, "accuracy": "preview, three at reference"},
    )  # fmt: skip


def which_model(changes: str = "verdict") -> Answer:
    models = [
        ("kalker", "missed", 432.4, 0.015),
        ("kalker_table", "open", 431.6, 0.072),
        ("sliding", "met", 419.3, 0.002),
    ]
    head = {
        "changes": changes,
        "models": [
            {"model": m, "verdict": v, "low": x, "high": x, "error": e, "leader": {"roller_profile_radius": 6.3}}
            for m, v, x, e in models
        ],
        "smallest": 0.97,
        "largest": 1.017,
        "base": "kalker",
    }
    table = pd.DataFrame(models, columns=["model", "state", "worst", "error"])
    table["low"] = table["worst"] / (1 + table["error"])
    table["high"] = table["worst"] * (1 + table["error"])
    table["roller_profile_radius"] = 6.3
    table["ratio"] = [1.0, 0.997, 0.97]
    table["ratio_high"] = [1.0, 1.0, 1.017]
    columns = (
        Column("model", "Model", "", "Contact model", "text", role="name"),
        VERDICT,
        Column("roller_profile_radius", "Groove", "mm", "Groove of the leader", "level"),
        Column("low", "Worst with its error", "MPa", "Peak stress of the leader", "number", until="high", role="bar"),
        Column("worst", "Worst", "MPa", "Peak stress of the leader in its worst condition", "number"),
        ERROR,
        Column("ratio", "÷ kalker", "", "Peak stress over that of kalker on like rows", "ratio", until="ratio_high"),
    )
    rng = np.random.default_rng(3)
    exact = rng.uniform(300, 500, 200)
    points = {"kalker_table": {"x": exact, "y": exact * rng.normal(1, 0.01, 200)}}
    points["sliding"] = {"x": exact[:33], "y": exact[:33] * rng.lognormal(0, 0.1, 33)}
    return Answer(
        "which model", "models", head, STRESS, table, columns,
        required=(Required(STRESS[0], STRESS[1], "MPa", most=420.0),),
        picture={"base": "kalker", "points": points, "left_out": 3}, curves=CURVES[:2],
        not_checked=NOT_CHECKED, warnings=WARNINGS, facts=FACTS | {"models": ["kalker", "kalker_table", "sliding"]},
    )  # fmt: skip


def how_it_behaves() -> Answer:
    head = {
        "smallest": 1.3e-5, "largest": 4.2e9, "at_smallest": "friction 0.3", "at_largest": "friction 0.05",
        "ends": [{"limit": "fatigue", "body": "roller", "count": 246}, {"limit": "wear", "body": "guide", "count": 26}],
        "of": 288,
    }  # fmt: skip
    table = pd.DataFrame(
        {
            "output": ["Life to the first limit", "Peak stress of the roller", "Slip"],
            "unit": ["h", "MPa", ""],
            "smallest": [1.3e-5, 210.0, -0.02],
            "median": [5_000.0, 404.0, 0.0],
            "largest": [4.2e9, 812.0, math.nan],
        }
    )
    columns = (
        Column("output", "Output", "", "Result", "text", role="name"),
        Column("unit", "Unit", "", "Unit of the numbers of a row", "text"),
        Column("smallest", "Smallest", "", "Over the cases that hold", "number"),
        Column("median", "Median", "", "Over the cases that hold", "number"),
        Column("largest", "Largest", "", "Over the cases that hold", "number"),
    )
    return Answer(
        "how it behaves", "range", head, LIFE, table, columns, ends=COUNTS, curves=CURVES[1:],
        not_checked={}, not_used={"duty": "no life in hours is known"}, not_given={"motor_force": "−30 N"}, facts=FACTS,
    )  # fmt: skip


def nearest(**changes: Any) -> Answer:
    near = {"name": {"roller_profile_radius": 6.2}, "holds": 12, "meets": 9, "of": 12, "low": 850.0}
    return decide("none", headline={"names": [], "nearest": near | {"fails": "radial force 150 N"}}, **changes)


WEAR = {
    "what": "wear coefficient",
    "of": "POM",
    "on": "steel",
    "turn": 3.1e-6,
    "units": "mm3/(N m)",
    "low": 1e-6,
    "high": 2e-5,
}


def measure() -> Answer:
    head: dict[str, Any] = {
        "names": [{"roller_material": "POM"}],
        "low": 6.0,
        "high": 730.0,
        "ends": "wear",
        "extrapolated": False,
    }
    return decide("measure", headline=head | {"measure": WEAR}, columns=(STEEL, *DECIDE), table=_with_steel())


def _with_steel() -> pd.DataFrame:
    return decide_table(12).assign(roller_material=np.resize(["POM", "steel"], 12))


ALL = {
    "build": decide,
    "many": lambda: decide(rows=40),
    "thousands": lambda: decide(rows=3_000),
    "long": long_names,
    "years": years,
    "stresses": stresses,
    "shares": shares,
    "tie": lambda: decide(
        "a_or_b",
        headline={"names": [{"roller_profile_radius": 6.2}, {"roller_profile_radius": 6.3}]},
    ),
    "none": nearest,
    "measure": measure,
    "give": lambda: decide(
        "give", headline={"give": {"what": "the motor force"}, "not_held": {"count": 12, "of": 54, "where": ""}}
    ),
    "finer": lambda: decide("solve_finer"),
    "unknown": lambda: decide(
        "cannot_tell", headline={"names": [], "low": math.nan, "not_judged": {"count": 54, "of": 54, "where": ""}}
    ),
    "up_to": lambda: decide(columns=(GROOVE, *DECIDE[3:]), headline={"up_to": 6.5, "from_on": 6.2}),
    "sure": how_sure,
    "loads": lambda: how_sure(listed=True),
    "matters": what_matters,
    "heights": lambda: what_matters(indices=False),
    "front": best,
    "one": lambda: best("one"),
    "lost": lambda: best("none"),
    "ranged": lambda: best("open"),
    "models": which_model,
    "same": lambda: which_model(""),
    "behaves": how_it_behaves,
}
