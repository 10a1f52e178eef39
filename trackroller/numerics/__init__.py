"""Numerical helpers without physics: quadrature, threads, interpolation knots, rows and
expressions.
"""
