"""One HTML file that shows a run: what was unmet, what repaired it, and what the trace answers."""

from runtime.report.write import write_report

__all__ = ["write_report"]
