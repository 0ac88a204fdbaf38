"""The settings of ``onto check``: ``[tool.onto.check]`` of ``pyproject.toml``, or ``[check]`` of ``onto.toml``.

The nearest file at or above a checked file counts; in one folder, ``onto.toml`` before ``pyproject.toml``.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from fnmatch import fnmatch
from glob import escape
from pathlib import Path

from onto_compiler.problems import OntoError, Problem, near

__all__ = ["DEFAULT", "FILES", "Settings", "anchored", "parse_codes", "read_settings"]

_KEYS = ("exclude", "ignore", "imports", "namespaces", "per-file-ignores", "select", "severity")
_READABLE = {"TTL007", "TTL008"}  # of prefixes; every other problem of syntax keeps a file from being read
_SEVERITIES = ("error", "warning", "info")
FILES = {"onto.toml": ("check",), "pyproject.toml": ("tool", "onto", "check")}
"""The names of the files that hold settings, and the keys that lead to them."""
_OTHERS = ("imports", "schema")  # beside `check` in `tool.onto`
_HINT = "see docs/checks.md for the keys of [tool.onto.check]"


@dataclass(frozen=True, slots=True)
class Settings:
    """``namespaces`` are a project's own. ``select`` and ``ignore`` hold codes, or how they begin (``DOC``).

    With ``select`` those codes alone are reported, of terms of others too. ``severity`` holds codes with the severity
    that they get instead of theirs, ``per_file`` patterns of paths below ``root`` with the codes ignored there.
    ``exclude`` are patterns of files that folders do not stand for; those with a slash are absolute. ``imports`` are
    files by the IRI that they are imported by, and ``mapped`` those that the command line gives before them.
    """

    namespaces: tuple[str, ...] = ()
    select: tuple[str, ...] = ()
    ignore: tuple[str, ...] = ()
    severity: tuple[tuple[str, str], ...] = ()
    per_file: tuple[tuple[str, tuple[str, ...]], ...] = ()
    root: Path = Path()
    exclude: tuple[str, ...] = ()
    imports: tuple[tuple[str, Path], ...] = ()
    mapped: tuple[tuple[str, Path], ...] = ()

    @property
    def imported(self) -> Mapping[str, Path]:
        """The file of each IRI that the settings or the command line map."""
        return dict((*self.imports, *self.mapped))

    def excludes(self, path: Path) -> bool:
        """Whether a folder above ``path`` does not stand for it: by its own path or name, or that of a folder."""
        places = [path, *path.parents]
        return any(fnmatch(str(one) if "/" in each else one.name, each) for each in self.exclude for one in places)

    def chosen(self, problems: Iterable[Problem]) -> Iterator[Problem]:
        """Those of ``problems`` that are reported, each with its severity; of two that fit, the longer code decides."""
        for problem in problems:
            if self.reports(problem.code) and not self._ignores(problem):
                fitting = [pair for pair in self.severity if problem.code.startswith(pair[0])]
                yield replace(problem, severity=max(fitting, key=lambda pair: len(pair[0]))[1]) if fitting else problem

    def _ignores(self, problem: Problem) -> bool:
        path = Path(problem.file)
        below = path.relative_to(self.root).as_posix() if path.is_relative_to(self.root) else path.as_posix()
        return any(problem.code.startswith(codes) and fnmatch(below, pattern) for pattern, codes in self.per_file)

    def reports(self, code: str) -> bool:
        """Whether problems of ``code`` are reported; what keeps a file from being read always is."""
        if code.startswith("TTL") and code not in _READABLE:
            return True
        chosen = not self.select or code.startswith(self.select)
        return chosen and not code.startswith(self.ignore)


DEFAULT = Settings()


def read_settings(paths: Iterable[Path]) -> Settings:
    """The settings for ``paths``, by the nearest file above the first of them that has any.

    Raises:
        OntoError: CFG001, where the file is no TOML, or holds an unknown key or code.

    """
    for path in paths:
        folder = path.resolve()
        for above in (folder, *folder.parents):
            for name, keys in FILES.items():
                if (above / name).is_file() and (table := _table(above / name, keys)) is not None:
                    return _settings(above / name, table)
    return DEFAULT


def _table(file: Path, keys: tuple[str, ...]) -> Mapping[str, object] | None:
    try:
        table: object = tomllib.loads(file.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise OntoError.of("CFG001", f"`{file.name}` cannot be read: {error}", _HINT, str(file)) from error
    *above, last = keys
    for key in above:
        table = table.get(key) if isinstance(table, dict) else None
    if not isinstance(table, dict):
        return None
    for key in table:
        # All of `onto.toml` is ours; other tables of `tool.onto` belong to other commands.
        if key != last and (not above or (key not in _OTHERS and near(key, [last]))):
            hint = near(key, [last]) or f"write the settings below `[{last}]`"
            raise OntoError.of("CFG001", f"`{'.'.join((*above, key))}` is no table of settings", hint, str(file))
    return _inner(file, table, last) if last in table else None


def _settings(file: Path, table: Mapping[str, object]) -> Settings:
    for key in table:
        if key not in _KEYS:
            message = f"`{key}` is no setting of `onto check`"
            raise OntoError.of("CFG001", message, near(key, _KEYS) or f"there are {', '.join(_KEYS)}", str(file))
    named = str(file)
    severities = _inner(file, table, "severity")
    for code, severity in severities.items():
        if severity not in _SEVERITIES:
            message = f"`{severity}` is no severity of {code}"
            raise OntoError.of("CFG001", message, f"there are {', '.join(_SEVERITIES)}", named)
    ignored = _inner(file, table, "per-file-ignores")
    return Settings(
        namespaces=_texts(file, table, "namespaces"),
        select=parse_codes(_texts(file, table, "select"), named),
        ignore=parse_codes(_texts(file, table, "ignore"), named),
        severity=tuple(zip(parse_codes(severities, named), map(str, severities.values()), strict=True)),
        per_file=tuple((pattern, parse_codes(_texts(file, ignored, pattern), named)) for pattern in ignored),
        root=file.parent,
        exclude=anchored(_texts(file, table, "exclude"), file.parent),
        imports=tuple(_files(file, _inner(file, table, "imports"))),
    )


def anchored(patterns: Iterable[str], folder: Path) -> tuple[str, ...]:
    """Patterns of paths, those with a slash as seen from ``folder``; ``**`` is as ``*``, which crosses folders."""
    plain = (pattern.strip().replace("**", "*").rstrip("/") for pattern in patterns)
    return tuple(f"{escape(str(folder))}/{one.removeprefix('./')}" if "/" in one else one for one in plain if one)


def _files(file: Path, table: Mapping[str, object]) -> Iterator[tuple[str, Path]]:
    """The files of the table ``imports``, as seen from the folder of ``file``."""
    for iri, given in table.items():
        if not isinstance(given, str) or not given:
            raise OntoError.of("CFG001", f"`imports` gives no file for `{iri}`", 'write `"IRI" = "FILE"`', str(file))
        path = file.parent / given
        if not path.is_file():
            hint = "correct the path, which is seen from the folder of the settings"
            raise OntoError.of("CFG001", f"`imports` maps `{iri}` to `{given}`, which is no file", hint, str(file))
        yield iri, path


def _inner(file: Path, table: Mapping[str, object], key: str) -> Mapping[str, object]:
    found = table.get(key, {})
    if not isinstance(found, dict):
        raise OntoError.of("CFG001", f"`{key}` is no table", "see docs/checks.md for an example", str(file))
    return found


def _texts(file: Path, table: Mapping[str, object], key: str) -> tuple[str, ...]:
    found = table.get(key, [])
    if not isinstance(found, list) or not all(isinstance(one, str) and one for one in found):
        raise OntoError.of("CFG001", f"`{key}` is no list of texts", f'write `{key} = ["..."]`', str(file))
    return tuple(found)


def parse_codes(given: Iterable[str], file: str = "") -> tuple[str, ...]:
    """Codes, or how they begin, in capitals; ``ALL`` stands for every code.

    Raises:
        OntoError: CFG001, where no code begins so.

    """
    from onto_compiler.check.pages import codes  # noqa: PLC0415 - most runs name none

    found = []
    for one in given:
        code = one.strip().upper()
        if code == "ALL":
            code = ""
        elif not any(known.startswith(code) for known in codes()) or not code:
            hint = near(code, codes()) or "`onto explain` knows all codes"
            raise OntoError.of("CFG001", f"`{one}` is no code of a problem, nor how one begins", hint, file)
        found.append(code)
    return tuple(found)
