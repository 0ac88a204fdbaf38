"""Registered grounding functions: each reads one native predicate's truth and signed margin from a MuJoCo state."""
