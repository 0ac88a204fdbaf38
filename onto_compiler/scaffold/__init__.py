"""``onto new``: first versions of ontologies, predicates, failures, routes and tasks, which pass ``onto check``."""
