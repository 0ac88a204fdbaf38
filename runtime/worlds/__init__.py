"""The simulated worlds, one folder each, and beside them what they share; see ``docs/worlds.md``."""
