"""Turtle and BDDL in, typed immutable objects out. Imports neither mujoco nor torch."""
