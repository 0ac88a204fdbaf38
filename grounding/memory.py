"""Where a running ``MjData`` keeps its contacts: compiled code reads them there, without a Python object in between.

MuJoCo's bindings make a new array of every field at each access, and of the contact list a new object. The places of
the fields come from MuJoCo's own introspection, and are compared once with what the bindings say.
"""

from __future__ import annotations

import ctypes
from functools import cache
from typing import Any, NamedTuple

import mujoco
from mujoco.introspect import ast_nodes
from mujoco.introspect.structs import STRUCTS

from onto_compiler.problems import OntoError

__all__ = ["ContactPlaces", "contact_places"]

_C_TYPES = {
    "int": ctypes.c_int,
    "mjtNum": ctypes.c_double,
    "mjtSize": ctypes.c_int64,
    "size_t": ctypes.c_size_t,
    "mjtByte": ctypes.c_ubyte,
}
_TOUCHING = """<mujoco><worldbody><geom size="1"/><geom size="1" pos="1.9 0 0"/>
<body><freejoint/><geom size="1" pos="0 0.5 0"/></body></worldbody></mujoco>"""


class ContactPlaces(NamedTuple):
    """Bytes: of ``ncon`` and of the pointer ``contact`` in ``mjData``; of ``geom`` in ``mjContact``, and its size."""

    ncon: int
    contact: int
    geom: int
    stride: int


@cache
def contact_places() -> ContactPlaces:
    """The places in the installed MuJoCo; raises ``SIM010`` if its introspection does not describe it."""
    data, contact = _layout("mjData", "contact"), _layout("mjContact")
    places = ContactPlaces(
        _offset(data, "ncon"), _offset(data, "contact"), _offset(contact, "geom"), ctypes.sizeof(contact)
    )
    if not _right(places):
        message = f"the layout of mjData in MuJoCo {mujoco.__version__} is not what its introspection says"
        raise OntoError.of("SIM010", message, "install the tested version of mujoco")
    return places


def _right(places: ContactPlaces) -> bool:
    """Whether the bindings find the contacts of a small scene in the same places."""
    model = mujoco.MjModel.from_xml_string(_TOUCHING)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    count = ctypes.c_int.from_address(data._address + places.ncon).value  # noqa: SLF001  the bindings' way to the C struct
    start = ctypes.c_void_p.from_address(data._address + places.contact).value or 0  # noqa: SLF001  as above
    pairs = data.contact.geom
    found = (data.ncon, pairs.__array_interface__["data"][0], pairs.strides[0])
    return bool(found == (count, start + places.geom, places.stride) and count == 2)


def _layout(struct: str, until: str = "") -> type[ctypes.Structure]:
    """A C structure of MuJoCo's as ctypes lays it out, up to and with field ``until``."""
    fields: list[tuple[str, Any]] = []
    for field in STRUCTS[struct].fields:
        fields.append((field.name, _ctype(field.type)))
        if field.name == until:
            break
    return type(struct, (ctypes.Structure,), {"_fields_": fields})


def _ctype(kind: Any) -> Any:  # noqa: ANN401  of mujoco.introspect.ast_nodes, a ctypes type
    if isinstance(kind, ast_nodes.PointerType):
        return ctypes.c_void_p
    if isinstance(kind, ast_nodes.ArrayType):
        inner = _ctype(kind.inner_type)
        for extent in reversed(kind.extents):
            inner *= extent
        return inner
    if kind.name not in _C_TYPES and kind.name not in STRUCTS:
        message = f"compiled code does not know the C type `{kind.name}` of MuJoCo {mujoco.__version__}"
        raise OntoError.of("SIM010", message, "install the tested version of mujoco")
    return _C_TYPES[kind.name] if kind.name in _C_TYPES else _layout(kind.name)


def _offset(struct: type[ctypes.Structure], field: str) -> int:
    return int(getattr(struct, field).offset)
