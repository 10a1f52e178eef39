"""Build the table of the exact rolling theory and measure its errors and its range."""
