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
CAPTION: Final = "caption"


@dataclass(frozen=True, slots=True)
class OpeningKey:
    """The key that opens a panel and closes it again, with the fields of its action."""

    key: str
    label: str
    help: str
    old: str = ""
    rank: int | None = None


@dataclass(frozen=True, slots=True)
class PanelRow:
    """One panel: the class ``widget``, ``module:Class``, its texts, and when it is there.

    A panel with an ``opened_by`` is closed at first; open, it stands beside the world, or below with at least
    ``wide_rows``. ``terms`` are ids of the glossary. ``is_twofold``: each of two runs has one.
    ``not_for_program`` says why a watched program, in ``{file}``, has nothing to show here, and ``lacks`` the
    same of a snapshot, as a clause. ``shows`` is what a page of a lesson may keep back of it.
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
