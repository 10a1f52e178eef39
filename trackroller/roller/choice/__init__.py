"""Choose the cheapest contact model that meets a tolerance."""
