"""The description of a record: for each field of a dataclass its term, its form, and whether it may be missing.

:mod:`onto_compiler.record.walk` writes and reads records by it; the SHACL shapes of records
(:mod:`onto_compiler.emit.record_shapes`) and their JSON (:mod:`onto_compiler.record.rows`) are read from it, too.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any, Final, Protocol

from onto_compiler.record.places import Spot, Statement, Subject, Term

__all__ = ["NAN", "REQUIRED", "Derived", "Field", "Form", "PropertyShape", "Record", "missing", "same"]


class _Required:
    """The type of :data:`REQUIRED`."""


REQUIRED: Final = _Required()
"""What a field that may not be missing has in the place of the value that stands for nothing."""
NAN: Final = float("nan")


@dataclass(frozen=True, slots=True)
class PropertyShape:
    """The SHACL constraints on one property: how often (``most`` 0: as often as one likes) and what its values are.

    ``pairs`` are constraints as Turtle writes them (``("sh:datatype", "xsd:string")``), ``wanted`` the same in words.
    """

    path: str  # IRI
    least: int
    most: int
    pairs: tuple[tuple[str, str], ...] = ()
    wanted: str = ""


class Form(Protocol):
    """How the value of a field becomes RDF and comes back."""

    @property
    def json(self) -> str:
        """The kind of the value in JSON, as :class:`onto_compiler.record.rows.Kind` has it."""
        ...

    def write(self, field: Field, value: Any, spot: Spot) -> Iterator[Statement]:  # noqa: ANN401 - of any field
        """The statements that say ``value`` of the record at ``spot``."""
        ...

    def present(self, field: Field, subject: Subject) -> bool:
        """Whether the record of ``subject`` has the field."""
        ...

    def read(self, field: Field, subject: Subject) -> Any:  # noqa: ANN401 - as above
        """The value that :meth:`write` wrote."""
        ...

    def printed(self, value: Any, names: Any) -> Any:  # noqa: ANN401 - as above
        """The value as JSON has it; ``names`` is the schema."""
        ...

    def shapes(self, field: Field) -> Iterable[PropertyShape]:
        """The SHACL constraints on the statements."""
        ...


@dataclass(frozen=True, slots=True)
class Field:
    """One field of a dataclass, or several that one form says together (``name``: their names, with blanks between).

    ``missing`` is the value that is not written and that is read where nothing was written. A field that may not be
    missing is asked for by the shapes, too, unless ``asked`` is false: then what other people write may lack it.
    """

    name: str
    term: str  # IRI of the property; empty if the form has terms of its own
    form: Form
    missing: Any = REQUIRED
    asked: bool = True
    older: Callable[[Subject], Any] | None = None  # reads what former versions wrote; None if there is nothing such
    key: str | None = None  # the name in JSON: None for the field's own, empty where JSON leaves it out

    @property
    def needed(self) -> bool:
        """Whether a record without it is incomplete."""
        return self.missing is REQUIRED


@dataclass(frozen=True, slots=True)
class Derived:
    """A property that follows from the record and is written beside its fields, for queries; it is not read back.

    ``once``: whether it has at most one value; ``asked``: whether it must have one. ``pairs`` and ``wanted`` are as in
    :class:`PropertyShape`; a property without them is no concern of the record's shape.
    """

    term: str
    values: Callable[[Spot], Iterable[Term]]
    pairs: tuple[tuple[str, str], ...] = ()
    wanted: str = ""
    asked: bool = True
    once: bool = True


@dataclass(frozen=True, slots=True)
class Record:
    """How the instances of a dataclass stand in RDF.

    ``type`` is the IRI of their class; empty for a record that is said of the subject that holds it.
    """

    cls: Callable[..., Any]
    type: str
    fields: tuple[Field, ...]
    derived: tuple[Derived, ...] = ()
    about: str = ""  # the definition of its shape

    def field(self, name: str) -> Field:
        """The description of the field ``name``."""
        return next(each for each in self.fields if name in each.name.split())


def same(left: Any, right: Any) -> bool:  # noqa: ANN401 - values of any field
    """Equality under which two undefined numbers are equal, also within dataclasses."""
    if left is right:
        return True
    if isinstance(left, float) and isinstance(right, float):
        return left == right or (left != left and right != right)  # noqa: PLR0124 - NaN differs from itself
    names = getattr(type(left), "__dataclass_fields__", None)
    if names is None or type(left) is not type(right):
        return type(left) is type(right) and bool(left == right)
    return all(same(getattr(left, name), getattr(right, name)) for name in names)


def missing(field: Field, value: Any) -> bool:  # noqa: ANN401 - as above
    """Whether ``value`` is the one that stands for nothing."""
    return value is None or (not field.needed and same(value, field.missing))
