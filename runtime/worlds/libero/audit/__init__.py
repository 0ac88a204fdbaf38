"""Whether a scene matches its task: premise failures of a task's initial states, measured and typed."""
