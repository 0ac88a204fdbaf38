"""PointMaze played by planners: what is sensed, who plans, and the trial."""
