"""Read demonstrations: ours, LIBERO's published files, and files that others derived in the same layout."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path, PurePosixPath
from typing import Any

import numpy as np
from numpy.typing import NDArray

from onto_compiler.problems import OntoError
from onto_compiler.wording import counted
from runtime.worlds.libero.demos.hdf5 import reading
from runtime.worlds.libero.demos.hidden import HiddenStates
from runtime.worlds.libero.demos.records import IMAGES, DemoFile, Demonstration, Origin
from runtime.worlds.libero.demos.snapshot_hdf5 import read_hidden, read_start
from runtime.worlds.libero.demos.write import ABOUT
from runtime.worlds.snapshot import Snapshot

__all__ = ["load", "overview"]

ACTION = 7
_ATTRIBUTES = ("trial", "seed", "state_index", "success_step", "severity", "disturbances", "tries")


def load(path: str | Path, *, images: bool = False) -> DemoFile:
    """The demonstrations of one file, in the order of their numbers; without ``images`` no pictures are read.

    Raises:
        OntoError: ``DEM001`` if the file cannot be read, ``DEM002`` if it is laid out otherwise, ``DEM004``
            without h5py.
    """
    with _data_of(Path(path)) as data:
        demos = tuple(_demo(data, name, str(path), images=images) for name in _names(data, str(path)))
        return _file(data, str(path), demos)


def overview(path: str | Path) -> tuple[DemoFile, tuple[int, ...]]:
    """The file without its demonstrations, and how many steps each has; raises as :func:`load`."""
    with _data_of(Path(path)) as data:
        lengths = [_samples(_group(data, name, str(path)), name, str(path)) for name in _names(data, str(path))]
        return _file(data, str(path), ()), tuple(lengths)


@contextmanager
def _data_of(path: Path) -> Iterator[Any]:
    with reading(path) as file:
        yield _group(file, "data", str(path))


def _names(data: Any, path: str) -> list[str]:  # noqa: ANN401  h5py is untyped
    names = list(data)
    strange = [name for name in names if not (name.startswith("demo_") and name[5:].isdigit())]
    if strange:
        raise _layout(f"`data/{strange[0]}` is no `demo_N`", path)
    if not names:
        raise _layout("the group `data` holds no demonstration", path)
    return sorted(names, key=lambda name: int(name[5:]))


def _file(data: Any, path: str, demos: tuple[Demonstration, ...]) -> DemoFile:  # noqa: ANN401  as above
    attributes = {name: _plain(value) for name, value in data.attrs.items() if name != ABOUT}
    about = _json(data.attrs.get(ABOUT, "{}"), ABOUT, path)
    info = _json(attributes.get("problem_info", "{}"), "problem_info", path)
    bddl = PurePosixPath(str(attributes.get("bddl_file_name", "")).replace("\\", "/"))
    language = info.get("language_instruction", "")
    words = language if isinstance(language, str) else " ".join(map(str, language))
    task = bddl.stem or Path(path).stem.removesuffix("_demo")
    return DemoFile(
        path, bddl.parent.name or Path(path).parent.name, task, words.strip('"'), str(bddl), demos, attributes, about
    )


def _demo(data: Any, name: str, path: str, *, images: bool) -> Demonstration:  # noqa: ANN401  as above
    group = _group(data, name, path)
    count = _samples(group, name, path)
    arrays = {key: _array(group, key, name, path, count) for key in ("states", "actions", "rewards", "dones")}
    if arrays["actions"].ndim != 2 or arrays["actions"].shape[1] != ACTION:
        raise _layout(f"`data/{name}/actions` has the shape {arrays['actions'].shape}, not (n, {ACTION})", path)
    if arrays["states"].ndim != 2:
        raise _layout(f"`data/{name}/states` has the shape {arrays['states'].shape}, not (n, 1 + nq + nv)", path)
    for key in ("states", "actions"):
        if not np.isfinite(arrays[key]).all():
            raise _layout(f"`data/{name}/{key}` holds a number that is not finite", path)
    observed = _group(group, "obs", path)
    pictures = tuple(key for key in observed if key in IMAGES)
    wanted = [key for key in observed if images or key not in IMAGES]
    obs = {key: _array(observed, key, f"{name}/obs", path, count) for key in wanted}
    robot = _array(group, "robot_states", name, path, count) if "robot_states" in group else None
    try:
        start = read_start(group["start"]) if "start" in group else None
        origin = _origin(group) if start is not None and "trial" in group.attrs else None
        hidden = _hidden(group, arrays["states"], start) if "hidden" in group else None
        truth, facts = _truth(group, count) if "truth" in group else (None, ())
    except (KeyError, ValueError, TypeError) as error:
        raise _layout(f"the record of `data/{name}` is damaged: {error}", path) from error
    first = np.asarray(group.attrs.get("init_state", arrays["states"][0]))
    model = str(group.attrs.get("model_file", ""))
    return Demonstration(
        name,
        **arrays,
        obs=obs,
        robot_states=robot,
        init_state=first,
        model_file=model,
        pictures=pictures,
        start=start,
        origin=origin,
        hidden=hidden,
        truth=truth,
        facts=facts,
    )


def _origin(group: Any) -> Origin:  # noqa: ANN401  as above
    values = {name: _plain(group.attrs[name]) for name in _ATTRIBUTES}
    for name in ("disturbances", "tries"):
        values[name] = tuple(json.loads(values[name]))
    return Origin(**values, intended=group["intended_actions"][()])


def _hidden(group: Any, states: NDArray[Any], start: Snapshot | None) -> HiddenStates:  # noqa: ANN401  as above
    if start is None:
        raise ValueError("it has hidden states and no `start`")
    return read_hidden(group["hidden"]).checked(states, start)


def _truth(group: Any, count: int) -> tuple[NDArray[np.bool_], tuple[str, ...]]:  # noqa: ANN401  as above
    truth = group["truth"][()]
    facts = tuple(map(str, json.loads(group["truth"].attrs["facts"])))
    if truth.dtype != np.bool_ or truth.shape != (count, len(facts)):
        raise ValueError(f"`truth` is not of {count} steps and {counted(len(facts), 'fact')}")
    return truth, facts


def _group(parent: Any, key: str, path: str) -> Any:  # noqa: ANN401  as above
    found = parent.get(key)
    if not hasattr(found, "keys"):
        where = f"`{parent.name.strip('/')}` has" if parent.name != "/" else "there is"
        raise _layout(f"{where} no group `{key}`", path)
    return found


def _samples(group: Any, name: str, path: str) -> int:  # noqa: ANN401  as above
    try:
        count = int(group.attrs["num_samples"]) if "num_samples" in group.attrs else len(group["actions"])
    except (KeyError, TypeError, AttributeError) as error:
        raise _layout(f"`data/{name}` has no `actions`", path) from error
    if count < 1:
        raise _layout(f"`data/{name}` has no steps", path)
    return count


def _array(group: Any, key: str, name: str, path: str, count: int) -> NDArray[Any]:  # noqa: ANN401  as above
    if key not in group:
        raise _layout(f"`data/{name}` has no `{key}`", path)
    if getattr(group[key], "shape", ())[:1] != (count,):
        raise _layout(f"`data/{name}/{key}` is not of {count} steps", path)
    found: NDArray[Any] = group[key][()]
    return found


def _json(text: Any, name: str, path: str) -> Mapping[str, Any]:  # noqa: ANN401  as above
    try:
        found = json.loads(text)
    except (TypeError, ValueError) as error:
        raise _layout(f"the attribute `{name}` is no JSON: {error}", path) from error
    if not isinstance(found, dict):
        raise _layout(f"the attribute `{name}` is no JSON object", path)
    return found


def _plain(value: Any) -> Any:  # noqa: ANN401  what h5py gives for an attribute
    if isinstance(value, bytes):
        return value.decode("utf-8", "replace")
    return value.item() if isinstance(value, np.generic) else value


def _layout(message: str, path: str) -> OntoError:
    return OntoError.of("DEM002", message, "the layout of LIBERO's demonstrations is on the page of this code", path)
