"""The program ``onto``: one entry for every command that an installed package registers."""

from runtime.cli.program import main

__all__ = ["main"]
