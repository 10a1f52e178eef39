"""The contact models side by side over the shipped sample of rollers."""
