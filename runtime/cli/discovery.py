"""Which commands are installed: the entry points of the group ``onto_evwm.commands``, loaded one at a time."""

from __future__ import annotations

from collections.abc import Iterator
from importlib.metadata import EntryPoint, entry_points

from onto_compiler.command import Command
from onto_compiler.problems import OntoError, near

__all__ = ["GROUP", "advice", "group_title", "installed", "load", "load_all"]

GROUP = "onto_evwm.commands"

# The top-level module whose absence an extra of the distribution repairs.
_EXTRAS = {
    "PIL": "report",
    "owlready2": "hermit",
    "bddl": "sim",
    "gymnasium": "sim",
    "h5py": "demos",
    "libero": "sim",
    "mujoco": "sim",
    "lsprotocol": "lsp",
    "numba": "sim",
    "pygls": "lsp",
    "robosuite": "sim",
    "safetensors": "learn",
    "torch": "learn",
}
_TITLES = {
    "onto_compiler": "Ontologies and task files",
    "grounding": "Scenes and observations",
    "runtime": "Episodes and traces",
    "benchmarks": "Measurements",
}


def installed() -> dict[str, EntryPoint]:
    """Every registered command by name, none of them imported yet; in alphabetical order."""
    return {point.name: point for point in sorted(entry_points(group=GROUP), key=lambda point: point.name)}


def group_title(point: EntryPoint) -> str:
    """The heading under which the help lists a command: it follows from the package that registers it."""
    return _TITLES.get(point.value.partition(".")[0], "Extensions")


def advice(error: ImportError) -> str:
    """How to install the module that an import lacks; an empty string if no extra provides it."""
    extra = _EXTRAS.get((error.name or "").partition(".")[0])
    return f"run `pip install 'onto-evwm[{extra}]'`" if extra else ""


def load(name: str, points: dict[str, EntryPoint]) -> Command:
    """Import the command called ``name``.

    Raises:
        OntoError: CLI001 if no installed package registers such a command.

    """
    if name not in points:
        hint = near(name, points) or "`onto --help` lists the commands"
        raise OntoError.of("CLI001", f"`{name}` is not a command of `onto`", hint)
    command: Command = points[name].load()
    return command


def load_all(points: dict[str, EntryPoint]) -> Iterator[tuple[str, Command | ImportError]]:
    """Import every command; one that cannot be imported is given as its error, so that the help lists the others."""
    for name, point in points.items():
        try:
            yield name, point.load()
        except ImportError as error:
            yield name, error
        except AttributeError as error:
            yield name, ImportError(str(error), name=point.value)
