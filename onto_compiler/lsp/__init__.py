"""A language server for Turtle and BDDL: what an editor shows while a file is being written."""
