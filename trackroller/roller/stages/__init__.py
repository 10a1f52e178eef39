"""The stages of a solution, each run only if an output needs it."""
