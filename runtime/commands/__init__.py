"""The subcommands of ``onto`` that need a simulator: ground, diagnose, repair, demo."""
