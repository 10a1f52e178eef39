"""How well the intervals of fitted S-N lines cover, and whether the posterior is calibrated."""
