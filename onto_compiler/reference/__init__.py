"""The HTML reference of an ontology: what a person reads who has to use its terms."""
