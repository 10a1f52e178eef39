"""Draw the figures that introduce terms: `python docs/drawing.py` writes `scene.svg`, `patch.svg`, `sn_curve.svg`.

They stand in `docs/figures`. The scene is that of the paper's example (the default case), to scale. The S-N curve is
that of its material. The patch is a sketch.
"""

from __future__ import annotations

from pathlib import Path

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from trackroller import Case, load_database
from trackroller.damage.sn_curve import SNCurve
from trackroller.parameters import LIFE_RULES

FOLDER = Path(__file__).parent / "figures"
INK, GREY, ROLLER, GUIDE, FORCE, FRAME = "#1b1f24", "#6e7781", "#dbe7f4", "#eadfce", "#b3261e", "#0b5cad"
GROOVE_HALF_WIDTH = 6.3  # half width of the roller's rim in the drawing [mm]; it is not a parameter


def arrow(axes: Axes, start: tuple[float, float], vector: tuple[float, float], colour: str, label: str, **text) -> None:
    """Draw an arrow from `start` along `vector` and write `label` at its tip."""
    tip = (start[0] + vector[0], start[1] + vector[1])
    style = {"arrowstyle": "-|>", "color": colour, "lw": 1.6, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", xy=tip, xytext=start, arrowprops=style)
    shift = text.pop("shift", (0.0, 0.0))
    axes.text(tip[0] + shift[0], tip[1] + shift[1], label, color=colour, **{"ha": "center", "va": "center", **text})


def measure(axes: Axes, start: tuple[float, float], end: tuple[float, float], label: str, **text) -> None:
    """Draw a dimension line from `start` to `end` with a label beside its middle."""
    axes.annotate("", xy=end, xytext=start, arrowprops={"arrowstyle": "<|-|>", "color": GREY, "lw": 0.9})
    shift = text.pop("shift", (0.0, 0.0))
    middle = ((start[0] + end[0]) / 2 + shift[0], (start[1] + end[1]) / 2 + shift[1])
    axes.text(*middle, label, color=GREY, **{"ha": "center", "va": "center", **text})


def front_view(axes: Axes, case: Case) -> None:
    """Draw the section through the roller's axis: both contacts, their frames, and the forces on the roller."""
    alpha, r_guide, height = np.deg2rad(case.contact_angle), case.guide_profile_radius, case.axis_distance
    r_groove = abs(case.roller_profile_radius)
    point = np.array([r_guide * np.sin(alpha), r_guide * np.cos(alpha)])
    normal = np.array([np.sin(alpha), np.cos(alpha)])
    _bodies(axes, point, normal, r_guide, r_groove, height)
    for sign, number in ((1, 1), (-1, 2)):
        at = point * (sign, 1)
        outward, tangent = normal * (sign, 1), np.array([np.cos(alpha), -sign * np.sin(alpha)])
        axes.plot(*at, "o", color=INK, ms=4, zorder=5)
        axes.text(at[0] + 0.2 * sign, at[1] - 1.4, str(number), color=INK, ha="center", va="center", weight="bold")
        arrow(axes, tuple(at), tuple(3.4 * outward), FORCE, f"$F_{{N{number}}}$", shift=(0.95 * sign, 0.2))
        beside = (3.6, -0.3) if number == 1 else (1.5, 0.55)  # contact 1: beside the roller, off its edge
        arrow(axes, tuple(at), tuple(3.6 * tangent), FRAME, f"$x_C$, $F_{{T{number}}}$", shift=beside)
    turn = np.linspace(np.pi / 2 - alpha, np.pi / 2, 30)
    axes.plot(3.4 * np.cos(turn), 3.4 * np.sin(turn), color=GREY, lw=0.9)
    axes.plot([0, point[0]], [0, point[1]], color=GREY, lw=0.8, ls=(0, (4, 3)))
    axes.text(0.55, 3.75, r"$\alpha$", color=GREY)
    measure(axes, (-10.2, 0), (-10.2, height), "$A_T$", shift=(-0.9, 0))
    measure(axes, (9.4, point[1]), (9.4, height), "$r_A$", shift=(0.9, 0))
    axes.plot([point[0] + 0.4, 9.8], [point[1]] * 2, color=GREY, lw=0.5, ls=":")
    axes.plot([-10.6, 10.6], [height] * 2, color=GREY, lw=0.8, ls="-.")
    axes.plot([-10.6, 0], [0, 0], color=GREY, lw=0.5, ls=":")
    measure(axes, (0, 0), tuple(r_guide * np.array([-0.74, -0.67])), "$r_{C,G}$", shift=(-0.9, 0.9))
    arrow(axes, (0, height), (0, 5.0), FORCE, "$F_{rad}$\n(< 0 presses)", shift=(0, 1.5))
    arrow(axes, (0, height), (5.6, 0), FORCE, "$F_{ax}$, $x_R$", shift=(-0.1, -1.0))
    axes.text(0, 15.6, "roller", ha="center", color=INK)
    axes.text(2.3, -2.6, "guide", ha="center", color=INK)
    axes.text(0, 11.0, r"groove $r_{C,TR} < 0$", ha="center", color=GREY)
    axes.set_title("Section through the roller's axis", color=INK, fontsize=11)
    axes.set_xlim(-13, 13)
    axes.set_ylim(-7, 29.5)


def _bodies(axes: Axes, point, normal, r_guide: float, r_groove: float, height: float) -> None:
    """Fill the cross-sections of the guide and of the roller; the groove touches the guide at both contacts."""
    turn = np.linspace(0, 2 * np.pi, 200)
    axes.fill(r_guide * np.cos(turn), r_guide * np.sin(turn), color=GUIDE, ec=INK, lw=1.1)
    profile = []
    for sign in (-1, 1):  # each flank is an arc about a centre of its own, so that it touches at its contact
        centre = (point - r_groove * normal) * (sign, 1)
        low, high = np.deg2rad([8, 62])
        angles = np.linspace(high, low, 60) if sign < 0 else np.linspace(low, high, 60)
        x, z = centre[0] + sign * r_groove * np.sin(angles), centre[1] + r_groove * np.cos(angles)
        keep = (np.sign(x) == sign) & (np.abs(x) <= GROOVE_HALF_WIDTH)
        profile += list(zip(x[keep], z[keep], strict=True))
    low = min(z for _, z in profile)
    outline = [(-GROOVE_HALF_WIDTH - 1.2, low), *profile, (GROOVE_HALF_WIDTH + 1.2, low)]
    outline += [(GROOVE_HALF_WIDTH + 1.2, height), (-GROOVE_HALF_WIDTH - 1.2, height)]
    axes.fill(*zip(*outline, strict=True), color=ROLLER, ec=INK, lw=1.1, zorder=0)


def side_view(axes: Axes, case: Case) -> None:
    """Draw the view along the roller's axis: rolling direction, drive, friction and the curve of the track."""
    height, radius = (
        case.axis_distance,
        case.axis_distance - case.guide_profile_radius * np.cos(np.deg2rad(case.contact_angle)),
    )
    turn = np.linspace(0, 2 * np.pi, 200)
    axes.fill(radius * np.cos(turn), height + radius * np.sin(turn), color=ROLLER, ec=INK, lw=1.1)
    along = np.linspace(-17.5, 17.5, 80)
    curve = case.guide_curve_radius
    top = height - radius + np.sqrt(curve**2 - along**2) - curve
    axes.fill_between(along, top, top - 6.0, color=GUIDE, ec=INK, lw=1.1)
    axes.plot(0, height, "+", color=INK, ms=9)
    axes.plot(0, height - radius, "o", color=INK, ms=4)
    arrow(axes, (0, height - radius), (8.0, 0), FORCE, "$F_A$, $y_C$", shift=(2.6, 0.9))
    arrow(axes, (0, height), (9.0, 0), GREY, "travel, $y_R$", shift=(-0.6, 1.3))
    arrow(axes, (0, height), (-9.0, 0), FORCE, "$F_{Motor} < 0$\ndrives", shift=(0.6, 2.2))
    measure(
        axes, (0, height), tuple(np.array([0, height]) + radius * np.array([-0.77, -0.64])), "$r_A$", shift=(0.4, -1.2)
    )
    axes.text(0, 1.2, "$r_{Curve} > 0$ outer, < 0 inner curve, inf straight", ha="center", color=GREY, fontsize=9)
    spin = np.linspace(np.deg2rad(120), np.deg2rad(60), 30)
    axes.plot((radius - 2.4) * np.cos(spin), height + (radius - 2.4) * np.sin(spin), color=GREY, lw=1.2)
    end = ((radius - 2.4) * np.cos(spin[-1]), height + (radius - 2.4) * np.sin(spin[-1]))
    axes.annotate("", xy=(end[0] + 0.5, end[1] - 0.32), xytext=end, arrowprops={"arrowstyle": "-|>", "color": GREY})
    axes.set_title("Along the roller's axis", color=INK, fontsize=11)
    axes.set_xlim(-18, 18)
    axes.set_ylim(-3.2, 41.5)


def scene() -> Figure:
    """Return the drawing of roller and guide."""
    figure, (front, side) = plt.subplots(1, 2, figsize=(9.4, 5.4), width_ratios=(26, 30))
    front_view(front, Case())
    side_view(side, Case())
    for axes in (front, side):
        axes.set_aspect("equal")
        axes.axis("off")
    figure.text(
        0.5,
        0.012,
        "Forces are those on the roller. Contact frame: x lateral, y in the rolling direction, z into the body.",
        ha="center",
        color=INK,
    )
    figure.tight_layout(rect=(0, 0.03, 1, 1))
    return figure


def patch() -> Figure:
    """Return the sketch of a patch in contact 1: semi-axes, frame, edges, spin pole, rigid slip, adhesion area."""
    a, b, pole, turn = 3.0, 2.0, np.array([1.5, -0.5]), np.linspace(0, 2 * np.pi, 200)
    figure, axes = plt.subplots(figsize=(6.6, 4.4))
    axes.fill(a * np.cos(turn), b * np.sin(turn), color=GUIDE, ec=INK, lw=1.1, zorder=0)
    x = np.linspace(-0.4, 2.55, 80)
    lead = b * np.sqrt(1 - (x / a) ** 2)
    end = lead - 2.1 * np.sqrt(np.clip(1 - ((x - 1.075) / 1.475) ** 2, 0, None))  # where the traction reaches its limit
    axes.fill_between(x, end, lead, color=ROLLER, ec=INK, lw=0.9, hatch="////")
    for place in ((-2.2, 0.2), (-1.2, -1.2), (-1.0, 0.9), (0.2, -1.5), (-0.1, -0.3), (2.3, -0.9)):
        away = np.array(place) - pole
        arrow(axes, place, tuple(0.28 * np.array([away[1], -away[0]])), FORCE, "")  # phi < 0
    axes.plot(*pole, "o", color=INK, ms=5, zorder=5)
    for name, at, text in (
        ("spin pole", tuple(pole), (3.3, -1.7)),
        ("adhesion (stick) area", (1.6, 0.9), (2.6, 2.2)),
        ("slip area, rigid slip", (-2.1, 0.0), (-5.4, -1.7)),
    ):
        axes.annotate(name, xy=at, xytext=text, color=INK, arrowprops={"arrowstyle": "-", "lw": 0.8})
    arrow(axes, (0, 0), (0, 2.9), FRAME, "$y$, rolling direction", shift=(0, 0.25))
    arrow(axes, (0, 0), (4.0, 0), FRAME, "$x$, lateral", shift=(0.75, 0.0))
    measure(axes, (0, -2.5), (a, -2.5), "$a$", shift=(0, -0.3))
    measure(axes, (-3.5, 0), (-3.5, b), "$b$", shift=(-0.3, 0))
    for place, y in (("leading edge: material enters", b + 0.25), ("trailing edge", -b - 0.3)):
        axes.text(-1.9, y, place, ha="center", va="center", color=GREY)
    axes.set_xlim(-5.6, 5.6)
    axes.set_ylim(-3.1, 3.5)
    axes.set_aspect("equal")
    axes.axis("off")
    figure.tight_layout()
    return figure


def sn_curve() -> Figure:
    """Return the S-N curve of the default material with the rules for stresses below its fatigue limit."""
    material = load_database().material(Case().roller_material)
    knee, first = material.cycles_at_fatigue_limit, material.cycles_at_tensile_strength
    strength = material.tensile_strength
    limit = material.fatigue_strength_ratio * strength
    figure, axes = plt.subplots(figsize=(6.6, 3.9))
    stress = np.geomspace(0.55 * limit, strength, 200)
    for rule, style in zip(LIFE_RULES, ("-", "--", ":"), strict=True):
        cycles = SNCurve.of(material, rule).life_cycles(stress)
        known = np.isfinite(cycles) & (stress >= (limit if rule == "unlimited" else 0))
        axes.plot(cycles[known], stress[known], style, color=INK, label=rule)
    axes.plot([knee, 1e11], [limit, limit], ":", color=INK)
    for at, level, names in ((first, strength, ("$N_{Rm}$", "$R_m$")), (knee, limit, ("$N_k$", r"$\sigma_D$"))):
        axes.plot([at, at, 3e2], [150, level, level], color=GREY, lw=0.7)
        axes.text(at * 1.15, 158, names[0], color=GREY)
        axes.text(4e2, level * 1.02, names[1], color=GREY)
    axes.set(xscale="log", yscale="log", xlim=(3e2, 1e11), ylim=(150, 1.25 * strength))
    axes.set_yticks([200, 300, 400, 600], ["200", "300", "400", "600"])
    axes.minorticks_off()
    axes.set_xlabel("Overrollings N to failure [–]")
    axes.set_ylabel("Peak von Mises stress σ [MPa]")
    axes.legend(title="life_rule", frameon=False)
    figure.tight_layout()
    return figure


FIGURES = {"scene": scene, "patch": patch, "sn_curve": sn_curve}


def draw(name: str, folder: Path = FOLDER) -> Path:
    """Write one of `FIGURES` as SVG with text as text, and return its path."""
    with plt.rc_context():
        plt.rcdefaults()
        plt.rcParams |= {"svg.fonttype": "none", "svg.hashsalt": name, "font.size": 10, "font.family": "sans-serif"}
        figure = FIGURES[name]()
        figure.savefig(folder / f"{name}.svg", metadata={"Date": None}, facecolor="white")
        plt.close(figure)
    return folder / f"{name}.svg"


if __name__ == "__main__":
    for each in FIGURES:
        draw(each)
