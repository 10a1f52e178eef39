"""What a report says on a subject, sentences and tables in one file; a sentence holds its claim
beside its text.
"""
