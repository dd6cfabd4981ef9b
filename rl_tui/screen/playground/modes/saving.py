"""Saving the world as a scenario file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Final

from rl_tui.common.errors import UserError
from rl_tui.common.findings import one_line
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.export.scenario_file import ScenarioFile, file_of, offered_name, path_named
from rl_tui.screen.board.subject import Subject
from rl_tui.screen.dialogs.form import Candidate, Choice, Prompt
from rl_tui.screen.frame.message_line import complain, complaining

_OVER: Final = "over"
_ELSEWHERE: Final = "elsewhere"
_LONGEST_NAME: Final = 60
_HINT: Final = "a name, for one of your own scenarios, or a path such as ./my-maze.toml"


@dataclass(eq=False)
class ScenarioSaving(Subject):
    """The dialog that saves the world, and never overwrites the changes of others."""

    _file: ScenarioFile | None = None

    def save(self) -> None:
        """Save the edited world."""
        snapshot = self.snapshot
        if snapshot is None or snapshot.editor.draft is None:
            return
        file = self._file or file_of(snapshot.recipe.scenario)
        try:
            text = file.text_with(snapshot.editor.draft)
        except UserError as reason:
            complain(self.screen.app, f"not saved: {reason}")
            return
        name = str(file.path) if file.path is not None else offered_name(snapshot.recipe.scenario)
        self._ask_name(snapshot, file, text, name)

    def _ask_name(self, snapshot: Snapshot, file: ScenarioFile, text: str, name: str) -> None:
        def read(typed: str) -> str:
            return str(path_named(typed, file))

        def write(chosen: float | str) -> None:
            path = Path(str(chosen))
            if path == file.path and file.has_changed:
                self._ask_over(snapshot, file, text)
            else:
                self._write(file, path, text)

        self.ask(Prompt("Save the world as a scenario", _HINT, name, read, "save"), write)

    def _ask_over(self, snapshot: Snapshot, file: ScenarioFile, text: str) -> None:
        assert file.path is not None
        path = file.path

        def answer(chosen: str) -> None:
            if chosen == _OVER:
                self._write(file, path, text)
            else:
                self._ask_name(snapshot, file, text, offered_name(snapshot.recipe.scenario))

        elsewhere = Candidate(_ELSEWHERE, "under another name", ("That file is not changed.",))
        over = Candidate(_OVER, "over it", ("Changes made there are lost.",))
        name = one_line(path.name, _LONGEST_NAME)
        self.ask(Choice(f"Save: {name} has changed meanwhile", (elsewhere, over), "", self.glyphs), answer)

    def _write(self, file: ScenarioFile, path: Path, text: str) -> None:
        with complaining(self.screen.app):
            self._file = file.written(path, text)
            self.screen.tell(f"saved: {path}")
