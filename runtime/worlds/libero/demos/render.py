"""The text output of ``onto demos``."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from statistics import median
from typing import Any

from onto_compiler.wording import counted
from runtime.worlds.libero.demos.collect import Collected
from runtime.worlds.libero.demos.records import DemoFile, Demonstration
from runtime.worlds.libero.demos.replay import DemoReplay

__all__ = ["collected_text", "file_record", "file_text", "replays_text"]


def collected_text(found: Sequence[Collected]) -> str:
    """A line for each task, and a sum."""
    lines = []
    for one in found:
        why = ", ".join(f"{count} {reason}" for reason, count in sorted(one.rejected.items()))
        tail = f"; rejected: {why}" if why else ""
        lines.append(
            f"{one.suite}/{one.index} {one.task}: {one.demos} of {one.wanted} in {counted(one.trials, 'trial')}{tail}"
        )
        lines += [f"  {one.path}"] if one.demos else []
    short = sum(one.short for one in found)
    total = f"{counted(sum(one.demos for one in found), 'demonstration')} of {counted(len(found), 'task')}"
    return "\n".join([*lines, total + (f"; {counted(short, 'task')} with fewer than wanted" if short else "")]) + "\n"


def replays_text(replays: Sequence[DemoReplay]) -> str:
    """A line for each file, one for each demonstration that went otherwise, and a sum."""
    lines = []
    for file in dict.fromkeys(one.file for one in replays):
        own = [one for one in replays if one.file == file]
        good = sum(one.same for one in own)
        drift = max(one.drift for one in own)
        lines.append(f"{own[0].suite}/{own[0].task}: {good} of {len(own)} replayed; largest drift {drift:.2g}")
        lines += [f"  {one.demo}: {_other(one)}" for one in own if not one.same]
    good = sum(one.same for one in replays)
    flat = sum(not one.whole for one in replays)
    lost = sum(not one.placed for one in replays)
    notes = [f"; {flat} from LIBERO's flat state"] if flat else []
    notes += [f"; of {lost} nothing says where fixtures stood, and seed 0 is assumed"] if lost else []
    return "\n".join([*lines, f"{good} of {len(replays)} demonstrations replayed natively{''.join(notes)}"]) + "\n"


def _other(one: DemoReplay) -> str:
    if not one.reached:
        return f"no success in {one.steps} steps" + (f", recorded at {one.recorded}" if one.recorded else "")
    if one.reached != one.recorded:
        return f"success at step {one.reached}, recorded at {one.recorded}"
    return f"success at step {one.reached}, undone afterwards"


def file_record(file: DemoFile) -> dict[str, Any]:
    """What a file holds, as JSON has it."""
    return {
        "file": file.path,
        "suite": file.suite,
        "task": file.task,
        "language": file.language,
        "rejected": len(file.about.get("rejected", {})),
        "spec": file.about.get("spec"),
        "demos": [_demo_record(demo) for demo in file.demos],
    }


def _demo_record(demo: Demonstration) -> dict[str, Any]:
    record: dict[str, Any] = {
        "demo": demo.name,
        "steps": len(demo),
        "state_size": demo.states.shape[1],
        "images": list(demo.pictures),
        "window_record": demo.start is not None,
        "hidden_states": demo.hidden is not None,
        "facts": list(demo.facts),
        "onset": demo.onset,
    }
    if (origin := demo.origin) is not None:
        names = ("trial", "seed", "state_index", "success_step", "severity", "disturbances", "tries")
        record |= {name: getattr(origin, name) for name in names}
    return record


def file_text(record: Mapping[str, Any]) -> str:
    """The same for people."""
    demos = record["demos"]
    steps = [demo["steps"] for demo in demos]
    length = counted(steps[0], "step")
    if len(steps) > 1:
        length = f"{min(steps)} to {max(steps)} steps (median {median(steps):g})"
    whole, hidden = (sum(demo[key] for demo in demos) for key in ("window_record", "hidden_states"))
    pictures = sum(bool(demo["images"]) for demo in demos)
    lines = [
        f"{record['suite']}/{record['task']}: {record['language']}",
        f"  {counted(len(demos), 'demonstration')} of {length}",
        f"  {whole} with a window record, {hidden} with the hidden state of every step, {pictures} with pictures",
    ]
    lines += [f"  {demo['demo']}: {demo['steps']} steps{_made(demo)}" for demo in demos]
    return "\n".join(lines) + "\n"


def _made(demo: Mapping[str, Any]) -> str:
    if "trial" not in demo:
        return ""
    kinds = Counter(one["kind"] for one in demo["disturbances"])
    words = ", ".join(f"{count} {kind}" if count > 1 else kind for kind, count in kinds.items()) or "undisturbed"
    failed = sum(one["outcome"] != "held" for one in demo["tries"])
    again = f", {counted(failed, 'failed try', 'failed tries')}" if failed else ""
    start = f"state {demo['state_index']}, severity {demo['severity']:.2f}"
    lasting = "" if demo["onset"] in {None, demo["success_step"]} else f", for good at {demo['onset']}"
    return f", success at {demo['success_step']}{lasting}; {start}: {words}{again}"
