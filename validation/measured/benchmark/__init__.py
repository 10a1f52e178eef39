"""A benchmark of rolling contact: inputs and truths as tables, and the errors of any program that solves them."""
