"""One module per protocol, the engine that fans trials out, and what was measured (``results/``)."""
