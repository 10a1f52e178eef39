"""Reference numbers of other programs beside numbers of this package."""
