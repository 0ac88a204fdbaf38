"""For people: each problem with its line and a caret, as a compiler prints it."""

from __future__ import annotations

import re

from onto_compiler.check.formats.checked import Checked
from onto_compiler.problems import render as render_problem

__all__ = ["render"]

_STYLES = {"error": "bold red", "warning": "bold yellow", "info": "bold blue"}
_MARGIN = re.compile(r"^ +(?:-->|\||=) ?")
_CARET = re.compile(r"^   \| +\^+$")


def render(checked: Checked) -> str:
    """Every problem, an empty line behind each."""
    sources = (checked.text(problem.file) if problem.line else None for problem in checked.problems)
    problems = map(render_problem, checked.problems, sources)
    if not checked.colour:
        return "".join(f"{problem}\n\n" for problem in problems)
    return _coloured([(problem.severity, text) for problem, text in zip(checked.problems, problems, strict=True)])


def _coloured(problems: list[tuple[str, str]]) -> str:
    """The same text with the severity and the caret in a colour of their own, and the margin dim."""
    import io  # noqa: PLC0415 - few runs have colours

    from rich.console import Console  # noqa: PLC0415 - as above
    from rich.text import Text  # noqa: PLC0415 - as above

    stream = io.StringIO()
    console = Console(file=stream, force_terminal=True, color_system="standard", highlight=False, legacy_windows=False)
    for severity, lines in problems:
        style = _STYLES[severity]
        for number, line in enumerate(lines.split("\n")):
            text = Text(line)
            if number == 0:
                text.stylize(style, 0, line.index(":"))
                text.stylize("bold", line.index(":"))
            elif margin := _MARGIN.match(line):
                text.stylize("blue", 0, margin.end())
                text.stylize(style, margin.end() if _CARET.match(line) else len(line))
            console.print(text, soft_wrap=True)
        console.print()
    return stream.getvalue()
