"""The output formats of ``onto check``: one module each, imported when it is used.

Each module has ``render(checked) -> str``. To add a format, add a module and a line to :data:`FORMATS`.
"""

from __future__ import annotations

from importlib import import_module

from onto_compiler.check.formats.checked import Checked

__all__ = ["FORMATS", "Checked", "render"]

FORMATS = {
    "text": "as_text",
    "json": "as_json",
    "sarif": "as_sarif",
    "github": "as_github",
    "junit": "as_junit",
}
"""The name of each format, and of its module here."""


def render(name: str, checked: Checked) -> str:
    """``checked`` in the format called ``name``; text and GitHub print nothing for a clean run.

    Raises:
        KeyError: there is no such format.

    """
    module = import_module(f"onto_compiler.check.formats.{FORMATS[name]}")
    text: str = module.render(checked)
    return text
