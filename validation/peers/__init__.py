"""Reference numbers of other programs beside those of this package."""
