"""What watches a learner's program and judges it, in a process of its own."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Final

from rl_tui.lab.workers.answering import answer, bound_processor_time

if TYPE_CHECKING:
    from rl_tui.lab.lessons.programs.live_program import ProgramTask

MOST_SECONDS: Final = 300
"""Of a processor, for judging what was seen; the program has limits of its own."""
_TELLS_EVERY: Final = 0.25  # seconds


def main() -> None:
    """Watch the program that stdin names, and end when it is judged or stdin ends, be it in the middle."""
    answer(_work)


def _work(task: ProgramTask, tell: Callable[[dict[str, Any]], None]) -> None:
    bound_processor_time(MOST_SECONDS)
    last = 0.0

    def on_steps(steps: int, episodes: int) -> None:
        nonlocal last
        if time.monotonic() - last > _TELLS_EVERY:
            last = time.monotonic()
            tell({"steps": steps, "episodes": episodes})

    tell(judged_file(task, on_steps))


def judged_file(
    task: ProgramTask, on_steps: Callable[[int, int], None] = lambda steps, episodes: None
) -> dict[str, Any]:
    """Return how the program of ``task`` is judged, as JSON: its code, verdicts and remarks, or a fault.

    ``on_steps`` is called with the steps and episodes that were seen, as they come.
    """
    from rl_tui.common.errors import UserError
    from rl_tui.lab.lessons.judging.conditions import program_verdicts, remarks_on
    from rl_tui.lab.lessons.programs.watching import read_code, watched_code

    try:
        code = read_code(task.path)
    except UserError as fault:
        return {"fault": str(fault)}
    seen = watched_code(code, task.path.name, on_steps)
    verdicts = [list(each) for each in program_verdicts(task.conditions, seen)]
    return {"code": code, "verdicts": verdicts, "remarks": remarks_on(seen)}
