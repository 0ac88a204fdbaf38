"""robosuite's own tasks: single-arm manipulation, judged by ``_check_success``."""
