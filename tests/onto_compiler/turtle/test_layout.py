"""Formatting keeps the graph, every comment and the author's order, and is done once."""

from __future__ import annotations

import random
import re
from collections.abc import Iterable
from itertools import chain, count
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pyoxigraph import BlankNode, CanonicalizationAlgorithm, Dataset, NamedNode, Quad, RdfFormat, Triple, parse

from onto_compiler.command import CLEAN, FINDINGS
from onto_compiler.problems import OntoError
from onto_compiler.rdf import RDF
from onto_compiler.turtle import layout
from onto_compiler.turtle.layout import format_turtle
from onto_compiler.turtle.printer import WIDTH
from onto_compiler.turtle.remarks import lexemes
from runtime.cli import main

ROOT = Path(__file__).resolve().parents[3]
FILES = sorted(path for folder in ("ontology", "docs", "tests") for path in (ROOT / folder).rglob("*.ttl"))
HERE = Path("/somewhere/file.ttl")

LOOSE = """\
# what this file is for

@prefix skos: <http://www.w3.org/2004/02/skos/core#>.
PREFIX rdf: <http://www.w3.org/1999/02/22-rdf-syntax-ns#>
# our own
@prefix ex:<https://example.org/> . # for good
ex:cup rdf:type ex:Thing, ex:Vessel ; skos:prefLabel "cup"@en;;
    # how heavy
    ex:mass 0.250 ; ex:full false; # so far

    ex:note '''two
  lines''' .


# shapes
ex:Shape ex:property [ ex:path ex:mass ; # the path
        ex:max 1 ], [
     ex:path ex:full
  ] ;
 ex:or ([ ex:a 1 ] [ ex:b 2
   ; ex:c 3 ] ) ;
  ex:in (
    ex:one ex:two # a remark
   # another
    ex:three
   # and no more
  ) .
[] ex:members ( ex:a ex:b ) .
@prefix aaa: <https://example.org/a#> .
aaa:x # who
  a ex:Thing .
# the last word
"""
TIDY = """\
# what this file is for

@prefix aaa: <https://example.org/a#> .
# our own
@prefix ex: <https://example.org/> .  # for good
@prefix rdf: <http://www.w3.org/1999/02/22-rdf-syntax-ns#> .
@prefix skos: <http://www.w3.org/2004/02/skos/core#> .

ex:cup a ex:Thing , ex:Vessel ;
    skos:prefLabel "cup"@en ;
    # how heavy
    ex:mass 0.250 ;
    ex:full false ;  # so far

    ex:note '''two
  lines''' .

# shapes
ex:Shape ex:property [
        ex:path ex:mass ;  # the path
        ex:max 1 ;
    ] , [
        ex:path ex:full ;
    ] ;
    ex:or (
        [ ex:a 1 ]
        [
            ex:b 2 ;
            ex:c 3 ;
        ]
    ) ;
    ex:in (
        ex:one
        ex:two  # a remark
        # another
        ex:three
        # and no more
    ) .
[] ex:members ( ex:a ex:b ) .
aaa:x  # who
    a ex:Thing .
# the last word
"""
PREFIXES = "@prefix ex: <https://example.org/> .\n"


def graph(text: str) -> Dataset:
    """The statements of ``text``, of which isomorphic ones are equal.

    Oxigraph's canonical names do not tell blank nodes in triple terms apart: a blank node stands for each term here,
    and three statements say what it holds.
    """
    quads, terms = list[Quad](), dict[Triple, BlankNode]()

    def plain(term: Any) -> Any:
        if not isinstance(term, Triple):
            return term
        if term not in terms:
            node = terms[term] = BlankNode()
            for name in ("subject", "predicate", "object"):
                quads.append(Quad(node, NamedNode(RDF + name), plain(getattr(term, name))))
        return terms[term]

    for one in parse(text.encode(), format=RdfFormat.TURTLE, base_iri=HERE.as_uri()):
        quads.append(Quad(one.subject, one.predicate, plain(one.object)))
    found = Dataset(quads)
    found.canonicalize(CanonicalizationAlgorithm.UNSTABLE)
    return found


def comments(text: str) -> list[str]:
    return sorted(remark.text for lexeme in lexemes(text) for remark in lexeme.before)


def test_prefixes_come_first_and_everything_else_stays_in_its_order():
    assert format_turtle(LOOSE, HERE) == TIDY
    assert format_turtle(TIDY, HERE) == TIDY
    assert graph(LOOSE) == graph(TIDY)
    assert len(comments(TIDY)) == len(comments(LOOSE)) == 12


def test_the_repository_is_found_whole():
    assert len(FILES) >= 110
    assert sum(path.is_relative_to(ROOT / "ontology") for path in FILES) >= 17


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_every_file_of_the_repository_keeps_graph_and_comments(path):
    try:
        text = path.read_text("utf-8")
        once = format_turtle(text, path)
    except (UnicodeDecodeError, OntoError):
        assert path.stem.startswith("ttl"), "only the examples of syntax errors are refused"
        return
    assert graph(once) == graph(text)
    assert comments(once) == comments(text)
    assert format_turtle(once, path) == once


NAMES = st.sampled_from(["ex:a", "ex:b.c", "<https://example.org/d>", "ex:e\\,f", "_:x", "_:y.z"])
VERBS = st.sampled_from(["a", "ex:p", "ex:q", "rdf:type", "<https://example.org/r>"])
STRINGS = ['"s"', "'t # no comment'", '"""u\n\n "v" """', "'''w\r\n'''", '"\\u0041\\""', f'"{"long " * 25}"']
LITERALS = st.sampled_from(["1", "-2.50", "+3e4", "true", "false", *STRINGS]).flatmap(
    lambda text: (
        st.just([text]) if text[0] not in "\"'" else st.sampled_from(([text], [text, "@en"], [text, "^^", "ex:d"]))
    )
)


SHORT = LITERALS.filter(lambda words: words[0][:3] not in {'"""', "'''"})  # Oxigraph refuses long ones in triples
TERMS = st.one_of(NAMES.map(lambda name: [name]), SHORT, st.just(["[]"]))
DIRECTED = st.sampled_from((['"d"', "@en--ltr"], ["'e'", "@ar--rtl"]))
REIFIERS = st.sampled_from((["~"], ["~", "ex:r"], ["~", "_:x"], ["~", "<https://example.org/r>"]))
INNER_SUBJECTS = st.one_of(NAMES.map(lambda name: [name]), st.just(["[]"]))


def triple(opening, closing, objects, ends):
    parts = st.tuples(INNER_SUBJECTS, VERBS.map(lambda verb: [verb]), objects, ends)
    return parts.map(lambda found: [opening, *chain.from_iterable(found), closing])


TRIPLE_TERMS = st.recursive(
    triple("<<(", ")>>", TERMS, st.just([])), lambda inner: triple("<<(", ")>>", inner, st.just([])), max_leaves=3
)
REIFIED = st.recursive(
    triple("<<", ">>", st.one_of(TERMS, TRIPLE_TERMS), st.one_of(st.just([]), REIFIERS)),
    lambda inner: triple("<<", ">>", inner, st.one_of(st.just([]), REIFIERS)),
    max_leaves=3,
)


def joined(parts: list[list[str]], mark: str) -> list[str]:
    return parts[0] + [word for part in parts[1:] for word in (mark, *part)]


def properties(nodes: st.SearchStrategy[list[str]]) -> st.SearchStrategy[list[str]]:
    annotation = st.lists(st.tuples(VERBS, TERMS).map(lambda pair: [pair[0], *pair[1]]), min_size=1, max_size=2)
    block = annotation.map(lambda found: ["{|", *joined(found, ";"), "|}"])
    notes = st.lists(st.one_of(REIFIERS, block), max_size=2).map(lambda found: list(chain.from_iterable(found)))
    annotated = st.tuples(nodes, st.one_of(st.just([]), notes)).map(lambda pair: [*pair[0], *pair[1]])
    objects = st.lists(annotated, min_size=1, max_size=3).map(lambda found: joined(found, ","))
    one = st.tuples(VERBS, objects).map(lambda pair: [pair[0], *pair[1]])
    ends = st.sampled_from(([], [";"], [";", ";"]))
    return st.tuples(st.lists(one, min_size=1, max_size=3), ends).map(lambda pair: joined(pair[0], ";") + pair[1])


NODES = st.recursive(
    st.one_of(
        NAMES.map(lambda name: [name]),
        LITERALS,
        st.just(["[", "]"]),
        st.just(["(", ")"]),
        DIRECTED,
        TRIPLE_TERMS,
        REIFIED,
    ),
    lambda inner: st.one_of(
        st.lists(inner, max_size=3).map(lambda items: ["(", *(word for item in items for word in item), ")"]),
        properties(inner).map(lambda items: ["[", *items, "]"]),
    ),
    max_leaves=8,
)


STATEMENTS = st.one_of(
    st.tuples(NAMES.map(lambda name: [name]), properties(NODES)).map(lambda pair: [*pair[0], *pair[1], "."]),
    properties(NODES).map(lambda items: ["[", *items, "]", "."]),
    properties(NODES).flatmap(lambda items: properties(NODES).map(lambda more: ["[", *items, "]", *more, "."])),
    REIFIED.map(lambda words: [*words, "."]),
    st.tuples(REIFIED, properties(NODES)).map(lambda pair: [*pair[0], *pair[1], "."]),
    st.sampled_from((["@version", '"1.2"', "."], ["VERSION", "'1.2'"])),
    st.sampled_from((["@prefix", "new:", "<n#>", "."], ["PREFIX", "ex:", "<https://example.org/>"])),
    st.sampled_from((["@base", "<https://example.com/>", "."], ["prefix", "b:", "<https://example.com/b>"])),
)
GAPS = (*(" \t\n" * 2), "\n\n", "\r\n", "\n\n\n  ", " #\n", "\n#\n", "\n\n # \n", " #\n#\n", " # \n\n#\n\n")


def spread(words: Iterable[str], rng: random.Random) -> str:
    """The words with space and numbered remarks between them."""
    number = count(1)
    text = "".join(word + rng.choice(GAPS) for word in words)
    return re.sub(r"(?m)#(?=[\r\n ]*$)", lambda _: f"# remark {next(number)}", text)


@settings(max_examples=80, deadline=None)
@given(st.lists(STATEMENTS, max_size=4), st.integers(0, 2**32))
def test_whatever_is_written_keeps_graph_and_comments_and_formatting_twice_is_formatting_once(statements, seed):
    start = ["@prefix", "ex:", "<https://example.org/>", ".", "PREFIX", "rdf:", f"<{RDF}>"]
    text = spread(chain(start, *statements), random.Random(seed))  # noqa: S311 - places need no secrecy
    once = format_turtle(text, HERE)
    assert graph(once) == graph(text)
    assert comments(once) == comments(text)
    assert format_turtle(once, HERE) == once


NEW = """\
# head
@prefix ex:<https://example.org/>.
# the language
VERSION "1.2" # of this file
PREFIX rdf: <http://www.w3.org/1999/02/22-rdf-syntax-ns#>
<<ex:cup ex:on ex:table~ex:r>>ex:said ex:ann.
<< ex:cup rdf:type ex:Cup >> .
ex:ann ex:claims <<( ex:cup ex:on # what
  ex:table )>> ; ex:name "آن"@ar--rtl ; ex:sees ex:cup ~ ex:s {| ex:when 3 ;
  # how sure
  ex:sure 0.5 |}, ex:table ~ _:x, ex:chair {| ex:when <<( ex:a ex:b <<( ex:c a "x"@en )>>)>> |} ~ {| ex:p 1 |} .
"""
LAID_OUT = """\
# head
# the language
@version "1.2" .  # of this file
@prefix ex: <https://example.org/> .
@prefix rdf: <http://www.w3.org/1999/02/22-rdf-syntax-ns#> .

<< ex:cup ex:on ex:table ~ ex:r >> ex:said ex:ann .
<< ex:cup a ex:Cup >> .
ex:ann ex:claims <<(
        ex:cup
        ex:on  # what
        ex:table
    )>> ;
    ex:name "آن"@ar--rtl ;
    ex:sees ex:cup ~ ex:s {|
            ex:when 3 ;
            # how sure
            ex:sure 0.5 ;
        |} ,
        ex:table ~ _:x ,
        ex:chair {| ex:when <<( ex:a ex:b <<( ex:c a "x"@en )>> )>> |} ~ {| ex:p 1 |} .
"""


def test_what_turtle_1_2_adds_is_laid_out():
    assert format_turtle(NEW, HERE) == LAID_OUT
    assert format_turtle(LAID_OUT, HERE) == LAID_OUT
    assert graph(NEW) == graph(LAID_OUT)
    assert comments(NEW) == comments(LAID_OUT)


@pytest.mark.parametrize(
    "text",
    [
        '@version "1.2" .\nex:a ex:b ex:c .\n@version "1.1" .\n',
        "ex:a ex:b <<( ex:c ex:d <<( ex:e ex:f 1 )>> )>> .\n",
        "<< << ex:a ex:b ex:c >> ex:d ex:e ~ ex:f >> .\n",
    ],
)
def test_what_is_laid_out_stays(text):
    whole = f"{PREFIXES}\n{text}" if not text.startswith("@") else text.replace("\n", f"\n{PREFIXES}", 1)
    assert format_turtle(whole, HERE) == whole


@given(st.lists(st.text("abc", min_size=1, max_size=40), min_size=1, max_size=12), st.sampled_from("[(,"))
def test_what_can_be_broken_is_no_wider_than_a_line(words, kind):
    names = [f"ex:{word}" for word in words]
    inside = {
        "[": f"[ {' ; '.join(f'ex:p {name}' for name in names)} ]",
        "(": f"( {' '.join(names)} )",
        ",": " , ".join(names),
    }[kind]
    text = f"{PREFIXES}\nex:s ex:p {inside} .\n"
    printed = format_turtle(text, HERE)
    assert max(map(len, printed.splitlines())) <= WIDTH
    assert (printed == text) == (len(text.splitlines()[-1]) <= WIDTH)


@pytest.mark.parametrize(
    "directives",
    [
        "@prefix ex: <https://example.org/> .\nex:a a ex:B .\n@prefix ex: <https://example.com/> .\nex:a a ex:B .\n",
        "@prefix ex: <x#> .\n@base <https://example.org/> .\nex:a a <b> .\n",
        "@prefix ex: <x#> .\nex:a a <b> .\n@base <https://example.org/> .\nex:a a <b> .\n",
        "@base <https://example.org/> .\n<a> a <b> .\n@base <c/> .\n<a> a <b> .\n",
    ],
)
def test_directives_stay_where_they_mean_something_else_at_the_top(directives):
    assert format_turtle(directives, HERE) == directives


def test_the_type_is_spelt_out_where_its_prefix_is_another():
    text = "@prefix rdf: <https://example.org/> .\n\nrdf:a rdf:type rdf:b .\n"
    assert format_turtle(text, HERE) == text


def test_a_prefix_that_is_declared_twice_is_declared_once():
    twice = f"{PREFIXES}ex:a a ex:b . # one\n# again\n{PREFIXES}ex:c a ex:d .\n"
    assert format_turtle(twice, HERE) == (
        "# again\n@prefix ex: <https://example.org/> .\n\nex:a a ex:b .  # one\nex:c a ex:d .\n"
    )


def test_line_ends_are_the_files_own_and_a_byte_order_mark_goes(tmp_path):
    path = tmp_path / "windows.ttl"
    path.write_bytes(b"\xef\xbb\xbf" + PREFIXES.replace("\n", "\r\n").encode() + b'ex:a ex:b """x\r\ny\n""" .\r\n')
    assert main(["fmt", str(path)]) == CLEAN
    wanted = PREFIXES.replace("\n", "\r\n").encode() + b'\r\nex:a ex:b """x\r\ny\n""" .\r\n'
    assert path.read_bytes() == wanted
    assert main(["fmt", "--check", str(path)]) == CLEAN


def test_the_command_formats_checks_and_shows_folders_of_both_kinds(tmp_path, capsys):
    loose, tidy = tmp_path / "sub" / "loose.ttl", tmp_path / "tidy.ttl"
    loose.parent.mkdir()
    loose.write_text(LOOSE, "utf-8")
    tidy.write_text(TIDY, "utf-8")
    (tmp_path / "task.bddl").write_text("(define (problem P)", "utf-8")
    assert main(["fmt", "--check", str(tmp_path)]) == FINDINGS
    captured = capsys.readouterr()
    assert captured.out == f"{loose}\n"
    assert "BDDL002" in captured.err
    assert captured.err.endswith("1 of 3 files would change\n")
    assert main(["fmt", "--diff", str(loose)]) == FINDINGS
    assert "\n-    ex:mass 0.250 ; ex:full false; # so far\n" in capsys.readouterr().out
    assert loose.read_text("utf-8") == LOOSE
    assert main(["fmt", str(loose), str(tidy)]) == CLEAN
    assert capsys.readouterr().err == "1 of 2 files changed\n"
    assert loose.read_text("utf-8") == TIDY


def test_a_syntax_error_is_told_as_onto_check_tells_it_and_the_file_is_left_alone(tmp_path, capsys):
    path = tmp_path / "broken.ttl"
    path.write_text(f"{PREFIXES}ex:a a ex:B\nex:c a ex:D .\n", "utf-8")
    before = path.read_bytes()
    assert main(["fmt", str(path)]) == FINDINGS
    told = capsys.readouterr().err.replace("0 of 1 file changed\n", "")
    assert main(["check", str(path)]) == FINDINGS
    assert told.strip() in capsys.readouterr().out
    assert told.startswith("error[TTL005]")
    assert path.read_bytes() == before


@pytest.mark.parametrize(
    ("name", "content", "code"),
    [
        ("latin.ttl", b"# caf\xe9\n", "TTL002"),
        ("gone.ttl", None, "TTL002"),
    ],
)
def test_what_cannot_be_laid_out_is_left_alone(tmp_path, capsys, name, content, code):
    path = tmp_path / name
    if content is not None:
        path.write_bytes(content)
    assert main(["fmt", str(path)]) == FINDINGS
    assert f"error[{code}]" in capsys.readouterr().err
    assert content is None or path.read_bytes() == content


def test_a_layout_that_would_change_the_triples_is_never_written(tmp_path, monkeypatch, capsys):
    path = tmp_path / "a.ttl"
    path.write_text(PREFIXES + "ex:a a ex:b .", "utf-8")
    monkeypatch.setattr(layout, "print_document", lambda _: [PREFIXES, "ex:a a ex:c ."])
    assert main(["fmt", str(path)]) == FINDINGS
    assert "error[FMT001]" in capsys.readouterr().err
    assert path.read_text("utf-8") == PREFIXES + "ex:a a ex:b ."


def test_the_shipped_ontology_is_laid_out(capsys):
    assert main(["fmt", "--check", str(ROOT / "ontology")]) == CLEAN
    assert capsys.readouterr().out == ""
