"""Plans in a world model: cross-entropy search, what scores its candidates, and search that a diagnosis guides."""
