"""Opens the atlas around the settings in force, or says why there is none."""

from __future__ import annotations

from collections.abc import Callable

from rl_tui.common.errors import UserError
from rl_tui.lab.atlas.request import surroundings
from rl_tui.lab.run.recipe import Recipe
from rl_tui.tui.screens.atlas.atlas_dialog import AtlasDialog
from rl_tui.tui.screens.playground.actions.subject import Subject

_IN_A_LESSON = "a lesson asks questions of its own: settings are mapped outside of it"


def open_atlas(subject: Subject, take: Callable[[Recipe], None]) -> None:
    """Show how the run of ``subject`` would do with other settings; ``take`` opens the one that is chosen."""
    snapshot, wanted = subject.snapshot, subject.link.wanted
    if snapshot is None:
        return
    if wanted.lesson is not None:
        subject.screen.tell(_IN_A_LESSON, "warning")
        return
    try:
        request = surroundings(
            wanted.recipe,
            snapshot.world,
            is_edited=bool(snapshot.world_changes),
            is_awaited=not subject.link.player.is_automatic,
        )
    except UserError as reason:
        subject.screen.tell(str(reason), "warning")
        return
    subject.ask(AtlasDialog(subject.screen.look, request), take)
