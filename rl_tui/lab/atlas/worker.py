"""What works out an atlas in the process of its own."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

from rl_tui.lab.workers.answering import answer, let_others_go_first

if TYPE_CHECKING:
    from rl_tui.lab.atlas.figures import Atlas
    from rl_tui.lab.atlas.request import AtlasRequest

_LONGEST_REASON: Final = 200


def main() -> None:
    """Work out what stdin asks for, and end when that is done or stdin ends, be it in the middle."""
    answer(_work)


def _work(request: AtlasRequest, tell: Callable[[dict[str, Any]], None]) -> None:
    from rl_tui.common.errors import UserError
    from rl_tui.common.findings import one_line
    from rl_tui.lab.atlas.atlas_json import news
    from rl_tui.lab.atlas.figures import Atlas, AtlasState
    from rl_tui.lab.atlas.work import AtlasWork
    from rl_tui.worlds.gym.modules import ALLOWED

    ALLOWED.update(request.modules)
    sent = Atlas()

    def tell_news(atlas: Atlas) -> None:
        nonlocal sent
        is_first = not sent.cells
        tell(news(sent, atlas))
        sent = atlas
        if is_first and atlas.cells and not request.is_awaited:
            let_others_go_first()  # from here on there is something to look at

    try:
        AtlasWork(request, tell_news).run()
    except Exception as error:  # whatever a world may do to this process
        name = "" if isinstance(error, UserError) else f"{type(error).__name__}: "
        why = one_line(f"{name}{error}", _LONGEST_REASON)
        tell(news(sent, replace(sent, state=AtlasState.FAILED, message=why)))
