"""Measured and reference numbers of others beside those of this program, each with its source."""
