"""Exact solutions that the tests compare the solver with: closed forms of stresses, and a patch shifted at rest."""
