"""The predicate `in_line`: its ontology, the function that measures it, and a proposer for where it does not hold."""
