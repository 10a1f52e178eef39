"""Turn stress into life: S-N curves, scatter of materials and damage sums."""
