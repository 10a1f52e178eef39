"""Pages: the report of a study, the sheet of one roller, the load spectrum."""
