"""Training of world models: data, one loop, one loss for each network, and ``onto train``."""
