"""Numerical stability where quantities become tiny, huge or equal: scenes, claims and random cases."""
