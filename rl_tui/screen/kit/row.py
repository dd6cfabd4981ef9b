"""What the table of panels is made of: a row each, with its key, its place and its words."""

from __future__ import annotations

import pkgutil
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from rl_tui.screen.theme.look import Look

if TYPE_CHECKING:
    from rl_tui.live.snapshot import Snapshot
    from rl_tui.screen.kit.panel import BoardPanel

WORLD: Final = "world"
TABLE: Final = "table"
CURVE: Final = "curve"
TIMELINE: Final = "timeline"
BUDGET: Final = "budget"
CONTROLS: Final = "controls"
LAST_STEP: Final = "last_step"
MICROSCOPE: Final = "microscope"
MANY_SEEDS: Final = "many_seeds"
DISCOUNT: Final = "discount"
POLICIES: Final = "policies"
WORLD_CHECK: Final = "world_check"
PROGRAM: Final = "program"
FINDINGS: Final = "findings"
OUTPUT: Final = "output"
LESSON: Final = "lesson"
DRAW: Final = "draw"


@dataclass(frozen=True, slots=True)
class OpeningKey:
    """The key that opens a panel and closes it again.

    ``key``, ``label``, ``help``, ``old`` and ``rank`` are those of the action that the key does.
    """

    key: str
    label: str
    help: str
    old: str = ""
    rank: int | None = None


@dataclass(frozen=True, slots=True)
class PanelRow:
    """One panel. ``widget`` names its class, ``module:Class``, imported when a board is made.

    ``title`` and ``help`` explain it in the help. A panel with an ``opened_by`` is closed at first. Open,
    it has the right column beside the world; with ``wide_rows`` at least these rows of the whole width
    below world and table if they fit. ``caption`` says in some five words what the panel is, and ``terms``
    are the ids of the terms of the glossary that it is about, what is asked first before the rest. With
    ``is_twofold`` each of two lanes side by side has one; :func:`beside` is the id of the second. A panel
    ``of_program`` has something to show only while somebody's own program is watched; ``not_for_program``
    says why one has nothing to show of it then, and what to do instead, with ``{file}`` for the program's
    file. One ``of_lesson`` is there only beside a lesson, one ``of_drawing`` only while a person draws the
    world. ``shows`` is what a page of a lesson may keep back of it, and ``lacks`` says why it has nothing
    to show of a snapshot, as a clause.
    """

    id: str
    widget: str
    title: str
    help: str
    caption: str = ""
    terms: tuple[str, ...] = ()
    opened_by: OpeningKey | None = None
    wide_rows: int = 0
    has_border: bool = True
    is_twofold: bool = False
    of_program: bool = False
    not_for_program: str = ""
    of_lesson: bool = False
    of_drawing: bool = False
    shows: tuple[str, ...] = ()
    lacks: Callable[[Snapshot], str] = lambda _: ""

    def make(self, look: Look, panel_id: str | None = None) -> BoardPanel:
        """Return the panel, hidden if a key opens it; ``panel_id`` is its id, None: that of the row."""
        panel: BoardPanel = pkgutil.resolve_name(self.widget)(
            look, id=panel_id or self.id, classes="panel" if self.has_border else None
        )
        panel.caption = self.caption
        if self.opened_by is not None:
            panel.can_focus, panel.display = True, False
        return panel


def beside(panel: str) -> str:
    """Return the id of the panel that shows of a second lane what ``panel`` shows of the first."""
    return f"{panel}-beside"
