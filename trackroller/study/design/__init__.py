"""Expand the factors of a study into its design: the rows of cases to solve."""
