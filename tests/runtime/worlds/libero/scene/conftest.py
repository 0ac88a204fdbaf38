"""The small scene of the proposers' tests serves here, too."""

from tests.runtime.worlds.libero.proposers.conftest import world

__all__ = ["world"]
