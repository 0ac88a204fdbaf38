"""The world model of LIBERO-Goal's scene: what it is trained on, and its training."""
