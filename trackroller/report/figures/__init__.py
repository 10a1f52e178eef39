"""Figures of studies and of single cases. Drawing libraries are imported when something is drawn."""
