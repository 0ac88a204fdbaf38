"""Where the parts of a Turtle file stand. Read only once a problem is known: Oxigraph does the parsing proper."""
