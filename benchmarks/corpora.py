"""``onto check`` on ontologies that others publish, read from a folder of checkouts: nothing of theirs is kept here.

``python -m benchmarks.corpora FOLDER`` gets each at the commit or version that stands below; ``onto bench corpora
FOLDER`` checks what it finds there, each corpus in a process of its own.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatch
from pathlib import Path
from zipfile import ZipFile

from pyoxigraph import RdfFormat, Triple, parse, serialize

from benchmarks.program import PROGRAM, spent
from benchmarks.protocol import Protocol, Row, Trial, alone
from onto_compiler.problems import OntoError

__all__ = ["CORPORA", "Corpus", "checkout"]


@dataclass(frozen=True, slots=True)
class Corpus:
    """A repository at a commit, or a package at a version, and its files that are checked together.

    RDF/XML is turned into Turtle first.
    """

    source: str  # an address, or the name of a package
    commit: str
    files: tuple[str, ...]

    @property
    def is_package(self) -> bool:
        """Whether it comes from the package index."""
        return "/" not in self.source


CORPORA: Mapping[str, Corpus] = {
    "brick": Corpus("brickschema", "0.8.0", ("brickschema/ontologies/1.5/Brick.ttl",)),
    "brick-parts": Corpus(
        "https://github.com/BrickSchema/Brick",
        "80674356d0da9b5db09b20ca30577b5d56f4479b",
        ("bricksrc/*.ttl", "support/*.ttl"),
    ),
    "fibo": Corpus(
        "https://github.com/edmcouncil/fibo", "119fa8c091aa4beece7d22aefa6fe138021a4355", ("FND/AgentsAndPeople/*.rdf",)
    ),
    "gist": Corpus(
        "https://github.com/semanticarts/gist", "c73068bfe779db2643b1e43c920cc8039b15a013", ("ontologies/*.ttl",)
    ),
    "qudt": Corpus(
        "https://github.com/qudt/qudt-public-repo",
        "8b9168d29ab49142be1739bc54078c9320273e79",
        ("src/main/rdf/schema/SCHEMA_QUDT.ttl", "src/main/rdf/vocab/unit/VOCAB_QUDT-UNITS-ALL.ttl"),
    ),
    "schema.org": Corpus(
        "https://github.com/schemaorg/schemaorg", "cc71c8e064859e912aac8b11ec06e6bc53255b6a", ("data/schema.ttl",)
    ),
    "sosa": Corpus(
        "https://github.com/w3c/sdw-sosa-ssn",
        "30254112f1b51969f3ddc6723b5b458f2a057a7d",
        ("ssn/rdf/ontology/core/*.ttl", "ssn/rdf/ontology/extensions/*.ttl"),
    ),
}
"""Where each corpus comes from, by the name of its folder."""


def checkout(folder: Path) -> None:
    """Put every corpus into ``folder``, without the files that are not checked; what is there already is left."""
    for name, corpus in CORPORA.items():
        target = folder / name
        if target.exists():
            continue
        if corpus.is_package:
            _unpack(corpus, target)
            continue
        places = sorted({str(Path(pattern).parent) for pattern in corpus.files})
        for words in (
            ("clone", "--filter=blob:none", "--no-checkout", corpus.source, str(target)),
            ("-C", str(target), "sparse-checkout", "set", *places),
            ("-C", str(target), "checkout", corpus.commit),
        ):
            subprocess.run(["git", *words], check=True)  # noqa: S603, S607 - arguments of our own


def _unpack(corpus: Corpus, target: Path) -> None:
    """The files of a package and what says its version; nothing of it is installed or run."""
    with tempfile.TemporaryDirectory() as name:
        pip = (
            sys.executable,
            "-m",
            "pip",
            "download",
            "--quiet",
            "--no-deps",
            "--only-binary",
            ":all:",
            "--dest",
            name,
        )
        subprocess.run([*pip, f"{corpus.source}=={corpus.commit}"], check=True)  # noqa: S603 - arguments of our own
        (wheel,) = Path(name).glob("*.whl")
        with ZipFile(wheel) as archive:
            wanted = (*corpus.files, "*.dist-info/METADATA")
            members = [one for one in archive.namelist() if any(fnmatch(one, pattern) for pattern in wanted)]
            archive.extractall(target, members)


def of_folder(folder: Path) -> list[Trial]:
    """One trial for each corpus that ``folder`` holds.

    Raises:
        OntoError: CLI002 if it holds none.
    """
    found = [name for name in CORPORA if (folder / name).is_dir()]
    if not found:
        hint = f"`python -m benchmarks.corpora {folder}` puts {', '.join(CORPORA)} into it"
        raise OntoError.of("CLI002", f"`{folder}` holds no checkout", hint)
    return [{"key": name, "folder": str(folder.resolve())} for name in found]


def trials(full: bool) -> list[Trial]:  # noqa: ARG001, FBT001 - the protocol's signature
    """None without a folder."""
    return []


def run(trial: Trial) -> list[Row]:
    """One row: what is checked, what is found by code, and what it costs."""
    root, corpus = Path(trial["folder"]) / trial["key"], CORPORA[trial["key"]]
    files = sorted(file for pattern in corpus.files for file in root.glob(pattern))
    with tempfile.TemporaryDirectory() as name:
        read = [_as_turtle(file, Path(name)) for file in files]
        triples = sum(1 for file in read for _ in _statements(file))
        found, cost = _checked(read)
    codes = Counter(f"{one['code']} {one['severity']}" for one in found)
    figures = {"files": len(files), "triples": triples, "problems": len(found), "codes": dict(sorted(codes.items()))}
    where = {"folder": trial["key"], "commit": _commit(root)}
    return [{"mode": "none", "sees": "none", **where, "expected_commit": corpus.commit, **figures, **cost}]


def _as_turtle(file: Path, folder: Path) -> Path:
    """``file``, or its RDF/XML as Turtle in ``folder``; what is neither is left for the check to say."""
    if file.suffix == ".ttl":
        return file
    target = folder / f"{file.stem}.ttl"
    try:
        triples = [quad.triple for quad in parse(path=file, format=RdfFormat.RDF_XML, base_iri=file.as_uri())]
        target.write_bytes(serialize(triples, format=RdfFormat.TURTLE) or b"")
    except SyntaxError:
        target.write_bytes(file.read_bytes())
    return target


def _statements(file: Path) -> Iterator[Triple]:
    try:
        yield from (quad.triple for quad in parse(path=file, format=RdfFormat.TURTLE, base_iri=file.as_uri()))
    except SyntaxError:
        return


def _checked(files: Sequence[Path]) -> tuple[list[dict[str, str]], dict[str, float]]:
    with tempfile.TemporaryDirectory() as name:
        report = Path(name) / "found.json"
        command = [sys.executable, "-c", PROGRAM, "check", "--no-cache", "--json", *map(str, files)]
        cost = spent(command, {}, report)
        return json.loads(report.read_text(encoding="utf-8"))["problems"], cost


def _commit(root: Path) -> str:
    """The commit, or the version of a package."""
    for found in root.glob("*.dist-info"):
        return found.name.removesuffix(".dist-info").rpartition("-")[2]
    command = ["git", "-C", str(root), "rev-parse", "HEAD"]
    return subprocess.run(command, capture_output=True, text=True, check=False).stdout.strip()  # noqa: S603 - our own


def metrics(rows: Sequence[Row]) -> Mapping[str, float]:
    """Sums over the corpora, and the costs of each."""
    whole = [row for row in rows if "crashed" not in row]
    found: dict[str, float] = {"corpora": len(whole)}
    found |= {name: sum(row[name] for row in whole) for name in ("files", "triples", "problems")}
    for row in whole:
        found[f"{row['key']}.problems"] = row["problems"]
        found[f"{row['key']}.cpu_s"], found[f"{row['key']}.peak_mib"] = row["cpu_s"], row["peak_mib"]
    return {**found, "crashed": len(rows) - len(whole)}


CORPORA_PROTOCOL = Protocol(
    name="corpora",
    help="`onto check` on a FOLDER of checkouts of published ontologies: problems by code, seconds, memory",
    seeds=(),
    trials=trials,
    run=run,
    metrics=metrics,
    alone=alone,
    timed=frozenset({"cpu_s", "peak_mib"}),
    of_tree=frozenset({"problems", "codes"}),
    of_folder=of_folder,
)

if __name__ == "__main__":
    checkout(Path(sys.argv[1]))
