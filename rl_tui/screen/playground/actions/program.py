"""Special cases of a watched program."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from rl_tui.common.findings import one_line
from rl_tui.live.commands import ChooseTable
from rl_tui.live.program_view import ProgramView
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.screen.board.subject import Subject
from rl_tui.screen.dialogs.form import Candidate, Choice
from rl_tui.screen.keys.action import Action
from rl_tui.screen.keys.playground_keys import DECIDES
from rl_tui.screen.kit.row import PanelRow
from rl_tui.screen.panels.program.words import form_text, table_texts

FIRST_KEYS: Final = "space runs your program, s takes one of its steps"
_LONGEST_NAME: Final = 40
_LONGEST_NEWS: Final = 300
_UNTIL_READ: Final = 15.0


@dataclass(eq=False)
class ProgramActions(Subject):
    """What differs for a watched program."""

    @property
    def program(self) -> ProgramView | None:
        """The watched program, or None for a built-in agent."""
        return None if self.snapshot is None else self.snapshot.program

    def why_not_to_it(self, action: Action) -> str:
        """Return why ``action`` does not suit the program."""
        program = self.program
        if program is None:
            return "this is a built-in agent. Yours: rl-tui watch SCRIPT.py" if action.of_program else ""
        return action.not_for_program.format(file=_file_name(program))

    def in_order_of_help(self, panels: Sequence[PanelRow]) -> Sequence[PanelRow]:
        """Put a program's own panels first."""
        return panels if self.program is None else sorted(panels, key=lambda row: not row.of_program)

    def sets_itself(self) -> bool:
        """Refuse to change a program's settings, and return True."""
        if self.program is not None:
            self.screen.refuse(DECIDES.format(file=_file_name(self.program)))
        return self.program is not None

    def why_not(self, deed: str) -> str:
        """Explain why there is no table to choose."""
        if deed != "choose_table" or self.program is None:
            return ""
        table = self.program.table
        if table is None:
            return "no table was found in your program, so you cannot choose one"
        name = one_line(table.name, _LONGEST_NAME)
        return "" if table.others else f"{name} is the only table of your program"

    def choose_table(self) -> None:
        """Ask which table is Q."""
        table = None if self.program is None else self.program.table
        if table is None:
            return
        names = (table.name, *table.others)
        in_full = table_texts(table)[0].partition(": ")[2]
        forms = (in_full, *map(form_text, table.other_forms))
        candidates = [
            Candidate(str(place), one_line(name, _LONGEST_NAME), (form,))
            for place, (name, form) in enumerate(zip(names, forms, strict=True))
        ]
        choice = Choice(
            "Choose the table that learns. The program then starts again", candidates, "0", self.glyphs
        )
        self.ask(choice, lambda place: self._take_table(names[int(place)]))

    def _take_table(self, name: str) -> None:
        table = None if self.program is None else self.program.table
        if table is not None and (table.name != name or table.other):
            self.link.send(ChooseTable(name))

    def announce(self, before: Snapshot | None, now: Snapshot) -> None:
        """Announce how to start, a changed file, or the end."""
        program, was = now.program, None if before is None else before.program
        if program is None or now.playback.phase is Phase.PREPARING:
            return
        is_first = was is None or (before is not None and before.playback.phase is Phase.PREPARING)
        if is_first and not now.counters.step and not program.ended and not program.refused:
            self.screen.tell(FIRST_KEYS, timeout=_UNTIL_READ)
        if before is not None and not before.counters.step and now.counters.step:
            self.screen.app.clear_notifications()  # the message about the first keys
        if program.reloaded and (was is None or was.reloaded != program.reloaded):
            self.screen.tell(one_line(program.reloaded, _LONGEST_NEWS), timeout=_UNTIL_READ)


def _file_name(program: ProgramView) -> str:
    return one_line(Path(program.path).name or program.title, _LONGEST_NAME)
