"""Edit world: a person changes the world while the agent learns."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from itertools import chain
from typing import Any, ClassVar, Final

from rl_tui.common.errors import UserError
from rl_tui.common.findings import place
from rl_tui.common.words import counted
from rl_tui.live.commands import DrawWorld, HideAnswer, OpenEditor, RedoStroke, UndoStroke
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.live.world_editor import IN_LESSON
from rl_tui.runs.edited_world import edited_draft
from rl_tui.screen.frame.key_line import Hints
from rl_tui.screen.keys.action import Action, Group
from rl_tui.screen.keys.playground_keys import DRAW_PATH
from rl_tui.screen.kit.pointing import PointerStroke, Touched, Wheeled
from rl_tui.screen.kit.row import DRAW, WORLD
from rl_tui.screen.kit.snapshot_facts import is_secret
from rl_tui.screen.panels.controls.slider import Slider
from rl_tui.screen.panels.draw_panel import SheetPressed, ToolCell, ToolSheet
from rl_tui.screen.panels.world.view import WorldView
from rl_tui.screen.playground.modes.action_keys import DIGITS
from rl_tui.screen.playground.modes.arms_tools import ArmsTools
from rl_tui.screen.playground.modes.graph_tools import GraphTools
from rl_tui.screen.playground.modes.map_tools import MapTools
from rl_tui.screen.playground.modes.mode import LEAVE, STEPS, WITH_SHIFT, KeyMode
from rl_tui.screen.playground.modes.rules import Desk, Tool, Toolbox
from rl_tui.screen.playground.modes.saving import ScenarioSaving
from rl_tui.worlds.drawing import Arms, Graph, Grid
from rl_tui.worlds.editing.arms_draft import Draft
from rl_tui.worlds.editing.drafts import refusal, seen_refusal
from rl_tui.worlds.editing.edit import Edit
from rl_tui.worlds.files.scenario import Scenario

# Texts around the world


END: Final = "esc: end"
_MISSING: Final = "nothing"  # "found" in findings about missing parts


def title(snapshot: Snapshot) -> tuple[str, ...]:
    """Return titles during editing."""
    editor = snapshot.editor
    if editor.unfinished:
        first = editor.unfinished[0]
        found = f"no {first.location[-1]}" if first.found == _MISSING else first.found
        why = f"{found}, but {first.expected} is needed" if first.expected else found
        return (
            f"Not a world yet: {why} · the agent continues in the previous world",
            f"Not a world yet: {why}",
            f"Not yet: {found.partition('; ')[0]}",
            f"unfinished: {place(first.location)}",
        )
    notes = []
    if editor.turned:
        notes.append(f"optimal action changed in {counted(len(editor.turned), 'state')}")
    if editor.endless:
        notes.append(f"no path to an end from {counted(len(editor.endless), 'state')}")
    together = " · ".join(notes)
    if not together:
        return "You draw the world", "You draw"
    return f"You draw the world · {together}", f"You draw · {together}", together, *notes, "You draw"


def prompts(snapshot: Snapshot, about: Sequence[str]) -> tuple[str, ...]:
    """Return texts ``about`` the cursor, and how to leave."""
    undo = " · z: undo" if snapshot.editor.can_undo else ""
    return (*(f"{each}{undo} · {END}" for each in about), *(f"{each} · {END}" for each in about), *about, END)


class PendingStrokes:
    """Strokes on their way to the player."""

    def __init__(self) -> None:
        self._sent: list[tuple[int, tuple[Edit, ...]]] = []
        # A draft, the first stroke after it, the number of applied strokes, and their result
        self._drawn: tuple[Draft, int | None, int, Draft] | None = None

    def __bool__(self) -> bool:
        return bool(self._sent)

    def note(self, number: int, edits: Sequence[Edit]) -> None:
        """Remember ``edits``, sent as command ``number``."""
        self._sent.append((number, tuple(edits)))

    def forget(self) -> None:
        """Forget strokes before an undo or redo, which changes others."""
        self._sent.clear()

    def draft(self, snapshot: Snapshot) -> Draft | None:
        """Return the draft with all later strokes, each applied once: a wheel sends hundreds."""
        self._sent = [each for each in self._sent if each[0] > snapshot.playback.handled]
        base = snapshot.editor.draft
        if base is None:
            return None
        first = self._sent[0][0] if self._sent else None
        if self._drawn is None or self._drawn[:2] != (base, first):
            self._drawn = base, first, 0, base
        _, _, count, draft = self._drawn
        try:
            for _, edits in self._sent[count:]:
                draft = edited_draft(draft, edits)
        except UserError:
            return base
        self._drawn = base, first, len(self._sent), draft
        return draft


# The mode


TOOLBOXES: Final[Mapping[type, type[Toolbox[Any]]]] = {Grid: MapTools, Graph: GraphTools, Arms: ArmsTools}
"""The tools for each kind of drawing."""


ALWAYS: Final = (
    Tool("w s", "save…", "Save the world as a scenario file.", lambda editing, _: editing.saving.save()).also(
        why_not=lambda editing, _: "saving is off here: this is a kiosk" if editing.screen.in_kiosk else ""
    ),
    Tool(
        DRAW_PATH[0],
        "tools…",
        "Open the menu of all other tools.",
        lambda editing, _: editing.screen.menus.open(DRAW_PATH[0]),
    ).also(rank=3, hint=(DRAW_PATH[0], "tools")),
    Tool("z", "undo", "Undo the last stroke.", lambda editing, _: editing.undo()).also(
        why_not=lambda editing, desk: "" if editing.can_undo(desk) else "nothing left to undo", rank=4
    ),
    Tool("Z", "redo", "Redo the stroke that you undid.", lambda editing, _: editing.redo()).also(
        why_not=lambda editing, desk: "" if editing.can_redo(desk) else "nothing to redo"
    ),
    Tool(LEAVE, "end drawing", "End drawing, and keep the world.", lambda editing, _: editing.end()).also(
        symbol="esc", rank=7, hint=("esc", "end"), is_told=True
    ),
    Tool(
        DIGITS[0],
        "sliders",
        "Go to a slider of the world.",
        lambda editing, _: editing.go_to_slider(DIGITS[0]),
    ).also(
        symbol="1 2 3",
        why_not=lambda editing, _: "" if editing.board.shows(DRAW) else "the panel Draw is not in view",
        is_told=True,
    ),
)
"""Tools for every kind of world, which belong to the mode."""
_ALONG: Final = {f"{WITH_SHIFT}{key}": step for key, step in STEPS.items()}


def _all_tools() -> Iterator[Tool]:
    return chain(*(each.tools for each in TOOLBOXES.values()), ALWAYS)


class WorldEditing(KeyMode):
    """The editing of the world."""

    keys: ClassVar[Mapping[str, str]] = {
        **{each.key: each.help for each in _all_tools() if not each.is_in_menu},
        **dict.fromkeys(_ALONG, "Paint on the way"),
        **dict.fromkeys(DIGITS, "Go to a slider of the world"),
    }
    way_back = "click or tab here to draw again", "tab here to draw again"
    toolbox: Toolbox[Any] | None = None
    _looked_at: tuple[Scenario, str] | None = None

    @cached_property
    def saving(self) -> ScenarioSaving:
        """The action that saves the world."""
        return ScenarioSaving(self.screen, self.board, self.link)

    @cached_property
    def _pending(self) -> PendingStrokes:
        return PendingStrokes()

    # Available actions

    @property
    def refused(self) -> str:
        """A quickly checked reason against editing, or empty."""
        snapshot = self.snapshot
        if snapshot is None or snapshot.playback.phase is Phase.PREPARING or snapshot.program is not None:
            return ""
        if snapshot.lesson is not None:
            return IN_LESSON
        scenario = snapshot.recipe.scenario
        if self._looked_at is None or self._looked_at[0] is not scenario:
            self._looked_at = scenario, seen_refusal(scenario, snapshot.world)
        return self._looked_at[1]

    def why_not(self, deed: str) -> str:
        """Explain why this world cannot be edited."""
        return self.refused if deed == "toggle" and not self.is_on else ""

    @property
    def offered(self) -> tuple[Hints, ...]:
        """Forms of the first hint."""
        can_begin = self.modes.current is None and isinstance(self.screen.focused, WorldView)
        snapshot = self.snapshot
        if not can_begin or self.refused or snapshot is None or snapshot.program is not None:
            return ()
        return tuple(((" ".join(DRAW_PATH), form),) for form in ("edit the world", "edit"))

    @property
    def actions(self) -> tuple[Action, ...]:
        """The tools as actions."""
        desk = self._hand()
        return tuple(self._action_of(each, desk) for each in self._tools)

    def can_undo(self, desk: Desk[Any]) -> bool:
        """Return whether there may be an undo."""
        return desk.snapshot.editor.can_undo or bool(self._pending)

    def can_redo(self, desk: Desk[Any]) -> bool:
        """Return whether there may be a redo."""
        return desk.snapshot.editor.can_redo or bool(self._pending)

    @property
    def _tools(self) -> tuple[Tool, ...]:
        return () if self.toolbox is None else (*self.toolbox.tools, *ALWAYS)

    def takes(self, key: str) -> bool:
        """Return whether editing handles ``key``."""
        if key in DIGITS:
            return self._slider(key) is not None
        return self.toolbox is not None and (key in _ALONG or self._tool(key) is not None)

    def has_on_a_page(self, key: str) -> bool:
        """Return whether ``key`` works on a slider."""
        focused = self.screen.focused
        is_slider = isinstance(focused, Slider) and not focused.is_typing
        return key in (*DIGITS, "z", "Z") and is_slider and self.board.panel_of(focused) == DRAW

    def _slider(self, key: str) -> Slider | None:
        sliders = self.board.tools.sliders if self.board.shows(DRAW) else ()
        return next((each for number, each in enumerate(sliders, start=1) if str(number) == key), None)

    def _tool(self, name: str) -> Tool | None:
        return next((each for each in self._tools if each.key == name), None)

    def _owner(self, tool: Tool) -> object:
        return self if tool in ALWAYS else self.toolbox

    def _action_of(self, tool: Tool, desk: Desk[Any] | None) -> Action:
        owner = self._owner(tool)
        return Action(
            f"editing.{tool.key}",
            tool.key,
            tool.label,
            tool.help,
            Group.DRAWING,
            symbol=tool.symbol,
            command=f"editing.use({tool.key!r})",
            value="" if desk is None else tool.value(owner, desk),
            refused="" if desk is None else tool.why_not(owner, desk),
        )

    # Actions

    def press(self, key: str) -> None:
        """Do what ``key`` means."""
        if key in _ALONG:
            desk = self._hand()
            if desk is not None and self.toolbox is not None:
                self.toolbox.go_along(desk, _ALONG[key])
                self._show_picked()
        elif key in DIGITS:
            self.go_to_slider(key)
        else:
            self.use(key)

    def go_to_slider(self, key: str) -> None:
        """Focus the world's slider with this digit."""
        slider = self._slider(key)
        if slider is not None:
            slider.focus()

    def use(self, name: str, *, is_clicked: bool = False) -> None:
        """Use a tool, or show why it cannot."""
        desk, tool = self._hand(), self._tool(name)
        if desk is None or tool is None or self.toolbox is None:
            return
        owner = self._owner(tool)
        refused = tool.why_not(owner, desk)
        if refused:
            self.screen.refuse(refused)
            return
        use = tool.click if is_clicked and tool.click is not None else tool.use
        use(owner, desk)
        self._show_picked()

    def draw(self, event: Touched) -> None:
        """Handle an event of the pointer."""
        desk = self._hand()
        if desk is None or self.toolbox is None:
            return
        match event:
            case PointerStroke(places=places):
                self.toolbox.paint(desk, places)
            case Wheeled(place=place, amount=amount):
                self.toolbox.turn(desk, place, amount)
            case SheetPressed(int(line)):
                self.toolbox.choose_line(desk, line)
            case SheetPressed(str(name)):
                self.screen.set_focus(self.board.world)
                self.use(name, is_clicked=True)
        self._show_picked()

    def set_number(self, name: str, value: float | str) -> bool:
        """Set a number, and return whether there is one."""
        desk = self._hand()
        if desk is None or self.toolbox is None or isinstance(value, str):
            return False
        number = next((each for each in self.toolbox.numbers(desk) if each.parameter.name == name), None)
        if number is None:
            return False
        try:
            self._draw(self.toolbox.number_edits(desk, name, value))
        except ValueError as fault:
            self.screen.tell(f"{number.parameter.symbol} stays {number.value:g}: {fault}", severity="warning")
        self._show_picked()
        return True

    def undo(self) -> None:
        """Undo the last stroke."""
        self._pending.forget()
        self.link.send(UndoStroke())

    def redo(self) -> None:
        """Repeat the last undone stroke."""
        self._pending.forget()
        self.link.send(RedoStroke())

    def end(self) -> None:
        """Cancel an unfinished rectangle or jump, else leave."""
        if self.toolbox is not None and not self.toolbox.cancel():
            self._end()

    def toggle(self) -> None:
        """Start or end editing."""
        snapshot = self.snapshot
        if self.is_on:
            self._end()
        elif snapshot is not None and snapshot.playback.phase is not Phase.PREPARING:
            self._begin(snapshot)

    def _begin(self, snapshot: Snapshot) -> None:
        refused = self.refused or refusal(snapshot.recipe.scenario, snapshot.recipe.seed)
        if refused:
            self.screen.refuse(refused)
            return
        if snapshot.world.is_bandit and is_secret(snapshot):
            self.link.send(HideAnswer(is_hidden=False))
            self.screen.tell("The true means are shown now. w h: hide them again.")
        self.toolbox = TOOLBOXES[type(snapshot.world.drawing)]()
        self.board.bring_into_view(WORLD)
        self.link.send(OpenEditor(is_open=True))
        self.board.reshape(is_drawn=True)
        self.enter()
        view = self.board.world
        if view is not None:
            view.is_drawn_on = True
            if view.cursor_place is not None:
                view.put_cursor(view.cursor_place)  # stays while the agent goes on
        self.show(snapshot)

    def leave(self) -> None:
        """Return keys and focus, and keep the edits."""
        if not self.is_on:
            return
        if self.board.panel_of(self.screen.focused) == DRAW:
            self.screen.set_focus(self.board.world)
        super().leave()
        self.toolbox = None
        self._pending.forget()
        self.board.reshape(is_drawn=False)
        self.link.send(OpenEditor(is_open=False))
        view = self.board.world
        if view is not None:
            view.is_drawn_on = False
            view.picked = frozenset()
            view.action_follow()

    def _end(self) -> None:
        self.leave()
        self.screen.tell("The world stays as you edited it. w d: go on editing.")

    # Display

    def show(self, snapshot: Snapshot) -> None:
        """Show the edited world, what it lacks, and the tools."""
        view, box = self.board.world, self.toolbox
        if view is None or box is None:
            return
        if snapshot.world is not view.world:  # the world is drawn first; then this is called again
            self.screen.call_later(self._land, box.place_added(snapshot.world))
            return
        desk = self._hand()
        about = () if desk is None else box.about(desk)
        self._write(title(snapshot), prompts(snapshot, about), self._hints(box))
        if desk is not None:
            self.board.tools.show_sheet(self._sheet(box, desk, about))

    def _hints(self, box: Toolbox[Any]) -> Hints:
        held = box.in_hand
        first = () if held is None else (("", f"{held.shown} {held.word}"),)
        ranked = sorted((each for each in self._tools if each.rank), key=lambda each: each.rank or 0)
        return (*first, *(each.hint or (each.shown, each.label) for each in ranked), ("?", "keys"))

    def _sheet(self, box: Toolbox[Any], desk: Desk[Any], about: tuple[str, ...]) -> ToolSheet:
        held = box.in_hand
        tool = None if held is None else self._tool(held.id)
        advice, does = box.advice(desk), () if tool is None else (tool.help,)
        sentences = (about, advice) if held is None else (advice, about, does)
        return ToolSheet(
            in_hand=held,
            about=tuple(filter(None, sentences)),
            lines=box.lines(desk),
            cells=tuple(self._cell(each, desk) for each in box.tools if each.in_panel),
            of_number=tuple(self._cell(each, desk) for each in box.tools if each.is_of_number),
            numbers=box.numbers(desk),
            rest=tuple(self._cell(each, desk) for each in ALWAYS if each.in_panel),
        )

    def _cell(self, tool: Tool, desk: Desk[Any]) -> ToolCell:
        assert self.toolbox is not None
        held, refused = self.toolbox.in_hand, tool.why_not(self._owner(tool), desk)
        word = self.toolbox.rest if tool.key == DRAW_PATH[0] else tool.label
        is_on = held is not None and held.id == tool.key
        return ToolCell(tool.key, tool.shown, word, is_on, refused, tool.sign)

    def _hand(self) -> Desk[Any] | None:
        view, snapshot = self.board.world, self.snapshot
        draft = None if snapshot is None else self._pending.draft(snapshot)
        if view is None or snapshot is None or draft is None:
            return None
        return Desk(view, snapshot, draft, self.glyphs, self._draw, self.screen.refuse, self.ask)

    def _draw(self, edits: Sequence[Edit]) -> None:
        draft = None if self.snapshot is None else self._pending.draft(self.snapshot)
        if not edits or draft is None:
            return
        try:
            is_new = edited_draft(draft, edits).table != draft.table
        except UserError as fault:
            self.screen.refuse(str(fault))
            return
        if not is_new:  # painted twice: a single undo takes it back
            return
        self.link.send(DrawWorld(tuple(edits)))
        self._pending.note(self.link.wanted.sent, edits)

    def _land(self, place: int | None) -> None:
        view = self.board.world
        if self.is_on and view is not None:
            # without a place it would follow the agent
            stays = view.cursor if place is None else place
            view.put_cursor((view.cursor_place or 0) if stays is None else stays)
        self._show_picked()

    def _show_picked(self) -> None:
        desk = self._hand()
        if self.toolbox is not None and desk is not None:
            desk.view.picked = self.toolbox.picked(desk)
            self.show(desk.snapshot)
