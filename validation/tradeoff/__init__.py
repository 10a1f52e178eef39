"""Measure what accuracy costs: stages and contact models against converged solutions over random designs."""
