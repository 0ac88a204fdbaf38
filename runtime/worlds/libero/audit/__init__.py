"""Is a scene what its task says? Premise failures of a task's initial states, measured and typed."""
