"""What follows from an ontology, and which of its axioms clash."""
