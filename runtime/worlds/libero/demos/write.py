"""Write demonstrations as LIBERO's readers and robomimic's expect them, and what a replay needs beside it.

Source of the layout: LIBERO ``scripts/create_dataset.py`` (what is written), ``libero/lifelong/datasets.py`` and
robomimic ``utils/dataset.py`` (what is read). Equal demonstrations give equal bytes.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from onto_compiler.atomic import replacing
from onto_compiler.problems import OntoError
from runtime.worlds.libero.demos.hdf5 import PACKED, h5py
from runtime.worlds.libero.demos.records import Demonstration
from runtime.worlds.libero.demos.snapshot_hdf5 import write_hidden, write_start

__all__ = ["ABOUT", "merge", "write"]

ABOUT = "onto"  # the attribute of the group ``data`` in which a file of ours says how it was made


def write(path: Path, attributes: Mapping[str, Any], about: Mapping[str, Any], demos: Iterable[Demonstration]) -> None:
    """Write ``path`` in one piece: it is there whole, or as it was before.

    ``attributes`` are those of the group ``data``; ``num_demos`` and ``total`` are counted here. Raises ``DEM006``
    where the folder cannot be written.
    """

    def fill(file: Any) -> None:  # noqa: ANN401  h5py is untyped
        data = _data(file, attributes, about)
        total = 0
        for number, demo in enumerate(demos):
            _write_demo(data.create_group(f"demo_{number}"), demo)
            total += len(demo)
        _count(data, total)

    _whole(path, fill)


def merge(
    path: Path, attributes: Mapping[str, Any], about: Mapping[str, Any], parts: Iterable[tuple[Path, str]]
) -> None:
    """Write ``path`` from the demonstrations of other files, each a file and a name in it, without reading pictures.

    Raises ``DEM006`` as :func:`write`.
    """
    library = h5py()

    def fill(file: Any) -> None:  # noqa: ANN401  h5py is untyped
        data = _data(file, attributes, about)
        total = 0
        for number, (part, name) in enumerate(parts):
            with library.File(part, "r", locking=False) as source:
                source.copy(f"data/{name}", data, name=f"demo_{number}")
            total += int(data[f"demo_{number}"].attrs["num_samples"])
        _count(data, total)

    _whole(path, fill)


def _whole(path: Path, fill: Any) -> None:  # noqa: ANN401  a function of an untyped file
    library = h5py()
    try:
        with replacing(path) as partial, library.File(partial, "w", locking=False) as file:
            fill(file)
    except OSError as error:
        raise OntoError.of("DEM006", f"cannot be written: {error}", "choose another --out", str(path)) from error


def _data(file: Any, attributes: Mapping[str, Any], about: Mapping[str, Any]) -> Any:  # noqa: ANN401  as above
    data = file.create_group("data")
    for name, value in attributes.items():
        data.attrs[name] = value
    data.attrs[ABOUT] = json.dumps(about, sort_keys=True)
    return data


def _count(data: Any, total: int) -> None:  # noqa: ANN401  as above
    data.attrs["num_demos"] = len(data)
    data.attrs["total"] = total


def _write_demo(group: Any, demo: Demonstration) -> None:  # noqa: ANN401  as above
    for name in ("actions", "states", "robot_states", "rewards", "dones"):
        value = getattr(demo, name)
        if value is not None:
            group.create_dataset(name, data=value, **PACKED)
    obs = group.create_group("obs")
    for name, value in sorted(demo.obs.items()):
        # A picture is a chunk, so that a reader that wants one frame decompresses one.
        chunks = {"chunks": (1, *value.shape[1:])} if value.dtype == np.uint8 else {}
        obs.create_dataset(name, data=value, **chunks, **PACKED)
    group.attrs["num_samples"] = len(demo)
    group.attrs["model_file"] = demo.model_file
    group.attrs["init_state"] = demo.init_state
    if demo.start is not None:
        write_start(group.create_group("start"), demo.start)
    if demo.hidden is not None:
        write_hidden(group.create_group("hidden"), demo.hidden)
    if demo.truth is not None:
        group.create_dataset("truth", data=demo.truth, **PACKED).attrs["facts"] = json.dumps(demo.facts)
    if demo.origin is not None:
        origin = demo.origin
        group.create_dataset("intended_actions", data=origin.intended, **PACKED)
        for name in ("trial", "seed", "state_index", "success_step", "severity"):
            group.attrs[name] = getattr(origin, name)
        group.attrs["disturbances"] = json.dumps(origin.disturbances, sort_keys=True)
        group.attrs["tries"] = json.dumps(origin.tries, sort_keys=True)
