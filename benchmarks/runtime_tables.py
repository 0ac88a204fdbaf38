"""The tables of what runs in the simulator: repairs, grounding, demonstrations, and the simulator itself."""

from __future__ import annotations

from collections import Counter
from typing import Any

from benchmarks.grounding import KINDS
from benchmarks.markdown import rate, table
from benchmarks.state_repair import CONTROLS, ENDPOINTS, METHODS, SUITES
from runtime.worlds.robosuite.world import SUITE

__all__ = ["demo_table", "demos_table", "grounding_table", "robosuite_table", "simulator_table", "state_repair_table"]

Result = dict[str, Any]


def demo_table(result: Result) -> str:
    """One line per unmet fact of the demo's tasks."""
    rows = []
    for row in result["rows"]:
        task = (row["task"].replace("_", " "), str(row["attempts"]), "yes" if row["settled"] else "no")
        for found in row["diagnoses"]:
            fact = f"`{found['predicate']}({', '.join(found['arguments'])})`"
            margin = "—" if found["margin"] is None else f"{found['margin']:+.3f} {found['unit']}"
            rows.append((task[0], fact, margin, f"`{found['failure']}`", f"`{found['route']}`", *task[1:]))
            task = ("", "", "")
    m = result["metrics"]
    total = (
        f"{m['accepted']} of {m['tasks']} accepted by the native predicate ({m['initially_true']} before any "
        f"correction), {m['settled']} still true after 20 control steps, {m['wall_s']:.0f} s in all. Mode `state`; "
        "the proposers see privileged simulator state."
    )
    return f"{table(('task', 'unmet fact', 'margin', 'failure', 'route', 'attempts', 'settled'), rows)}\n\n{total}"


def state_repair_table(result: Result) -> str:
    """One line per suite and arm; then one per control, compared with the rules on the states that both were given."""
    m = result["metrics"]
    heads = ("suite", "arm", "episodes", "accepted [95 %]", "one attempt per fact", "attempts", "routes asked")
    rows = []
    for suite in (*SUITES, "all"):
        for method in METHODS:
            name = f"{method}.{suite}"
            if not m[f"{name}.n"]:
                continue
            rows.append(
                (
                    f"`{suite}`" if suite != "all" else "all",
                    f"`{method}`",
                    str(m[f"{name}.n"]),
                    rate(m, f"{name}.accepted"),
                    f"{m[f'{name}.one_attempt_per_fact']:.3f}",
                    f"{m[f'{name}.attempts']:.2f}",
                    f"{m[f'{name}.asked']:.2f}",
                )
            )
    odd = Counter(
        f"`{r['suite']}` {r['task']}" for r in result["rows"] if r["method"] == "typed" and not r.get("premise_holds")
    )
    premises = ", ".join(f"{count} of {task}" for task, count in sorted(odd.items()))
    failed = ", ".join(
        f"{m[f'{method}.all.failed']} of `{method}` ({m[f'{method}.all.failed_without_attempt']} without an attempt)"
        for method in METHODS
    )
    note = (
        f"Without a correction the native predicate holds in {m['typed.all.initially_true']:.1%} of the episodes; "
        f"{m['crashed']} crashed. Not accepted: {failed}. The premise (the declared `:init`, after settling) was "
        f"false in {odd.total()} episodes of `typed`: {premises or 'none'}."
    )
    return f"{table(heads, rows)}\n\n{_controls(m)}\n\n{note}"


def _controls(m: dict[str, float]) -> str:
    """Each control of the routing beside ``typed``: discordant states with their exact p, and what the arms spent."""
    rows = []
    for name, control in ((f"typed_vs_{control}", control) for control in CONTROLS):
        tested = (
            cell
            for endpoint in ENDPOINTS
            for cell in (
                f"{m[f'{name}.{endpoint}.only_typed']} / {m[f'{name}.{endpoint}.only_control']}",
                f"{m[f'{name}.{endpoint}.p']:.2g}",
            )
        )
        spent = (
            f"{m[f'{name}.{count}']:+.2f} [{m[f'{name}.{count}.low']:+.2f}, {m[f'{name}.{count}.high']:+.2f}]"
            for count in ("attempts", "asked")
        )
        rows.append((f"`{control}`", str(m[f"{name}.pairs"]), *tested, *spent))
    heads = (
        *("against `typed`", "states", "accepted: only `typed` / only it", "p (McNemar, Holm)"),
        *("one attempt per fact: only `typed` / only it", "p", "attempts more [95 %]", "routes asked more [95 %]"),
    )
    return table(heads, rows)


def grounding_table(result: Result) -> str:
    """One line per grounding function."""
    m = result["metrics"]
    rows = []
    for kind in KINDS:
        time = m.get(f"all.{kind}.us_per_fact")
        counts = (
            cell for part in ("all", "goal") for cell in (f"{m[f'{part}.{kind}.states']}", _true(m, f"{part}.{kind}"))
        )
        rows.append((f"`{kind}`", *counts, "—" if time is None else f"{time:.0f}"))
    note = (
        f"{m['comparisons']} comparisons in {m['states']} states: {m['mismatches']} differences of truth, "
        f"{m['sign_violations']} margins of the wrong sign. In {m['near_true'] + m['near_false']} cases a term lay "
        f"within 1 mm or 1 mrad of its threshold, {m['near_true']} on the satisfied side and "
        f"{m['near_false']} on the other."
    )
    heads = ("grounded by", "states made for it", "true", "in LIBERO-Goal", "true", "µs a fact")
    return f"{table(heads, rows)}\n\n{note}"


def _true(metrics: dict[str, float], name: str) -> str:
    return f"{metrics[f'{name}.true_share']:.0%}"


def demos_table(result: Result) -> str:
    """One line per suite."""
    m = result["metrics"]
    heads = ("suite", "demonstrations", "trials", "median steps", "replayed natively to success at the same step")
    rows = [
        (
            f"`{suite}`",
            *(f"{m[f'{suite}.{name}']:g}" for name in ("demos", "trials", "median_steps")),
            f"{m[f'{suite}.replayed_share']:.1%}",
        )
        for suite in dict.fromkeys(row["suite"] for row in result["rows"])
    ]
    total = (
        f"{m['demos']} of {m['wanted']} demonstrations of {m['tasks']} tasks; {m['recovered']} hold a recovery from a "
        f"failed try. The largest difference of a replay to a recorded state is {m['drift']:g}."
    )
    return f"{table(heads, rows)}\n\n{total}"


def simulator_table(result: Result) -> str:
    """One line per task; then what has processes of its own."""
    m = result["metrics"]
    heads = (
        *("task", "native steps/s", "exact", "compiled", "bare `mj_step`", "native set-up ms", "set-up ms"),
        *("`check_success` µs", "goal µs", "with margins µs", "largest qpos error"),
    )
    rows = []
    for row in result["rows"]:
        if row["kind"] == "task":
            t = row["timing"]
            rates = (f"{t[f'{name}_steps_s']:.0f}" for name in ("native", "exact", "compiled", "physics"))
            setup = (f"{t['native_setup_ms']:.0f}", f"{t['setup_ms']:.2f}")
            goal = (f"{t['check_success_us']:.1f}", f"{t['grounding_us']:.2f}", f"{t['margins_us']:.0f}")
            rows.append((f"`{row['key']}`", *rates, *setup, *goal, f"{row['parity_max_qpos_error']:.0e}"))
    note = (
        f"Medians over the tasks: the compiled loop takes {m['steps_ratio']:.1f} times as many control steps as the "
        f"native environment, and {m['physics_share']:.0%} of those of bare `mj_step`; a trial is set up "
        f"{m['setup_ratio']:,.0f} times as fast, in {m['setup_ms']:.2f} ms; grounding and diagnosis take "
        f"{m['grounding_share']:.2%} of a control step ({m['margins_share']:.1%} with margins), and "
        f"{m['grounding_vs_native']:.2f} of the time of `check_success`. A new process takes {m['first_step_s']:.2f} s "
        f"to its first step. Two processes scale {m['scaling_2']:.2f} times as well as two of bare `mj_step`. The "
        f"exact loop differs from the native environment by {m['exact_max_qpos_error']:g} in "
        f"{m['exact_steps_compared']:,} control steps, in {m['exact_held_steps']} of which a finger touches the "
        f"object; of {m['success_compared']} verdicts {m['success_mismatches']} differ. Over {m['memory_resets']} "
        f"resets and {m['memory_steps']:,} control steps a process grows by {m['memory_growth_mib']:.1f} MiB, with "
        f"{m['faults']:.0f} faults; {m['repeated_unequal']} repeated runs differ."
    )
    return f"{table(heads, rows)}\n\n{note}"


def robosuite_table(result: Result) -> str:
    """One line per task of the second world."""
    m = result["metrics"]
    counts = ("states", "random", "settled", "threshold", "true_states", "differences", "wrong_signs")
    heads = ("task", *(count.replace("_", " ") for count in counts), "repaired", "settled after it")
    rows = []
    for row in (row for row in result["rows"] if row["kind"] == "states"):
        shares = (f"{m[row['task'] + '.' + share]:.2f}" for share in ("repaired_share", "settled_share"))
        rows.append((f"`{SUITE}/{row['task']}`", *(str(row.get(count, 0)) for count in counts), *shares))
    alone = {fact: count for row in result["rows"] for fact, count in row.get("decided_alone", {}).items()}
    decided = ", ".join(f"`{fact}` in {count}" for fact, count in alone.items())
    left = Counter((r["task"], f["failure"], f["route"]) for r in result["rows"] for f in r.get("failures", ()))
    unmet = "; ".join(f"`{task}` {count} times `{kind}`, route `{way}`" for (task, kind, way), count in left.items())
    note = (
        f"One fact alone was unmet, and decided: {decided}. "
        f"{m['repaired_share']:.0%} of {m['repairs']} initial states were repaired (mode `state`, sees "
        f"`privileged-state`). Left unmet: {unmet or 'nothing'}. {m['crashed']} crashed. Files outside the world's "
        f"folder and its bindings that name its tasks: {m['files_for_a_world']}."
    )
    return f"{table(heads, rows)}\n\n{note}"
