"""The HTML reference of an ontology, for users of its terms."""
