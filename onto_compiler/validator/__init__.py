"""Validates records against the shapes when they are written: the SHACL engine over the new statements."""
