"""Values of materials from tests: S-N lines of coupons and rollers, wear and friction, how sure, and the next test."""
