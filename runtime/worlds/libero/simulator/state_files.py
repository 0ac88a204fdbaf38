"""Read initial states from ``.npz`` files and from torch's zip archives, without torch and without running a pickle.

LIBERO publishes its initial states with ``torch.save``. Such a file is a pickle, which can call any function. The
reader here admits the few names that rebuild a numeric array or tensor, each replaced by its own inert version, and
refuses the rest: no code of the file, of numpy or of torch is called on its behalf.
"""

from __future__ import annotations

import io
import pickle
import zipfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import Any

import numpy as np
from numpy.typing import NDArray

from onto_compiler.problems import OntoError

__all__ = ["load_states"]

STORAGES = {
    "DoubleStorage": "<f8",
    "FloatStorage": "<f4",
    "HalfStorage": "<f2",
    "LongStorage": "<i8",
    "IntStorage": "<i4",
}
NUMERIC_KINDS = "fiu"


def load_states(path: Path) -> NDArray[np.float64]:
    """The states in ``path`` (``.npz`` with an array ``states``, ``.npy``, or a torch zip archive), shape (n, width).

    Raises ``SIM014`` when the file is none of these, or holds anything but one finite numeric array.
    """
    try:
        states = _load_numpy(path) if path.suffix in {".npz", ".npy"} else _load_torch(path)
        states = np.atleast_2d(np.asarray(states, dtype=np.float64))
    except _REFUSALS as error:
        raise OntoError.of(
            "SIM014",
            f"initial states refused: {error}",
            "a file of initial states holds one numeric array and nothing else",
            str(path),
        ) from error
    if states.ndim != 2 or not np.isfinite(states).all():
        raise OntoError.of(
            "SIM014",
            f"initial states refused: an array of shape {states.shape} that is not a finite table",
            "each row is time, qpos, qvel",
            str(path),
        )
    return states


class _RefusedError(Exception):
    """The archive asks for something other than a numeric array."""


_REFUSALS = (
    _RefusedError,
    pickle.UnpicklingError,
    zipfile.BadZipFile,
    ValueError,
    TypeError,
    KeyError,
    IndexError,
    AttributeError,
    EOFError,
    OSError,
)


def _load_numpy(path: Path) -> NDArray[Any]:
    loaded = np.load(path, allow_pickle=False)
    if isinstance(loaded, np.ndarray):
        return loaded
    with loaded:
        names = list(loaded.files)
        if names != ["states"]:
            raise _RefusedError(f"it holds {', '.join(names) or 'nothing'}, not `states`")
        return np.asarray(loaded["states"])


def _load_torch(path: Path) -> NDArray[Any]:
    with zipfile.ZipFile(path) as archive:
        pickles = [name for name in archive.namelist() if PurePosixPath(name).name == "data.pkl"]
        if len(pickles) != 1:
            raise _RefusedError(f"it holds {len(pickles)} data.pkl, not one")
        folder = PurePosixPath(pickles[0]).parent
        order = str(folder / "byteorder")
        if order in archive.namelist() and archive.read(order) != b"little":
            raise _RefusedError("its tensors are not little-endian")
        reader = _ArrayUnpickler(io.BytesIO(archive.read(pickles[0])), lambda key: archive.read(f"{folder}/data/{key}"))
        value = reader.load()
    if isinstance(value, (list, tuple)) and value:
        return np.stack([_as_array(item) for item in value])
    return _as_array(value)


def _as_array(value: object) -> NDArray[Any]:
    if isinstance(value, _PickledArray):
        return value.array()
    if isinstance(value, np.ndarray):
        return value
    raise _RefusedError(f"it holds a {type(value).__name__}, not an array")


@dataclass
class _PickledDtype:
    """Stands for ``numpy.dtype(code)``: keeps its code and byte order."""

    code: str
    order: str = "<"

    def __setstate__(self, state: tuple[Any, ...]) -> None:
        self.order = state[1] if state[1] in {"<", ">"} else "<"

    def numeric(self) -> np.dtype[Any]:
        dtype = np.dtype(self.code).newbyteorder(self.order)  # type: ignore[arg-type]  # "<" or ">", see above
        if dtype.kind not in NUMERIC_KINDS:
            raise _RefusedError(f"it holds items of type {self.code}, not numbers")
        return dtype


@dataclass
class _PickledArray:
    """Stands for ``numpy.ndarray``: keeps what the pickle says of it."""

    state: tuple[Any, ...] = field(default=())

    def __setstate__(self, state: tuple[Any, ...]) -> None:
        self.state = state

    def array(self) -> NDArray[Any]:
        _, shape, dtype, fortran, raw = self.state
        if not isinstance(dtype, _PickledDtype) or not isinstance(raw, bytes):
            raise _RefusedError("it holds an array of objects")
        return np.frombuffer(raw, dtype=dtype.numeric()).reshape(shape, order="F" if fortran else "C")


def _dtype(code: str, *_: object) -> _PickledDtype:
    if not isinstance(code, str):
        raise _RefusedError("it holds a structured array")
    return _PickledDtype(code)


def _reconstruct(*_: object) -> _PickledArray:
    return _PickledArray()


def _latin1(text: str, encoding: str) -> bytes:
    if encoding not in {"latin1", "latin-1"}:
        raise _RefusedError(f"it asks for the codec {encoding}")
    return text.encode("latin-1")


def _tensor(
    storage: NDArray[Any], offset: int, size: tuple[int, ...], stride: tuple[int, ...], *_: object
) -> NDArray[Any]:
    """Rebuild a strided tensor; every index is checked against the storage."""
    reach = offset + sum((n - 1) * s for n, s in zip(size, stride, strict=True)) if all(size) else offset
    if min((offset, *size, *stride)) < 0 or (all(size) and reach >= storage.size):
        raise _RefusedError("a tensor reaches outside its storage")
    index = np.full(size, offset, dtype=np.intp)
    for axis, (n, s) in enumerate(zip(size, stride, strict=True)):
        index += (np.arange(n) * s).reshape([-1 if a == axis else 1 for a in range(len(size))])
    return np.asarray(storage[index])


def _no_hooks(*_: object) -> dict[str, object]:
    """Stands for ``OrderedDict()``, which torch pickles as a tensor's (empty) backward hooks."""
    return {}


_ADMITTED: Mapping[tuple[str, str], object] = {
    ("torch._utils", "_rebuild_tensor_v2"): _tensor,
    ("collections", "OrderedDict"): _no_hooks,
    ("numpy.core.multiarray", "_reconstruct"): _reconstruct,
    ("numpy._core.multiarray", "_reconstruct"): _reconstruct,
    ("numpy", "ndarray"): _PickledArray,
    ("numpy", "dtype"): _dtype,
    ("_codecs", "encode"): _latin1,
    **{("torch", name): code for name, code in STORAGES.items()},
}


class _ArrayUnpickler(pickle.Unpickler):
    """Builds arrays only; ``read`` gives the bytes of a storage by its key."""

    def __init__(self, file: io.BytesIO, read: Callable[[str], bytes]) -> None:
        super().__init__(file)
        self._read = read

    def find_class(self, module: str, name: str) -> Any:  # noqa: ANN401  as declared by pickle.Unpickler
        if (module, name) not in _ADMITTED:
            raise _RefusedError(f"it asks for {module}.{name}")
        return _ADMITTED[module, name]

    def persistent_load(self, pid: Any) -> NDArray[Any]:  # noqa: ANN401  as declared by pickle.Unpickler
        kind, code, key, _, _ = pid
        if kind != "storage" or code not in STORAGES.values() or not str(key).isdigit():
            raise _RefusedError("it refers to something other than a tensor's storage")
        return np.frombuffer(self._read(str(key)), dtype=np.dtype(code))
