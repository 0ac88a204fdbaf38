"""Windows of demonstrations, replayed from LIBERO's flat state, and why some of them fail."""
