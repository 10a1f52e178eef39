"""Take measured results over into the documentation and the package."""
