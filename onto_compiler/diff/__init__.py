"""What changed between two versions of an ontology, term by term, and whether that breaks its users."""
