"""The published example, computed anew beside the printed numbers."""
