"""Shapes compiled to plain Python, which checks single records in microseconds; no query engine runs."""
