"""``onto new``: first versions of ontologies, terms, tasks, functions and packages, which pass ``onto check``."""
