"""From arguments to an exit code; a traceback is only printed on request."""

from __future__ import annotations

import os
import sys
import traceback
from collections.abc import Sequence

from onto_compiler.command import CLEAN, MISUSE, print_json
from onto_compiler.problems import OntoError, render_all
from onto_compiler.versions import version_of
from runtime.cli.discovery import advice, installed, load
from runtime.cli.foreign import foreign_problem
from runtime.cli.parser import overview, parser_of

__all__ = ["INTERNAL", "INTERRUPTED", "PIPE_CLOSED", "main"]

INTERNAL = 70  # EX_SOFTWARE of sysexits.h
INTERRUPTED = 130  # 128 + SIGINT, as shells report it
PIPE_CLOSED = 141  # 128 + SIGPIPE


def main(argv: Sequence[str] | None = None) -> int:
    """Run ``onto`` with ``argv`` (default: the process's own) and return its exit code."""
    arguments = list(sys.argv[1:] if argv is None else argv)
    try:
        code = _run(arguments)
        # A closed pipe must show here, where it can be kept quiet, not at interpreter exit.
        sys.stdout.flush()
    except OntoError as error:
        return _report(error, as_json=_wants_json(arguments))
    except KeyboardInterrupt:
        sys.stderr.write("onto: interrupted; what was recorded so far is kept\n")
        return INTERRUPTED
    except BrokenPipeError:
        # The reader is gone: what is still buffered must not raise again at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return PIPE_CLOSED
    except ImportError as error:
        return _missing(error, arguments)
    except Exception as error:  # noqa: BLE001 - the last line of defence of a program
        return _failed(error, arguments)
    return code


def _run(arguments: list[str]) -> int:
    points = installed()
    if not arguments:
        sys.stderr.write(overview(points))
        return MISUSE
    name, *rest = arguments
    if name in {"-h", "--help", "help"}:
        if name == "help" and rest:
            return _run([rest[0], "--help"])
        sys.stdout.write(overview(points))
        return CLEAN
    if name in {"-V", "--version"}:
        sys.stdout.write(f"onto {version_of('onto-evwm') or '(not installed)'}\n")
        return CLEAN
    if name.startswith("-"):
        raise OntoError.of("CLI002", f"the option `{name}` stands before a command", "write `onto COMMAND [OPTIONS]`")
    command = load(name, points)
    try:
        options = parser_of(command).parse_args(rest)
    except SystemExit as leave:  # argparse leaves the process after --help
        return int(leave.code or CLEAN)
    return command.run(options)


def _wants_json(arguments: Sequence[str]) -> bool:
    """Whether JSON was requested; looks at the raw arguments, since parsing them may have failed."""
    pairs = zip(arguments, [*arguments[1:], ""], strict=True)
    return any(word in {"--json", "--format=json"} or (word, value) == ("--format", "json") for word, value in pairs)


def _report(error: OntoError, *, as_json: bool) -> int:
    if as_json:
        print_json({"problems": [problem.as_dict() for problem in error.problems]})
    else:
        sys.stderr.write(render_all(error.problems))
    return MISUSE


def _missing(error: ImportError, arguments: Sequence[str]) -> int:
    hint = advice(error)
    if not hint:
        return _failed(error, arguments)
    command = next((word for word in arguments if not word.startswith("-")), "this")
    problem = OntoError.of("CLI003", f"`onto {command}` needs the Python package `{error.name}`", hint)
    return _report(problem, as_json=_wants_json(arguments))


def _failed(error: Exception, arguments: Sequence[str]) -> int:
    """The problem to report for an exception in registered code or in ours."""
    foreign = foreign_problem(error)
    if foreign is None:
        return _internal(error)
    if os.environ.get("ONTO_DEBUG") == "1":
        traceback.print_exception(error)
    return _report(foreign, as_json=_wants_json(arguments))


def _internal(error: Exception) -> int:
    if os.environ.get("ONTO_DEBUG") == "1":
        traceback.print_exception(error)
    text = " ".join(str(error).split())
    sys.stderr.write(
        f"onto: internal error: {type(error).__name__}: {text}\n"
        "This is a fault of `onto`, not of your input. Please report it with the command that you ran and what\n"
        "ONTO_DEBUG=1 onto ... prints.\n"
    )
    return INTERNAL
