"""Sentences on a study, one file a subject; each returns its claim beside its text."""
