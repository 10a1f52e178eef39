"""The results of a study, and what follows from them: candidates, sensitivity indices, robustness, Pareto sets."""
