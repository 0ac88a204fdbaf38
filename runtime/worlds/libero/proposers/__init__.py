"""Proposal generators, one per route; a registered name, never a Python path, ties them to the ontology's routes."""
