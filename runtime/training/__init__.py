"""Training of world models: data, one loop, one loss for each network, and ``onto train``."""

from __future__ import annotations

__all__ = ["STAGES"]

STAGES = ("projection", "dynamics", "events", "facts")
"""What is trained, in this order; each stage reads the checkpoints of the ones before it."""
