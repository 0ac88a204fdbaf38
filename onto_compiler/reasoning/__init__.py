"""The consequences of an ontology, and contradictions among its axioms."""
