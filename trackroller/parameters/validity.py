"""The validity flags of a result: where an assumption of the model does not hold, and what the user can do."""

from __future__ import annotations

from typing import NamedTuple


class ValidityFlag(NamedTuple):
    """A validity flag.

    Attributes
    ----------
    words : str
        What the flag says, as a clause of a sentence; of a flag `of_body`, "of the roller" may follow.
    criterion : str
        When the flag is set, for the data set and the reference.
    remedy : str
        Advice to the user.
    of_body : bool
        Whether the flag may hold for one body alone.
    """

    words: str
    criterion: str
    remedy: str
    of_body: bool = False


# the place in this list is the bit of the flag in `validity`, so that a new flag comes last
VALIDITY: dict[str, ValidityFlag] = {
    "half_space": ValidityFlag(
        "the patch is too large for a half-space",
        "b above 0.3 of the smallest radius of curvature, or a above 0.3 of the radius in the rolling plane or above "
        "0.65 of the lateral radius of a groove or its guide (0.3 of other rollers and of drawn profiles): the bodies "
        "are not half-spaces",
        "A semi-axis is too large for the radii: take pressure and stress as estimates, or choose a less close fit.",
        of_body=True,
    ),
    "yield": ValidityFlag(
        "the contact pressure exceeds the yield limit",
        "p_max above 1.6 R_m of a body (R_m taken for the yield strength): plastic flow under the surface",
        "The body yields below the surface: choose a closer fit, a stronger material or less load.",
        of_body=True,
    ),
    "static": ValidityFlag(
        "the peak stress exceeds the tensile strength",
        "peak stress above R_m of the body: static failure, so that it has no fatigue life",
        "The body fails at once and has no fatigue life: choose a closer fit, a stronger material or less load.",
        of_body=True,
    ),
    "conformal": ValidityFlag(
        "the patch reaches the edge of the groove or the middle of the guide",
        "the patch reaches the edge of the groove or the middle of the guide",
        "Choose a less close fit, or solve drawn profiles with normal: halfspace.",
    ),
    "jamming": ValidityFlag(
        "friction alone can carry the lateral load of a contact, and the wedge may lock",
        "friction carries the lateral load: |F_T| >= F_N tan(alpha) in a contact, or, after lift-off, without "
        "the axial force: the wedge may lock, and the slightest axial force lifts a contact",
        "Choose a larger contact angle or less friction.",
    ),
    "large_slip": ValidityFlag(
        "the longitudinal creepage exceeds 10 %",
        "longitudinal creepage above 10 %: friction heat and wear decide",
        "Friction heat and wear decide the life: choose less motor force or more radial force.",
    ),
    "deep_life": ValidityFlag(
        "the peak stress lies below the fatigue limit",
        "fatigue stress of the worse contact below the fatigue limit: the life depends on life_rule",
        "The life rests on the rule beyond the limit: state the rule with the life (life_rule), and do not trust more "
        "than its order of magnitude.",
        of_body=True,
    ),
    "split_pole": ValidityFlag(
        "the stress of full sliding is singular",
        "the slip of the sliding model vanishes away from its spin pole, or twice in a patch: there the "
        "stress of the model grows without bound, as a logarithm; use kalker",
        "Solve it with contact_model: kalker.",
    ),
    "steep_friction": ValidityFlag(
        "friction falls faster with the slip speed than the surfaces follow",
        "mu p_max v max(-df/dv) (1/G + h/(G_3 l)) above 1 (kalker), with a film h/G_3 and the length l of an element: "
        "friction falls faster with the slip speed than the surfaces follow; a patch has several states or none, and "
        "the roller may not roll steadily",
        "The roller may not roll steadily: use a friction law that falls less steeply.",
    ),
    "overheated": ValidityFlag(
        "the temperature rises above the limit of the material",
        "temperature rise above what the temperature limit of the material leaves (group heat)",
        "Choose less friction, speed or load, or a material for higher temperatures.",
        of_body=True,
    ),
    "worn": ValidityFlag(
        "the groove wears away within the life",
        "the life of the body to its first limit, in km of travel, exceeds run_in_distance, beyond which the profiles "
        "are no longer those given (group wear); of a spectrum or carriage, both over all load cases",
        "Take the life as an estimate: beyond the run-in distance the worn groove decides pressure, stress and life.",
        of_body=True,
    ),
    "tolerance_missed": ValidityFlag(
        "the estimated error exceeds the tolerance",
        "estimated error above the tolerance of the option accuracy on every rung",
        "Take a larger tolerance, or the estimated errors as they are: adhesion covers less than an element there.",
    ),
    "smoothing": ValidityFlag(
        "the pressure depends on how far measured points are smoothed",
        "p_max changes by more than a tenth if the smoothing of measured points is doubled, or halved but not below "
        "the noise that is found in them",
        "Compare smooth: auto with twice the noise, measure with less noise, or describe the shape by its radii (arc, "
        "arcs).",
    ),
    "wear_extrapolated": ValidityFlag(
        "the frictional work lies outside the table of wear",
        "frictional work of an element above the last work_rate of wear_table, or below its first one (wear_law: "
        "energy): the loss of mass is extrapolated",
        "Take depth and life of wear as estimates, or extend wear_table by tests at this frictional work.",
    ),
    "close_fit": ValidityFlag(
        "the fit is so close that Hertz's pressure is too low",
        "a above 0.3 and at most 0.65 of the lateral radius of a groove and its guide: pressure_model_error, "
        "peak_stress_model_error, semi_axis_model_error and friction_power_model_error say by how much Hertz's theory "
        "errs",
        "Add pressure_model_error to pressures and stresses, or choose a less close fit.",
    ),
}
