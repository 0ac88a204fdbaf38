"""LIBERO's tabletop manipulation under MuJoCo."""
