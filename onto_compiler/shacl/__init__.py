"""SHACL Core, SHACL-SPARQL and what rules need of SHACL-AF, over pyoxigraph's terms and Oxigraph's SPARQL."""
