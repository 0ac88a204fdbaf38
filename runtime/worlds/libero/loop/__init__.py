"""The correction loop's environment over LIBERO's native one, and whole episodes in it."""
