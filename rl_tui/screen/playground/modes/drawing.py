"""Draw policy: a person chooses actions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import ClassVar, Final

import numpy as np

from rl_tui.common.words import counted
from rl_tui.live.commands import ClearDrawing, Command, DrawAction, StudyPolicy
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.screen.dialogs.dialog import Confirm
from rl_tui.screen.draw import numbers
from rl_tui.screen.frame.key_line import Hints
from rl_tui.screen.keys.action import Action, Group
from rl_tui.screen.kit.row import POLICIES, WORLD
from rl_tui.screen.kit.snapshot_facts import is_kept_back, shown_by
from rl_tui.screen.panels.arms import ArmsView
from rl_tui.screen.panels.world.shown_policy import AT_RANDOM
from rl_tui.screen.panels.world.view import WorldView
from rl_tui.screen.playground.modes.action_keys import (
    DIGITS,
    action_towards,
    actions_in_a_line,
    acts_in,
    digit_keys,
    digits_in_words,
    has_directions,
)
from rl_tui.screen.playground.modes.mode import LEAVE, STEPS, WITH_SHIFT, KeyMode
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.worlds.drawing import Grid
from rl_tui.worlds.world import World

# Texts on the screen


NOTHING_TO_CHOOSE: Final = "nothing to choose"

_END = "esc: end"
_FIGURE = 8  # cells of a return, as in the table of policies


def title(snapshot: Snapshot, glyphs: Glyphs) -> tuple[str, ...]:
    """Return titles while a policy is drawn."""
    figures = tuple(_figures(snapshot, glyphs))
    if not figures:
        return "You draw a policy", "You draw"
    together = [" · ".join(each) for each in _forms(figures)]
    return (
        f"You draw a policy · {together[0]}",
        *(f"{start} · {each}" for each in together for start in ("You draw", "Drawn")),
        *(f"You draw · {form}" for each in figures for form in each),
        "You draw",
    )


def _forms(figures: Sequence[Sequence[str]]) -> Iterator[tuple[str, ...]]:
    for place in range(max(map(len, figures))):
        yield tuple(each[min(place, len(each) - 1)] for each in figures)


def _figures(snapshot: Snapshot, glyphs: Glyphs) -> Iterator[tuple[str, ...]]:
    world, answers = snapshot.world, snapshot.answers
    if not answers.drawn.choices:
        yield (f"all at random ({AT_RANDOM})", "all at random")
        return
    worth = answers.policies.get(PolicyKind.DRAWN)
    if is_kept_back(snapshot, PolicyKind.DRAWN):
        how = shown_by(snapshot)
        yield (
            f"its return is hidden ({how})",
            f"return hidden ({how})",
            "its return is hidden",
            "return hidden",
        )
    elif worth is not None and worth.expected_return is not None:
        yield (f"return {_amount(worth.expected_return, glyphs)}",)
    elif worth is not None and (worth.is_known or worth.refused):
        yield (f"no return: {worth.refused or 'it may never end'}",)
    left = answers.left_to_chance
    if left is not None and not world.is_bandit:
        yield _left(int(left.sum()))


def _amount(x: float, glyphs: Glyphs) -> str:
    exact = numbers.brief(x, glyphs, decimals=numbers.DECIMALS)
    return exact if len(exact) < _FIGURE - 1 and abs(x) < 1_000.0 else numbers.figure(x, _FIGURE, glyphs)


def _left(count: int) -> tuple[str, ...]:
    if not count:
        return "its path is drawn", "path drawn"
    return (
        f"{counted(count, 'state')} on its path random ({AT_RANDOM})",
        f"{count:,} on its path random ({AT_RANDOM})",
        f"{count:,} at random ({AT_RANDOM})",
        f"{count:,} at random",
        f"{count:,} random",
    )


def prompts(world: World, state: int | None, glyphs: Glyphs) -> tuple[str, ...]:
    """Return the keys for ``state``. None means no choice."""
    if state is None:
        return f"{NOTHING_TO_CHOOSE} here · {_END}", _END
    forms = actions_in_a_line(world, state, glyphs) or (f"{digits_in_words(world, state)}: arm",)
    in_full = (f"{form} · del: undraw · C: clear · {_END}" for form in forms[:2])
    return (*in_full, *(f"{form} · {_END}" for form in forms), *forms, _END)


def hints(world: World) -> Hints:
    """Return the hints for the key line."""
    moves = (("arrows", "cursor"),)
    if world.is_bandit:
        draws: Hints = (("enter", "draw"),)
    elif has_directions(world):
        draws = (("shift+arrow", "draw"),)
    else:
        draws = ()
    return (
        *draws,
        ("digits", "draw"),
        ("esc", "end"),
        ("del", "undraw"),
        ("C", "clear"),
        *moves,
        ("?", "keys"),
    )


# The mode


_DRAWS: Final = {f"{WITH_SHIFT}{key}": step for key, step in STEPS.items()}
_NONE: Final = ("delete", "backspace")
_CLEAR: Final = "C"
_NOTHING_DRAWN: Final = "nothing drawn yet"

POLICY_ACTIONS: Final = tuple(
    Action(f"drawing.{method}", ",".join(keys), label, help_, Group.DRAWING, symbol=symbol)
    for keys, symbol, label, help_, method in (
        ((*_DRAWS, *DIGITS), "shift+arrows 1…0", "draw", "Draw this action under the cursor.", "say_how"),
        (_NONE, "del", "undraw", "Draw no action here.", "draw_nothing"),
        ((_CLEAR,), _CLEAR, "clear", "Clear the drawn policy, after asking.", "ask_to_clear"),
        ((LEAVE,), "esc", "end drawing", "Stop drawing, and keep the policy.", "toggle"),
    )
)
"""The actions while a policy is drawn."""


class PolicyDrawing(KeyMode):
    """The drawing of a policy."""

    keys: ClassVar[Mapping[str, str]] = {
        **{key: each.help for each in POLICY_ACTIONS for key in each.keys},
        "enter": "Draw the arm under the cursor",
    }
    actions = POLICY_ACTIONS
    way_back = (
        "click or tab here to draw again · w p ends it",
        "tab here to draw again · w p ends it",
        "w p ends it",
    )
    _studied_before: PolicyKind | None = None

    def takes(self, key: str) -> bool:
        """Return whether ``key`` draws or leaves."""
        view = self._view
        if view is None:
            return False
        if key in _DRAWS:
            return has_directions(view.world)
        return key in (*DIGITS, *_NONE, _CLEAR, LEAVE) or (key == "enter" and isinstance(view, ArmsView))

    def press(self, key: str) -> None:
        """Draw the key's action at the cursor."""
        view = self._view
        if key == LEAVE:
            self.toggle()
        elif key == _CLEAR:
            self.ask_to_clear()
        elif view is not None and key in _DRAWS:
            self._draw_towards(view, _DRAWS[key])
        elif key in _NONE:
            self.draw_nothing()
        elif isinstance(view, ArmsView) and key == "enter":
            self._draw_arm(view)
        elif view is not None:
            self._draw_numbered(view, key)

    def point(self, step: tuple[int, int] | None) -> None:
        """Draw the action towards a side, or the arm."""
        view = self._view
        if isinstance(view, ArmsView):
            self._draw_arm(view)
        elif view is not None and step is not None and has_directions(view.world):
            self._draw_towards(view, step, moves=False)

    def why_not(self, deed: str) -> str:
        """Explain why no policy can be drawn or cleared."""
        if deed == "ask_to_clear":
            return "" if self._drawn else _NOTHING_DRAWN
        return "" if self.is_on or self.snapshot is None else _refused(self.snapshot.world)

    def toggle(self) -> None:
        """Start or end drawing."""
        snapshot = self.snapshot
        if self.is_on:
            self._end()
            return
        if snapshot is None or snapshot.playback.phase is Phase.PREPARING:
            return
        self._studied_before = None if self._has_panel else self.link.wanted.studied
        self.board.bring_into_view(WORLD)
        self.enter()
        self.link.send(StudyPolicy(PolicyKind.DRAWN))
        view = self.board.world
        if view is not None:
            place = self._first_place(view, snapshot)
            if place is not None:
                view.put_cursor(place)  # stays while the agent goes on
        self.show(snapshot)
        self.screen.tell(_first_words(snapshot.world))

    def leave(self) -> None:
        """Return keys and focus, and keep the policy."""
        if self.is_on:
            super().leave()
            if not self._has_panel:
                self.link.send(StudyPolicy(self._studied_before))
            if self.board.world is not None:
                self.board.world.action_follow()

    def note(self, command: Command) -> None:
        """End drawing if ``command`` shows another policy."""
        if isinstance(command, StudyPolicy) and command.kind not in (None, PolicyKind.DRAWN):
            self._end()

    def _end(self) -> None:
        self.leave()
        self.screen.tell("What you drew is kept. w p: go on drawing.")

    def show(self, snapshot: Snapshot) -> None:
        """Show the drawn policy, and the keys at the cursor."""
        if self.link.wanted.studied is None:
            self.link.send(StudyPolicy(PolicyKind.DRAWN))  # closing a panel has ended it
        view, world, glyphs = self._view, snapshot.world, self.glyphs
        state = None if view is None else self._state_under(view)
        self._write(title(snapshot, glyphs), prompts(world, state, glyphs), hints(world))

    @property
    def _has_panel(self) -> bool:
        return self.board.opened == POLICIES

    @property
    def _view(self) -> WorldView | None:
        focused = self.screen.focused
        return focused if isinstance(focused, WorldView) else None

    def _first_place(self, view: WorldView, snapshot: Snapshot) -> int | None:
        """Return the cursor's last place, else the agent's, else one with a choice."""
        if view.cursor is not None or self._state_under(view) is not None:
            return view.cursor_place
        space = snapshot.world.space
        states = acts_in(snapshot), *np.flatnonzero(np.diff(space.first_pair) > 1)[:1]
        chosen = next(int(each) for each in states if len(space.pairs_of(int(each))) > 1)
        return view.place_of(space.pairs_of(chosen).start)

    def _state_under(self, view: WorldView) -> int | None:
        place = view.cursor_place
        pairs = range(0) if place is None else view.pairs_at(place)
        if not pairs:
            return None
        state = view.world.space.state_of(pairs.start)
        return state if len(view.world.space.pairs_of(state)) > 1 else None

    def _state_to_draw_in(self, view: WorldView) -> int | None:
        state = self._state_under(view)
        if state is None:
            place = view.cursor_place
            is_only_one = place is not None and bool(view.pairs_at(place))
            why = "there is only one action" if is_only_one else "no action is taken here"
            self.screen.tell(f"{NOTHING_TO_CHOOSE}: {why}")
        return state

    def _draw_towards(self, view: WorldView, step: tuple[int, int], *, moves: bool = True) -> None:
        state = self._state_to_draw_in(view)
        if state is None:
            return
        action = action_towards(view.world, state, step)
        if action is None:
            self._tell_no_action(view.world, state, self.glyphs.direction(step))
            return
        self.link.send(DrawAction(state, action))
        if moves:
            view.put_cursor(_likely_cell(view.world, state, action))

    def _draw_numbered(self, view: WorldView, key: str) -> None:
        state = self._state_to_draw_in(view)
        if state is None:
            return
        action = digit_keys(view.world, state).get(key)
        if action is None:
            self._tell_no_action(view.world, state, key)
        else:
            self.link.send(DrawAction(state, action))

    def _draw_arm(self, view: ArmsView) -> None:
        state, place = self._state_to_draw_in(view), view.cursor_place
        if state is not None and place is not None:
            self.link.send(DrawAction(state, int(view.world.space.pair_action[place])))

    def draw_nothing(self) -> None:
        """Draw no action at the cursor."""
        view = self._view
        state = None if view is None else self._state_to_draw_in(view)
        if state is not None:
            self.link.send(DrawAction(state, None))

    def _tell_no_action(self, world: World, state: int, key: str) -> None:
        text = f"{key} is not an action here: draw with {digits_in_words(world, state)}"
        self.screen.tell(text, severity="warning")

    def say_how(self) -> None:
        """Show which keys draw."""
        if self.snapshot is not None:
            self.screen.tell(_first_words(self.snapshot.world))

    @property
    def _drawn(self) -> int:
        return 0 if self.snapshot is None else len(self.snapshot.answers.drawn.choices)

    def ask_to_clear(self) -> None:
        """Clear the drawn policy after a confirmation."""
        if not self._drawn:
            self.screen.refuse(_NOTHING_DRAWN)
            return
        question = f"You have drawn an action in {counted(self._drawn, 'state')}. This cannot be undone."
        self.ask(Confirm("Clear the drawn policy?", question, "clear all", self.glyphs), self._clear)

    def _clear(self, _: bool) -> None:
        self.link.send(ClearDrawing())
        self.screen.tell("Your policy is cleared.")


def _likely_cell(world: World, state: int, action: int) -> int:
    mdp, grid, pair = world.mdp, world.drawing, world.space.pair_of(state, action)
    if mdp is None or pair is None or not isinstance(grid, Grid):
        raise ValueError("only maps with a table have a cell that an action leads to")
    own = mdp.outcomes_of(pair)
    next_states, actions = mdp.next_state[own.start : own.stop], mdp.outcome_action[own.start : own.stop]
    chances = np.bincount(next_states, mdp.probability[own.start : own.stop], minlength=mdp.states)
    likely = chances[next_states] >= chances.max() - 1e-9
    meant = likely & (actions == action)
    chosen = next_states[meant if meant.any() else likely][0]
    return grid.cell_of_state[int(chosen)]


def _refused(world: World) -> str:
    if world.mdp is None:
        return "without a transition table, a drawn policy has no exact return"
    if not (np.diff(world.space.first_pair) > 1).any():
        return "nothing to draw: no state has more than one action"
    return ""


def _first_words(world: World) -> str:
    how = "shift and an arrow, a digit" if has_directions(world) else "a digit"
    return f"Draw: {how}, or two clicks. ? acts at random."
