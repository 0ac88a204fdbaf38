"""Do the published figures still hold? A sample of their rows is made again on the present tree and compared.

A trial is run by its own protocol, in an empty working folder, so that nothing is taken from an earlier run. Every
published field of its rows is compared to the last digit, but for what the protocol says is timed, or follows from the
ontology of the tree. What it says depends on the processor is compared where the same one published it. Fields that are
not compared for that, or since they were added later, are named.
"""

from __future__ import annotations

import contextlib
import json
import random
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from itertools import zip_longest
from pathlib import Path
from typing import Any

from benchmarks.archives import CACHE
from benchmarks.engine import run_trial
from benchmarks.protocol import Protocol, Row, Trial, load_protocols, protocol_named, untimed
from benchmarks.results import RESULTS, processors, processors_of, read_result

__all__ = ["REPLAY", "compared", "sampled", "trials_of"]

SEED = 0
CHEAP = 5.0  # seconds, as published, of a trial of the small sample
BUDGET = 40.0  # seconds, as published, of all trials of one protocol in the full sample
MOST = 12  # trials of one protocol
SHOWN = 5  # differences that a row names; all are counted
# What a trial's published seconds do not say: with these fields it takes minutes, or another version of MuJoCo.
_COSTLY: Mapping[str, tuple[str, ...]] = {"audit_versions": ("other",), "world_model_libero": ("count",)}


def trials(full: bool) -> list[Trial]:  # noqa: FBT001 - the protocol's signature
    """A sample of each published result's trials; small: one that is cheap, of each protocol that has one."""
    others = [protocol for protocol in load_protocols().values() if protocol.name != REPLAY.name]
    return [trial for protocol in others for trial in trials_of(protocol, full=full)]


def trials_of(protocol: Protocol, *, full: bool) -> list[Trial]:
    """The trials of ``protocol`` that are replayed: none where it has no published result, or needs a folder."""
    if protocol.of_folder is not None or not (RESULTS / protocol.file).exists():
        return []
    return [
        {"key": f"{protocol.name} {trial['key']}", "protocol": protocol.name, "trial": dict(trial)}
        for trial in sampled(protocol, _published(protocol.name), full=full)
    ]


def sampled(protocol: Protocol, published: Mapping[str, Sequence[Row]], *, full: bool) -> list[Trial]:
    """Trials of ``protocol`` whose rows are ``published``, drawn with the protocol's name as the seed.

    The full sample takes what :data:`BUDGET` and :data:`MOST` allow, and at least the cheapest trial; a protocol's arms
    are taken in turn, each at least once if it has a trial of the small sample.
    """
    known = {trial["key"]: trial for trial in protocol.trials(True)} if published else {}
    seconds = {key: float(rows[0]["seconds"]) for key, rows in published.items() if key in known}
    fields = _COSTLY.get(protocol.name, ())
    costly = {key for key in seconds if any(known[key].get(name) for name in fields)}
    order = sorted(seconds)
    random.Random(f"{SEED} {protocol.name}").shuffle(order)  # noqa: S311 - a sample, no secret
    if not full:
        cheap = [key for key in order if seconds[key] <= CHEAP and key not in costly]
        return [known[key] for key in cheap[:1]]
    arm = {key: str(known[key].get(protocol.arms, "")) for key in order}
    most = max(MOST, len(set(arm.values())))
    chosen: list[str] = []
    for key in _in_turn(order, arm):
        fits = sum(seconds[each] for each in (*chosen, key)) <= BUDGET
        first = seconds[key] <= CHEAP and arm[key] not in {arm[each] for each in chosen}
        if len(chosen) < most and key not in costly and (fits or first):
            chosen.append(key)
    cheapest = sorted(seconds, key=lambda key: (key in costly, seconds[key]))
    return [known[key] for key in chosen or cheapest[:1]]


def _in_turn(keys: Sequence[str], arm: Mapping[str, str]) -> Iterator[str]:
    """``keys``, one of each arm after the other, in their order within the arm."""
    by_arm: dict[str, list[str]] = {}
    for key in keys:
        by_arm.setdefault(arm[key], []).append(key)
    for turn in zip_longest(*by_arm.values()):
        yield from (key for key in turn if key is not None)


def run(trial: Trial) -> list[Row]:
    """One row: how many rows were made again, in how many fields they differ, and in which."""
    protocol = protocol_named(trial["protocol"])
    before = _published(protocol.name)[trial["trial"]["key"]]
    with _empty_folder():
        after = run_trial(protocol, trial["trial"])
    elsewhere = frozenset() if _published_here(protocol, trial["trial"]) else protocol.of_processor
    old, new = (_comparable(protocol, rows, elsewhere) for rows in (before, json.loads(json.dumps(after))))
    found = list(compared(old, new))
    figures = {
        "rows": len(before),
        "differ": len(found),
        "differences": found[:SHOWN],
        "added": sorted({name for one, other in zip(old, new, strict=False) for name in added_fields(one, other)}),
        "of_another_processor": sorted(elsewhere & {name for row in before for name in row}),
    }
    return [{"mode": "none", "sees": "none", **figures}]


def _published_here(protocol: Protocol, trial: Trial) -> bool:
    """Whether the rows of ``trial`` are known to be published on the processor that runs this."""
    found = processors_of(_record(protocol.name), trial.get(protocol.parts, ""))
    return bool(found) and found.items() <= processors().items()


def _comparable(protocol: Protocol, rows: Sequence[Row], elsewhere: frozenset[str]) -> list[Row]:
    left_out = protocol.of_tree | elsewhere
    return [{name: value for name, value in row.items() if name not in left_out} for row in untimed(protocol, rows)]


def added_fields(old: Any, new: Any, path: str = "") -> Iterator[str]:  # noqa: ANN401 - JSON
    """The paths of fields that ``new`` has and ``old`` lacks."""
    if isinstance(old, dict) and isinstance(new, dict):
        for name, value in new.items():
            here = f"{path}.{name}" if path else name
            if name in old:
                yield from added_fields(old[name], value, here)
            else:
                yield here
    elif isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        for one, other in zip(old, new, strict=True):
            yield from added_fields(one, other, f"{path}[]")


def _same(old: Any, new: Any) -> bool:  # noqa: ANN401 - JSON
    """Whether ``new`` has all that ``old`` has, and the same; fields that were added aside."""
    if isinstance(old, dict) and isinstance(new, dict):
        return all(name in new and _same(value, new[name]) for name, value in old.items())
    if isinstance(old, list) and isinstance(new, list):
        return len(old) == len(new) and all(map(_same, old, new))
    return type(old) is type(new) and bool(old == new)


def compared(before: Sequence[Row], after: Sequence[Row]) -> Iterator[Mapping[str, Any]]:
    """Each published field in which two runs' rows differ, by the row's number; a missing row is named as well."""
    if len(before) != len(after):
        yield {"row": min(len(before), len(after)), "field": "rows", "published": len(before), "now": len(after)}
    for number, (old, new) in enumerate(zip(before, after, strict=False)):
        if "crashed" in new and "crashed" not in old:
            yield {"row": number, "field": "crashed", "published": None, "now": new["crashed"]}
            continue
        for name, value in old.items():
            if name not in new or not _same(value, new[name]):
                yield {"row": number, "field": name, "published": value, "now": new.get(name)}


def metrics(rows: Sequence[Row]) -> Mapping[str, float]:
    """How much was made again, and what differed."""
    whole = [row for row in rows if "crashed" not in row]
    return {
        "protocols": len({row["protocol"] for row in whole}),
        "trials": len(whole),
        "rows": sum(row["rows"] for row in whole),
        "differences": sum(row["differ"] for row in whole),
        "added_fields": len({(row["protocol"], name) for row in whole for name in row["added"]}),
        "crashed": len(rows) - len(whole),
    }


@lru_cache(maxsize=2)
def _published(name: str) -> Mapping[str, Sequence[Row]]:
    """The rows of a protocol's published result by the key of their trial."""
    found: dict[str, list[Row]] = {}
    for row in _record(name)["rows"]:
        found.setdefault(row["key"], []).append(row)
    return found


@lru_cache(maxsize=2)
def _record(name: str) -> Mapping[str, Any]:
    return read_result(RESULTS / protocol_named(name).file)


@contextlib.contextmanager
def _empty_folder() -> Iterator[None]:
    """Work in a folder that has nothing but the archives that were downloaded."""
    archives = CACHE.resolve()
    with tempfile.TemporaryDirectory() as folder:
        if archives.is_dir():
            place = Path(folder) / CACHE
            place.parent.mkdir(parents=True)
            place.symlink_to(archives)
        with contextlib.chdir(folder):
            yield


REPLAY = Protocol(
    name="replay",
    help="a sample of every protocol's published rows, made again and compared to the last digit",
    seeds=(SEED,),
    trials=trials,
    run=run,
    metrics=metrics,
    parts="protocol",
    result="replayed",
)
