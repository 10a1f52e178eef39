"""The files of a study: its folder, plan, chunks, inventory and crate, and the identity of its
cases.
"""
