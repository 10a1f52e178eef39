"""The sheet of one roller: its facts, and the page, the terminal text and the JSON text that tell them."""
