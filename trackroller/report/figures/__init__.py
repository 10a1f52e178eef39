"""Figures of studies and of single cases. Drawing libraries are imported when something is
drawn.
"""

from trackroller.environment import let_matplotlib_cache

let_matplotlib_cache()
