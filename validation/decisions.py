"""Mutations outside formulas: borders, signs and orders in study, analysis, report and command line.

`validation.mutations` runs them with those of the formulas. Each entry is a file of the package, the text before and
after, and the tests that may catch the change.
"""

from __future__ import annotations

CONVERGENCE = ("analysis/test_sensitivity.py", "analysis/test_enough.py", "analysis/test_given_data.py")
WORDS = ("report/test_sentences.py", "report/test_truth.py", "report/test_truth_analysis.py", "report/test_report.py")
DESIGNS = ("analysis/test_designs.py", "report/test_sentences.py", "report/test_truth.py")
TARGETS = ("analysis/test_targets.py", "analysis/test_robustness.py", "report/test_truth_targets.py")
PACKED = ("report/test_explorer.py",)
STORE = ("study/test_resume.py", "study/test_two_runs.py", "cli/test_cli.py")
ANALYSED = ("analysis/test_sensitivity.py", "analysis/test_robustness.py", "report/test_report.py")
PLANNED = ("study/test_levels.py", "study/test_resume.py", "cli/test_cli.py")
SAMPLED = ("study/test_sampling.py",)
DECISIONS = {
    "needed-samples": ("analysis/convergence.py", "/ target) ** 2", "/ target)", CONVERGENCE),
    "converged": ("analysis/convergence.py", 'converged." if times <= 1', 'converged." if times <= 4', CONVERGENCE),
    "interval-of-a-step": ("analysis/effects.py", "a - low_a))", "high_a - a))", WORDS),
    "rising": ("analysis/effects.py", "(steps > 0).sum()), int", "(steps >= 0).sum()), int", WORDS),
    "fewest-conditions": ("analysis/designs.py", "self.size.min() >= FEWEST", "self.size.max() >= FEWEST", DESIGNS),
    "unequal-loads": ("analysis/designs.py", "np.min(loads, axis=0) /", "np.mean(loads, axis=0) /", DESIGNS),
    "median-case": ("analysis/designs.py", "((number - 1) // 2, number", "(number // 2, number", DESIGNS),
    "beyond-data": ("analysis/designs.py", "> limit) | np.isposinf", "> limit) & np.isposinf", DESIGNS),
    "class-of-a-value": ("analysis/groups.py", 'side="right") - 1', 'side="left") - 1', (*DESIGNS, *WORDS)),
    "target-met": ("analysis/targets.py", "(values >= low) &", "(values > low) &", TARGETS),
    "all-targets": ("analysis/targets.py", ".min(axis=1) for body", ".max(axis=1) for body", TARGETS),
    "curve-in-words": ("report/numbers.py", "'outer' if value > 0", "'outer' if value < 0", WORDS),
    "drive-in-words": ("report/numbers.py", "'driven' if value < 0", "'driven' if value > 0", WORDS),
    "fold": ("report/words/factors.py", "times(max(effect.ratio, 1", "times(min(effect.ratio, 1", WORDS),
    "rounded-outwards": ("report/words/regimes.py", "np.floor if way < 0", "np.floor if way > 0", WORDS),
    "bent": ("report/words/indices.py", "if sigma[r.factor] > 0.5 *", "if sigma[r.factor] > 5.0 *", WORDS),
    "pareto-end": (
        "report/words/pareto.py",
        'np.argmax(table) if way == "max"',
        'np.argmax(table) if way == "min"',
        WORDS,
    ),
    "same-share": ("report/words/targets.py", "- share[worst] < SAME", "- share[worst] > SAME", TARGETS),
    "rate-of-models": ("study/cost.py", "len(several) / sum(1.0 / each", "len(several) / sum(each / 1e6", PLANNED),
    "solved-again": ("study/store/inventory.py", "!= chunks.FAILED).values)", "== chunks.FAILED).values)", STORE),
    "missing-case": ("study/store/gather.py", "(place < 0).sum()", "(place < -1).sum()", STORE),
    "not-positive": ("study/outputs.py", "int((values <= 0).sum())", "int((values < -1e300).sum())", ANALYSED),
    "share-of-rolling": ("study/outputs.py", "if i and (regime == i)", "if (regime == i)", ANALYSED),
    "strata": ("study/design/grown_lhs.py", "permutation(empty)[:new]", "permutation(size)[:new]", SAMPLED),
    "level-codes": (
        "report/explorer/pack.py",
        "len(column.levels) < np.iinfo",
        "len(column.levels) <= 1 + np.iinfo",
        PACKED,
    ),
    "rare-states": ("report/explorer/sample.py", "counts <= RARE", "counts < RARE", PACKED),
}
