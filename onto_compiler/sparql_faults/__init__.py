"""Where a query goes wrong, and why, in the query that a person wrote.

Oxigraph has the last word on what is SPARQL. It names the furthest character that any of its rules came to, often the
end; so where it rejects a query, our own grammar finds the token that cannot stand where it does.
"""
