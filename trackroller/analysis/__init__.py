"""Analyse a solved study: sensitivity indices, convergence, robustness and Pareto sets."""
