"""The words of SPARQL: its keywords, and its functions with the numbers of arguments that they take."""

from __future__ import annotations

from onto_compiler.sparql_faults.fault import FORMS

__all__ = ["FUNCTIONS", "KEYWORDS"]

_HEADS = "PREFIX BASE VERSION DISTINCT REDUCED AS FROM NAMED WHERE VALUES GROUP BY HAVING ORDER ASC DESC LIMIT OFFSET"
_PATTERNS = "UNION OPTIONAL MINUS GRAPH SERVICE SILENT FILTER BIND UNDEF NOT IN EXISTS SEPARATOR"
KEYWORDS = frozenset((*FORMS, *_HEADS.split(), *_PATTERNS.split()))

_NONE = "NOW RAND STRUUID UUID"
_ONE = (
    "ABS AVG BOUND CEIL COUNT DATATYPE DAY ENCODE_FOR_URI FLOOR GROUP_CONCAT HASLANG HASLANGDIR HOURS IRI ISBLANK ISIRI"
    " ISLITERAL ISNUMERIC ISTRIPLE ISURI LANG LANGDIR LCASE MAX MD5 MIN MINUTES MONTH OBJECT PREDICATE ROUND SAMPLE"
    " SECONDS SHA1 SHA256 SHA384 SHA512 STR STRLEN SUBJECT SUM TIMEZONE TZ UCASE URI YEAR"
)
_TWO = "CONTAINS LANGMATCHES SAMETERM STRAFTER STRBEFORE STRDT STRENDS STRLANG STRSTARTS"
_MANY = 1_000
FUNCTIONS = {
    **dict.fromkeys(_NONE.split(), (0, 0)),
    **dict.fromkeys(_ONE.split(), (1, 1)),
    **dict.fromkeys(_TWO.split(), (2, 2)),
    **dict.fromkeys(("IF", "STRLANGDIR", "TRIPLE"), (3, 3)),
    **dict.fromkeys(("REGEX", "SUBSTR"), (2, 3)),
    **dict.fromkeys(("COALESCE", "CONCAT"), (0, _MANY)),
    "BNODE": (0, 1),
    "REPLACE": (3, 4),
}
"""The least and the greatest number of arguments of each."""
