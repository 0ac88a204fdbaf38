"""Planning in PointMaze: sensors, planners and trials."""
