"""Records held to the shapes as they are written: the SHACL engine over the few statements at hand."""
