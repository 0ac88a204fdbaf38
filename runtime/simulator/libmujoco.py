"""MuJoCo's own C functions, callable from numba without Python in between.

``libmujoco`` is already in the process when the ``mujoco`` package is imported; here its symbols are made known to
LLVM. They stay symbols in the compiled code, so that numba's cache on disk is valid in the next process. Model and data
are passed as addresses (``MjModel._address``, ``MjData._address``).
"""

from __future__ import annotations

import ctypes
from pathlib import Path
from typing import Any

import llvmlite.binding
import mujoco
from mujoco.introspect import ast_nodes
from mujoco.introspect.structs import STRUCTS
from numba.core import types

from onto_compiler.problems import OntoError

_C_TYPES = {
    "int": ctypes.c_int,
    "mjtNum": ctypes.c_double,
    "mjtSize": ctypes.c_int64,
    "size_t": ctypes.c_size_t,
    "mjtByte": ctypes.c_ubyte,
}

__all__ = ["NCON_OFFSET", "mj_jac_site", "mj_step1", "mj_step2"]


def _load() -> None:
    folder = Path(mujoco.__file__).parent
    found = sorted(p for p in folder.iterdir() if p.name.startswith(("libmujoco", "mujoco.dll")))
    if not found:
        raise OntoError.of("SIM010", f"no MuJoCo library beside {mujoco.__name__}", "reinstall mujoco", str(folder))
    llvmlite.binding.load_library_permanently(str(found[0]))


def _layout(struct: str, until: str = "") -> type[ctypes.Structure]:
    """A C structure of MuJoCo's as ctypes lays it out, up to and with field ``until``, from MuJoCo's introspection."""
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
        message = f"the compiled loop does not know the C type `{kind.name}` of MuJoCo {mujoco.__version__}"
        raise OntoError.of("SIM010", message, "install the tested version of mujoco")
    return _C_TYPES[kind.name] if kind.name in _C_TYPES else _layout(kind.name)


def _offset(struct: type[ctypes.Structure], field: str) -> int:
    return int(getattr(struct, field).offset)


def _ncon_offset() -> int:
    """Bytes from the start of ``mjData`` to its field ``ncon``, seen to be right by writing it through Python."""
    offset = _offset(_layout("mjData", "ncon"), "ncon")
    data = mujoco.MjData(mujoco.MjModel.from_xml_string("<mujoco/>"))
    data.ncon = 1_234_567
    found = ctypes.c_int.from_address(data._address + offset).value  # noqa: SLF001  the bindings' way to the C struct
    data.ncon = 0
    if found != 1_234_567:
        message = f"the layout of mjData in MuJoCo {mujoco.__version__} is not what its introspection says"
        raise OntoError.of("SIM010", message, "install the tested version of mujoco")
    return offset


_load()
_POINTER = types.uint64
mj_step1: Any = types.ExternalFunction("mj_step1", types.void(_POINTER, _POINTER))
mj_step2: Any = types.ExternalFunction("mj_step2", types.void(_POINTER, _POINTER))
mj_jac_site: Any = types.ExternalFunction("mj_jacSite", types.void(_POINTER, _POINTER, _POINTER, _POINTER, types.int32))
NCON_OFFSET = _ncon_offset()
