"""What checks a world in a process of its own."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Final

from rl_tui.lab.workers.answering import answer, bound_processor_time

if TYPE_CHECKING:
    from rl_tui.lab.world_check.deep_check import Question

MOST_SECONDS: Final = 300
"""Of a processor. The dearest of the shipped worlds takes a minute where nothing is compiled yet."""


def main() -> None:
    """Work out what stdin asks for, and end when that is done or stdin ends, be it in the middle."""
    answer(_work)


def _work(asked: Question, tell: Callable[[dict[str, Any]], None]) -> None:
    from rl_tui.lab.world_check.deep_check import reports
    from rl_tui.lab.world_check.report import as_json

    bound_processor_time(MOST_SECONDS)
    for report in reports(asked):
        tell(as_json(report))
