"""Episodes as RDF on PROV-O: written, read back, stored, exported and questioned."""
