"""Derivations of the compiled stress kernels and of the stored linear creepage coefficients, as programs."""
