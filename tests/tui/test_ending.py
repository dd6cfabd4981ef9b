"""What may go wrong while the program ends."""

from __future__ import annotations

from textual.css.query import NoMatches

from rl_tui.tui.app import RlTuiApp
from rl_tui.tui.ending import HUNG_UP


async def test_a_screen_that_opens_while_the_program_ends_is_no_bug() -> None:
    app = RlTuiApp()
    async with app.run_test():
        app.exit(return_code=HUNG_UP)
        app._handle_exception(NoMatches("the widgets go first"))
    assert (app.bug, app.return_code) == (None, HUNG_UP)
