"""The world model of LIBERO-Goal's scene: training data and training."""
