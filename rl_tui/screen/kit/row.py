"""Rows of the panel table."""

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
MODEL: Final = "model"
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
    """A panel's key."""

    key: str
    label: str
    help: str
    old: str = ""
    rank: int | None = None


@dataclass(frozen=True, slots=True)
class PanelRow:
    """One panel: its class (``module:Class``), texts and availability.

    ``opened_by``: closed at first, opens next to the world, or below it in ``wide_rows``. ``is_twofold``: one
    per run. ``not_for_program`` and ``lacks``: why a program or snapshot has nothing to show. ``shows``:
    contents that lessons can hide.
    """

    id: str
    widget: str
    title: str
    help: str
    caption: str = ""
    words: str = ""
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

    @property
    def terms(self) -> tuple[str, ...]:
        """The ids of its ``words`` in the glossary."""
        return tuple(self.words.split())

    def make(self, look: Look, panel_id: str | None = None) -> BoardPanel:
        """Make the panel, hidden if a key opens it."""
        panel: BoardPanel = pkgutil.resolve_name(self.widget)(
            look, id=panel_id or self.id, classes="panel" if self.has_border else None
        )
        panel.caption = self.caption
        if self.opened_by is not None:
            panel.can_focus, panel.display = True, False
        return panel


def beside(panel: str) -> str:
    """Return the second run's panel id."""
    return f"{panel}-beside"
