"""The worlds that tasks are set in: each a folder of its own that no other world imports."""
