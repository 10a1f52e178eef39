"""Conventions and the papers behind the methods of a result, chosen by its options."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

_ALWAYS = (
    (
        "Track roller: geometry, equilibrium, life",
        "Wenzel, Bienefeld, Kretschmer, Kirchner (2022): Introducing an open-source simulation model for track rollers "
        "considering friction. Applied Mechanics 3, 692–704. doi:10.3390/applmech3020041",
    ),
)
_JOHNSON = "Johnson (1985): Contact Mechanics. Cambridge University Press, chapters 3 and 4"
_CONTACT = {
    "sliding": ("Friction: full sliding about a spin pole", "Wenzel et al. (2022), equations (21)–(30)"),
    "fastsim": (
        "Friction: simplified theory",
        "Kalker (1982): A fast algorithm for the simplified theory of rolling contact. "
        "Vehicle System Dynamics 11, 1–13",
    ),
    "kalker": (
        "Friction: half-space rolling contact",
        "Kalker (1990): Three-Dimensional Elastic Bodies in Rolling Contact. Kluwer",
    ),
    "kalker_table": (
        "Friction: half-space rolling contact, from a table of solutions",
        "Kalker (1990): Three-Dimensional Elastic Bodies in Rolling Contact. Kluwer",
    ),
}
_LIFE = {
    "elementary": "Miner elementary: the S-N curve runs on below the fatigue limit. Miner (1945): Cumulative "
    "damage in fatigue. Journal of Applied Mechanics 12, A159–A164",
    "haibach": "Haibach: slope 2k − 1 below the fatigue limit. Haibach (2006): Betriebsfestigkeit. Springer",
    "unlimited": "Miner original: unlimited life below the fatigue limit. Miner (1945): Cumulative damage in fatigue. "
    "Journal of Applied Mechanics 12, A159–A164",
}
_DESIGN = {
    "lhs": (
        "Design: Latin hypercube",
        "McKay, Beckman, Conover (1979): A comparison of three methods for selecting "
        "values of input variables. Technometrics 21, 239–245",
    ),
    "sobol": (
        "Design: Sobol sequence",
        "Sobol (1967): On the distribution of points in a cube and the approximate "
        "evaluation of integrals. USSR Comput. Math. Math. Phys. 7, 86–112",
    ),
    "morris": (
        "Design and indices: elementary effects",
        "Morris (1991): Factorial sampling plans for preliminary computational experiments. Technometrics 33, 161–174",
    ),
    "saltelli": (
        "Design and indices: Sobol indices",
        "Saltelli et al. (2010): Variance based sensitivity analysis of "
        "model output. Computer Physics Communications 181, 259–270",
    ),
    "central_composite": (
        "Design: central composite",
        "Box, Wilson (1951): On the experimental attainment of optimum conditions. J. R. Stat. Soc. B 13, 1–45",
    ),
    "box_behnken": (
        "Design: Box–Behnken",
        "Box, Behnken (1960): Some new three level designs for the study of "
        "quantitative variables. Technometrics 2, 455–475",
    ),
    "plackett_burman": (
        "Design: Plackett–Burman",
        "Plackett, Burman (1946): The design of optimum multifactorial experiments. Biometrika 33, 305–325",
    ),
}


def papers(attrs: Mapping[str, Any], results: set[str]) -> list[tuple[str, str]]:
    """(what for, source) of the methods that made these results.

    Parameters
    ----------
    attrs : global attributes of the result (contact_model, hertz, life_rule, design)
    results : names of its variables
    """
    found = list(_ALWAYS)
    hertz = (
        "as tabulated in the published program" if attrs.get("hertz") == "published" else "complete elliptic integrals"
    )
    found.append((f"Contact ellipse and pressure: Hertz, {hertz}", _JOHNSON))
    if "peak_stress" in results:
        found.append(
            (
                "Stresses in the half-space (Boussinesq–Cerruti potentials)",
                "Love (1929): The stress produced in a semi-infinite solid by pressure on part of the boundary. "
                f"Phil. Trans. R. Soc. A 228, 377–420; {_JOHNSON}",
            )
        )
    asked = attrs.get("contact_model", ())
    found += [_CONTACT[name] for name in ([asked] if isinstance(asked, str) else asked) if name in _CONTACT]
    if results & {"life_cycles", "roller_life_hours"}:
        rule = str(attrs.get("life_rule", "elementary"))
        found.append(("Life", _LIFE.get(rule, rule)))
    design = str(attrs.get("design", ""))
    if design in _DESIGN:
        found.append(_DESIGN[design])
    return found


def conventions(attrs: Mapping[str, Any], results: set[str]) -> list[tuple[str, str]]:
    """(subject, convention) that a reader needs to read the numbers right."""
    found = [("Units", "N, mm, MPa; angles in degrees; travel speed in m/min; life in hours of travel at that speed")]
    for key, words in (("sign_conventions", "Signs and frames"), ("life_conventions", "Life")):
        if attrs.get(key):
            found.append((words, str(attrs[key])))
    found.append(
        (
            "Regimes",
            "rolling: the drive torque is balanced in rolling contact; full slip: it cannot be transmitted "
            "and the roller slides; lift-off: one contact carries no load; failed: no solution was found",
        )
    )
    found.append(("Missing values", "a quantity that a regime leaves undefined is missing, never 0"))
    if "peak_stress" in results:
        published = attrs.get("stress_bodies") == "published"
        bodies = "of one body with the mean Poisson ratio (as published)" if published else "of each body on its own"
        found.append(
            (
                "Peak stress",
                f"largest von Mises stress {bodies}, the surface included; figures show the worse of the two contacts",
            )
        )
    return found
