"""The table of what was made again of each published result."""

from __future__ import annotations

from typing import Any

from benchmarks.markdown import table

__all__ = ["replayed_table"]


def replayed_table(result: dict[str, Any]) -> str:
    """A line for each protocol: how many of its rows were made again, and in how many fields they differ.

    Below it are the fields that were not compared, since they depend on the processor and another one published them.
    """
    rows, names = result["rows"], dict.fromkeys(row["protocol"] for row in result["rows"])
    lines, left_out = (
        [],
        dict.fromkeys(
            f"`{row['protocol']}` `{field}`" for row in rows for field in row.get("of_another_processor", ())
        ),
    )
    for name in names:
        mine = [row for row in rows if row["protocol"] == name]
        crashed = sum("crashed" in row for row in mine)
        counts = (sum(row.get(field, 0) for row in mine) for field in ("rows", "differ"))
        lines.append((f"`{name}`", str(len(mine)), *map(str, counts), str(crashed)))
    found = table(("protocol", "trials", "rows", "differences", "crashed"), lines)
    if left_out:
        found += (
            f"\n\nNot compared, as it depends on the processor and another one published it: {', '.join(left_out)}."
        )
    return found
