"""MuJoCo state or world-model output in, :class:`grounding.observation.Observation` out. Never steps, never writes."""
