"""Add up the damage of a load spectrum."""
