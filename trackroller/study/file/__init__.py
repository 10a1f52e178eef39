"""The study file: its keys, its checks, its goals, its table of cases."""
