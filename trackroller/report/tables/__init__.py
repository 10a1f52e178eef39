"""Tables of inputs and of one roller, and how a table is written."""
