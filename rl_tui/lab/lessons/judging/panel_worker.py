"""What works out conditions that many seeds decide, in the process of its own."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Final

from rl_tui.lab.workers.answering import answer, bound_processor_time, let_others_go_first

if TYPE_CHECKING:
    from rl_tui.lab.lessons.judging.panel_request import PanelRequest

MOST_SECONDS: Final = 300
"""Of a processor."""
_LONGEST_REASON: Final = 200


def main() -> None:
    """Work out what stdin asks for, and end when that is done or stdin ends, be it in the middle."""
    answer(_work)


def _work(request: PanelRequest, tell: Callable[[dict[str, Any]], None]) -> None:
    from rl_tui.common.errors import UserError
    from rl_tui.common.findings import one_line
    from rl_tui.lab.lessons.judging.seed_panel import worked_out
    from rl_tui.worlds.gym.modules import ALLOWED

    bound_processor_time(MOST_SECONDS)
    ALLOWED.update(request.modules)

    def on_seed(done: int, wanted: int, values: list[float | str | bool | None]) -> None:
        if done == len(request.known) + 1:  # until then it may have waited for machine code
            let_others_go_first()
        tell({"done": done, "wanted": wanted, "values": values})

    try:
        verdicts = worked_out(request.recipe, request.conditions, on_seed, request.known)
        tell({"verdicts": [list(each) for each in verdicts]})
    except Exception as error:  # whatever a world may do to this process
        name = "" if isinstance(error, UserError) else f"{type(error).__name__}: "
        tell({"failed": one_line(f"{name}{error}", _LONGEST_REASON)})
