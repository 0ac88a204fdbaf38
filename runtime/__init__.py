"""Observation in, repaired and verified episode out."""
