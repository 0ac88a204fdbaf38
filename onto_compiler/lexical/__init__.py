"""Lexical forms in SPARQL: Oxigraph stores ``1.50`` as 1.5 and ``"5"^^xsd:byte`` as the integer 5.

What it would spell again is stored under a datatype that it does not know (:mod:`~onto_compiler.lexical.terms`), and
queries ask for its value wherever they compute with it (:mod:`~onto_compiler.lexical.query`). Data and queries without
such literals run as they are (:mod:`~onto_compiler.lexical.store`).
"""
