"""DINO-WM's PointMaze: the maze, its true dynamics, pictures, trials, data, and a Gymnasium environment."""
