"""DINO-WM's PointMaze: the maze and its true dynamics, pictures, trials, data and the Gymnasium environment."""
