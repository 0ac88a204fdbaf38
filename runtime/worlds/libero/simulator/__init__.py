"""The native LIBERO simulator: where it is installed, its tasks and states, and the environment that judges."""
