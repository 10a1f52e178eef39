"""Turn stress into life: S-N curves, their scatter and damage sums."""
