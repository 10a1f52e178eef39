"""Tables of inputs, of one roller and of design points, and how a table is written."""
