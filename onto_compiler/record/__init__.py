"""Records in RDF by one table: what a field is called there, which form it takes, and whether it may be missing."""
