"""The commands of LIBERO alone."""
