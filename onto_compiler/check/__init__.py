"""``onto check``: what is wrong with an ontology, and where."""
