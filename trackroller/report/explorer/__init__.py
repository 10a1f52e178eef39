"""The explorer of a study: linked views of its cases in the report, or as a page of its own."""
