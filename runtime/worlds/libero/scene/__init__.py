"""Reading a LIBERO scene: poses and targets, observations and pictures, the horizon of a suite."""
