"""The questions that a study may ask."""

QUESTIONS = ("decide", "what matters", "how sure", "best", "which model", "how it behaves")
