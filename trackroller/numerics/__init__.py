"""Numerical helpers without physics: quadrature, threads, interpolation knots and expressions."""
