"""Which texts a datatype allows, and which literals can be compared."""

import pytest
from pyoxigraph import Literal, NamedNode

from onto_compiler.rdf import XSD
from onto_compiler.validator.literals import comparable, number, well_formed

GOOD = {
    "boolean": ["true", "false", "0", "1"],
    "byte": ["-128", "127"],
    "date": ["2026-02-28", "2024-02-29Z", "2026-02-28+02:00"],
    "dateTime": ["2026-02-28T10:00:00", "2026-02-28T10:00:00.5Z"],
    "decimal": ["1", "-1.50", ".5", "+3."],
    "double": ["1", "1.0", "1e-3", ".5E6", "INF", "-INF", "NaN"],
    "integer": ["0", "-7", "+12", "9" * 5000],
    "nonNegativeInteger": ["0", "12"],
    "string": ["", "anything"],
    "unsignedByte": ["255"],
}
BAD = {
    "boolean": ["maybe", "True", ""],
    "byte": ["128", "-129", "9" * 5000],
    "date": ["2026-02-30", "28.2.2026", "2026-02-28T10:00:00"],
    "dateTime": ["2026-02-28", "2026-02-28T25:00:00", "2026-02-28 10:00:00"],
    "decimal": ["1e3", "", ".", "one"],
    "double": ["inf", "nan", "high", "1e", "1_0", "0x1p3"],
    "integer": ["1.0", "", "one", "1_0", "\u0661"],
    "nonNegativeInteger": ["-1"],
    "unsignedByte": ["256", "-1"],
}


def literal(text, name):
    return Literal(text, datatype=NamedNode(XSD + name))


@pytest.mark.parametrize("name", sorted(GOOD))
def test_a_datatype_allows_what_xml_schema_allows(name):
    assert [text for text in GOOD[name] if not well_formed(text, XSD + name)] == []
    assert [text for text in BAD.get(name, []) if well_formed(text, XSD + name)] == []


def test_a_datatype_that_is_not_known_allows_everything():
    assert well_formed("anything", "https://example.org/own")


def test_numbers_compare_across_datatypes():
    values = [literal("1", "integer"), literal("1.5", "decimal"), literal("2.5e0", "double"), literal("INF", "float")]
    kinds, found = zip(*map(comparable, values), strict=True)
    assert set(kinds) == {"number"}
    assert list(found) == sorted(found)


def test_what_has_no_order_is_not_compared():
    assert comparable(Literal("chat", language="fr")) is None
    assert comparable(literal("high", "double")) is None
    assert comparable(literal("x", "anyURI")) is None
    assert number(Literal("2")) is None
    assert number(literal("2", "integer")) == 2


def test_moments_compare_only_where_both_or_neither_has_a_zone():
    here, there = (
        comparable(literal("2026-02-28T10:00:00", "dateTime")),
        comparable(literal("2026-02-28T10:00:00Z", "dateTime")),
    )
    assert here[0] != there[0]
    later = comparable(literal("2026-02-28T10:00:00-01:00", "dateTime"))
    assert later[0] == there[0]
    assert later[1] > there[1]
