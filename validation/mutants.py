"""The mutations that `validation.mutations` tries, in formulas and outside them.

Each entry is a file of the package, the text before and after, and the tests that may catch the change.
"""

from __future__ import annotations

BORDERS = "results/test_decisions.py"
SLIP = ("contact/test_slip.py", "contact/test_sliding.py", "contact/test_slip_terms.py")
GEOMETRY = ("roller/test_geometry.py", "roller/test_equilibrium.py", "roller/test_solver.py")
ANSWER = ("results/test_answer.py",)
WEAR = ("damage/test_wear.py",)
SOBOL = ("methods/test_indices.py", "results/test_sensitivity.py")
TABLE = ("contact/test_kalker_table.py",)
CONVERGENCE = (BORDERS, "methods/test_indices.py", "results/test_sensitivity.py", "methods/test_given_data.py")
WORDS = (
    BORDERS,
    "report/test_sentences.py",
    "report/test_headlines.py",
    "report/test_answer_page.py",
    "report/test_golden_pages.py",
    "report/test_plots.py",
)
DECISIONS = ("results/test_decisions.py",)
DESIGNS = (BORDERS, "results/test_candidates.py", "report/test_sentences.py")
TARGETS = (BORDERS, "results/test_targets.py", "results/test_robustness.py")
PACKED = (BORDERS, "report/test_explorer.py")
STORE = (BORDERS, "study/test_resume.py", "study/test_two_runs.py")
ANALYSED = (BORDERS, "results/test_sensitivity.py", "results/test_robustness.py", "report/test_report.py")
PLANNED = (BORDERS, "study/test_levels.py", "study/test_resume.py")
SAMPLED = (BORDERS, "study/test_sampling.py")
CARRIAGE = ("carriage/test_carriage_statics.py",)
VEHICLE = ("study/test_carriage_study.py",)
FITS = ("fit/test_fit_line.py",)
FORMULAS = {
    "profile-slip eq. (20)": ("halfspace/rigid_slip.py", "return -np.minimum(deep", "return np.minimum(deep", SLIP),
    "rolling-slip eq. (21)": (
        "halfspace/rigid_slip.py",
        "return shift + profile_slip(x",
        "return shift - profile_slip(x",
        SLIP,
    ),
    "rolling-slip-kernel eq. (21)": (
        "halfspace/rigid_slip.py",
        "np.sqrt(flat * flat - deep)",
        "np.sqrt(flat * flat + deep)",
        (*SLIP, "halfspace/test_peak.py"),
    ),
    "pole-rolling eq. (22)": ("halfspace/rigid_slip.py", "(x_spin / a) ** 2", "(x_spin / b) ** 2", SLIP),
    "pole-lateral eq. (23)": ("halfspace/rigid_slip.py", "return shift / sine", "return shift * sine", SLIP),
    "lateral-slip eq. (24)": ("halfspace/rigid_slip.py", "sine * (y - offset)", "sine * (y + offset)", SLIP),
    "pole-offset eq. (25)": ("halfspace/rigid_slip.py", "k0 + np.maximum(k1", "k0 + np.minimum(k1", SLIP),
    "contact-modulus": (
        "contact/hertz.py",
        "(1 - nu_2**2) / e_2",
        "(1 - nu_1**2) / e_2",
        ("contact/test_hertz.py", "contact/test_contact_models.py"),
    ),
    "axis-ratio": ("contact/hertz.py", "return 2 * x + np.log(d)", "return x + np.log(d)", ("contact/test_hertz.py",)),
    "curvature": (
        "roller/geometry.py",
        "1.0 / np.asarray(rolling_radius) + 1.0",
        "1.0 / np.asarray(rolling_radius) - 1.0",
        GEOMETRY,
    ),
    "lever-arm eq. (14)": (
        "roller/geometry.py",
        "np.cos(contact_angle) - guide_profile_radius)\n    return h_normal",
        "np.cos(contact_angle) + guide_profile_radius)\n    return h_normal",
        GEOMETRY,
    ),
    "point-load": (
        "halfspace/kernels.py",
        "t11 = 3.0 * t4",
        "t11 = 2.0 * t4",
        ("halfspace/test_halfspace_kernels.py",),
    ),
    "exponent": (
        "damage/sn_curve.py",
        "np.log(cycles) / np.log(stresses)",
        "np.log(cycles) * np.log(stresses)",
        ("materials/test_sn_curve.py", "damage/test_fatigue.py"),
    ),
    "creepage-index": (
        "contact/linear.py",
        "c22: np.ndarray\n    c23: np.ndarray",
        "c23: np.ndarray\n    c22: np.ndarray",
        ("contact/test_kalker_linear.py",),
    ),
    "spin-arm": ("contact/table/coordinates.py", "g / 4.0) / 3.0", "g / 2.0) / 3.0", TABLE),
    "coupling": ("contact/table/coordinates.py", "0.5 / (1.0 + g)", "0.5 / (1.0 - g)", TABLE),
    "total-index": ("methods/saltelli.py", '("ST", 1 - of_complement)', '("ST", of_complement)', SOBOL),
    "second-order": ("methods/saltelli.py", "first[:, i] - first[:, j]", "first[:, i] + first[:, j]", SOBOL),
    "dominated": (
        "results/pareto.py",
        "(front_costs < costs[row]).any",
        "(front_costs < costs[row]).all",
        ("results/test_pareto.py",),
    ),
    "direction": ("results/pareto.py", 'direction == "min":', 'direction == "max":', ("results/test_pareto.py",)),
    "wear-depth": ("damage/wear.py", "return np.asarray(1e-3 * k.reshape", "return np.asarray(1e-2 * k.reshape", WEAR),
    "wear-tied": ("damage/wear.py", "np.where(braked, pressed, rubbed)", "np.where(braked, pressed, shear)", WEAR),
    "wear-place": ("damage/wear.py", "0.5 * (after - before)", "0.5 * (before - after)", WEAR),
    "wear-mirrored": ("damage/wear.py", "np.array([1.0, -1.0])[:, None]", "np.array([1.0, 1.0])[:, None]", WEAR),
    "wear-beyond-table": ("damage/wear.py", "slope * np.maximum(work - x[-1]", "0.0 * np.maximum(work - x[-1]", WEAR),
    "wear-gap": ("damage/wear.py", "0.5 * curvature[:, None]", "curvature[:, None]", WEAR),
    "wear-standing-roller": ("damage/wear.py", "where(locked, 1.0,", "where(locked, 0.5,", WEAR),
    "wear-run-in": ("damage/wear.py", "np.max(counted, axis=2), axis=1)", "np.min(counted, axis=2), axis=1)", WEAR),
    "carriage-curve": ("carriage/loads.py", "- inward * across", "+ inward * across", CARRIAGE),
    "carriage-moment": ("carriage/loads.py", "np.cross(at, force)", "np.cross(force, at)", CARRIAGE),
    "carriage-life Miner": (
        "carriage/lives.py",
        "self.time = share / speed",
        "self.time = share * speed",
        VEHICLE,
    ),
    "carriage-worst-roller": ("carriage/lives.py", "-worst.astype(float), np", "worst + 1e9, np", VEHICLE),
    "carriage-wheelbase": (
        "carriage/fields.py",
        "(places - middle) * value / distance",
        "(places - middle) * value",
        VEHICLE,
    ),
    "fit-t-interval": (
        "fit/line.py",
        "stdtrit(freedom, 0.5 + 0.5 * confidence)) ** 2",
        "stdtrit(freedom, confidence)) ** 2",
        FITS,
    ),
}
# borders, signs and orders in study, analysis, report and command line
DECISIONS = {
    "needed-samples": ("methods/convergence.py", "/ target) ** 2", "/ target)", CONVERGENCE),
    "figures-of-error": ("report/numbers.py", "if error >= COARSE", "if error < COARSE", WORDS),
    "share-interval": ("results/comparison.py", "(share + z**2 / (2 * trials))", "(share + z**2 / trials)", ANSWER),
    "requirement-error": ("results/case_ranges.py", "_shrunk(self.low, error)", "_grown(self.low, error)", ANSWER),
    "curve-of-like-cases": (
        "results/effect_curves.py",
        "middle = np.median(full, axis=0)",
        "middle = np.max(full, axis=0)",
        ANSWER,
    ),
    "fewest-conditions": ("results/candidates.py", "self.size.min() >= FEWEST", "self.size.max() >= FEWEST", DESIGNS),
    "unequal-loads": ("results/candidates.py", "np.min(loads, axis=0) /", "np.mean(loads, axis=0) /", DESIGNS),
    "median-case": ("results/candidates.py", "((number - 1) // 2, number", "(number // 2, number", DESIGNS),
    "beyond-data": ("results/lives_by_tests.py", "dtype=float)) | endless", "dtype=float)) & endless", DESIGNS),
    "class-of-a-value": ("results/factor_levels.py", 'side="right") - 1', 'side="left") - 1', (*DESIGNS, *WORDS)),
    "target-met": ("roller/requirement.py", "(values >= self.least) &", "(values > self.least) &", TARGETS),
    "all-targets": ("results/targets.py", ".min(axis=1) for body", ".max(axis=1) for body", TARGETS),
    "curve-in-words": (
        "report/numbers.py",
        'side = "inner"\n        if value > 0',
        'side = "inner"\n        if value < 0',
        WORDS,
    ),
    "drive-in-words": (
        "report/numbers.py",
        'drive = "braked"\n        if value < 0',
        'drive = "braked"\n        if value > 0',
        WORDS,
    ),
    "fold": ("report/numbers.py", "ratio = max(ratio, 1", "ratio = min(ratio, 1", WORDS),
    "way-of-a-goal": (
        "results/search_fitness.py",
        '== "max", -1.0, 1.0',
        '== "max", 1.0, -1.0',
        ("results/test_best.py", "results/test_optimum.py"),
    ),
    "told-peaks": (
        "roller/stages/stress.py",
        "peak.error + results",
        "0.5 * peak.error + results",
        ("roller/test_tolerance.py",),
    ),
    "told-forces": (
        "roller/stages/mechanics.py",
        "error = scene.model.force_error(scene.n)",
        "error = 0.5 * scene.model.force_error(scene.n)",
        ("roller/test_tolerance.py",),
    ),
    "told-pole": (
        "roller/stages/ellipse_stresses.py",
        "POLE_WEIGHT * higher[missed]",
        "0.5 * POLE_WEIGHT * higher[missed]",
        ("roller/test_tolerance.py",),
    ),
    "rungs": ("roller/tolerance.py", "~(best[unmet] <= 1.0)", "~(best[unmet] <= 2.0)", ("roller/test_tolerance.py",)),
    "rate-of-models": ("study/cost.py", "len(several) / sum(1.0 / each", "len(several) / sum(each / 1e6", PLANNED),
    "solved-again": ("study/store/ledger.py", "!= chunks.FAILED).values)", "== chunks.FAILED).values)", STORE),
    "missing-case": (
        "study/store/gather.py",
        "(ledger.state_number < 0).sum()",
        "(ledger.state_number < -1).sum()",
        STORE,
    ),
    "not-positive": ("study/outputs.py", "int((values <= 0).sum())", "int((values < -1e300).sum())", ANALYSED),
    "share-of-rolling": ("study/outputs.py", "if i and (regime == i)", "if (regime == i)", ANALYSED),
    "strata": ("methods/lhs.py", ".random(n)", ".random(n + 1)[:n]", SAMPLED),
    "level-codes": (
        "report/explorer/pack.py",
        "len(column.levels) < np.iinfo",
        "len(column.levels) <= 1 + np.iinfo",
        PACKED,
    ),
    "rare-states": ("report/explorer/pack.py", "counts <= RARE", "counts < RARE", PACKED),
    "least-of-state": ("report/explorer/pack.py", "max(RARE, left", "max(0, left", PACKED),
}
