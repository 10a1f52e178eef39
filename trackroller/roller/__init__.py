"""Solve one roller: case, geometry, equilibrium, stages and the labelled data set."""
