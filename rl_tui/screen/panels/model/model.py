"""The model of a scenario, ⟨S, A, P, R, γ⟩, with the outcomes of one state–action pair in full.

The notation follows Sutton & Barto, 2nd ed., section 3.1.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import ClassVar, Final

import numpy as np
from rich.cells import cell_len
from textual import events
from textual.binding import BindingType
from textual.strip import Strip

from rl_tui.common.words import counted
from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.draw import names, numbers
from rl_tui.screen.draw.action_order import shown_order, shown_pairs, shown_place
from rl_tui.screen.draw.canvas import Line, Piece, strips_of, wrapped
from rl_tui.screen.draw.precision import column_figure
from rl_tui.screen.draw.to_ascii import to_ascii
from rl_tui.screen.kit.bindings import binding
from rl_tui.screen.kit.panel import Panel
from rl_tui.screen.kit.scrolling import Scrolled
from rl_tui.screen.kit.snapshot_facts import has_estimates, hides_means, is_secret
from rl_tui.screen.panels.last_step.update_text import setting
from rl_tui.screen.panels.model.bellman import bellman_lines, decimals_of, means_key
from rl_tui.screen.panels.model.outcomes import outcome_lines, prospect_lines
from rl_tui.screen.panels.model.reward_range import reward_range
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.drawing import Arms
from rl_tui.worlds.mdp.space import FiniteSpace, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP
from rl_tui.worlds.world import World

# The model in words


UNKNOWN: Final = "unknown: stepped for real, nobody wrote its table down"
ALIKE: Final = "none: states look alike, so what follows depends on how one came there, not on s and a alone"
_MANY_NAMES: Final = 100  # no two lines hold more
_LABEL: Final = 8


def model_lines(snapshot: Snapshot, look: Look, width: int) -> list[Line]:
    """Return the five parts, the start and the end of episodes."""
    space, mdp = snapshot.world.space, snapshot.world.mdp
    others = _without_pairs(space)
    actors = f"; {space.states - len(others):,} with actions" if len(others) else ""
    room = width - _LABEL - 1
    actions = _actions(snapshot, look)
    pairs = f"{counted(space.pairs, 'legal pair')} (s, a)"
    if mdp is None:
        reason = ALIKE if snapshot.world.prospects else UNKNOWN
        chances, rewards, start = f"{reason}; {pairs}", reason, "drawn by the environment"
        end = "where the environment says so" + _time_limit(space)
    else:
        chances = f"{pairs}, {counted(len(mdp.next_state), 'outcome')}"
        rewards = _rewards(snapshot, mdp, look)
        start, end = _start(snapshot.world, mdp, look, room), _end(snapshot.world, mdp, look, room)
    parts = [
        ("S", f"{counted(space.states, 'state')}: {_listed(space.state_names, room, look)}{actors}"),
        ("A", f"{counted(len(actions), 'action')}: {_listed(actions, room, look)}"),
        ("P", chances),
        ("R", rewards),
        ("γ", setting(snapshot.agent.hyperparameters.gamma, look.glyphs)),
        ("start", start),
        ("end", end),
    ]
    lines: list[Line] = []
    for label, text in parts:
        lines += _labelled(label, text, look, width)
    return lines


# What takes a look at every state is worked out once for the world on screen, not for every frame
@lru_cache(maxsize=1)
def _without_pairs(space: FiniteSpace) -> IntArray:
    return np.flatnonzero(np.diff(space.first_pair) == 0)


@lru_cache(maxsize=1)
def _terminal(mdp: TabularMDP) -> IntArray:
    return np.intersect1d(mdp.next_state[mdp.terminated], _without_pairs(mdp))


def pair_lines(snapshot: Snapshot, pair: int, look: Look, width: int) -> list[Line]:
    """Return the outcomes of ``pair`` and its Bellman optimality equation with numbers put in."""
    world, space, palette, glyphs = snapshot.world, snapshot.world.space, look.palette, look.glyphs
    state, action = space.state_of(pair), int(space.pair_action[pair])
    secret = hides_means(snapshot)
    number = 1 + space.pairs_of(state).start + shown_pairs(world, space.pairs_of(state)).index(pair)
    head: list[Piece] = [
        Piece(" state ", palette.dim),
        Piece(names.with_minus(space.state_names[state], look.glyphs), palette.strong),
        *([Piece(f" ({place})", palette.dim)] if (place := names.place(world, state)) else []),
        Piece("   action ", palette.dim),
        Piece(_action(snapshot, action, look), palette.strong),
        Piece(f"   pair {number:,} of {space.pairs:,}", palette.dim),
    ]
    taken = int(snapshot.agent.visits[pair])
    learned = _learned(snapshot, pair, look) if taken else "not yet visited"
    if taken and not has_estimates(snapshot):
        learned = "not known, no table was found in your program"
    if not snapshot.agent.holds(pair):  # the next snapshot of a large world will have it
        learned = glyphs.ellipsis
    estimate: Line = [
        Piece(f" learned Q({names.pair_name(world, pair, glyphs)}) = ", palette.dim),
        Piece(learned, palette.text),
        Piece(f", taken {counted(taken, 'time')}" if taken else "", palette.dim),
    ]
    unknown: Line = [Piece(f"   {UNKNOWN}", palette.dim)]
    mdp = world.mdp
    without = prospect_lines(world, pair, look) if world.prospects else [unknown]
    return [
        head,
        *(without if mdp is None else outcome_lines(world, mdp, pair, look, secret=secret)),
        estimate,
        [Piece("", palette.text)],
        *bellman_lines(snapshot, pair, look, width),
    ]


def _learned(snapshot: Snapshot, pair: int, look: Look) -> str:
    """Return the estimate of ``pair``, with as many decimals as the exact value shown below it."""
    x, mdp, exact = float(snapshot.agent.q[pair]), snapshot.world.mdp, snapshot.exact_answer.solution
    if mdp is None or exact is None or is_secret(snapshot) or not math.isfinite(x):
        return numbers.value(x, 7, look.glyphs)
    return column_figure(x, decimals_of(mdp, exact, pair), look.glyphs)


def _rewards(snapshot: Snapshot, mdp: TabularMDP, look: Look) -> str:
    glyphs = look.glyphs
    rewards, drift = reward_range(mdp), mdp.drift_std
    known = ""
    if rewards.noise:
        deviation = numbers.brief(rewards.noise, glyphs)
        known = f", normally distributed around their mean (standard deviation {deviation})"
    if drift:
        known += f"; after every step each mean drifts by a normal step of standard deviation {drift:g}"
    if hides_means(snapshot):
        return means_key(snapshot)[0] + known
    low, high = (numbers.brief(each, glyphs, decimals=3) for each in (rewards.low, rewards.high))
    text = f"always {low}" if low == high else f"from {low} to {high}"
    return f"{text}{' at the start' if drift else ''}{known}"


def _start(world: World, mdp: TabularMDP, look: Look, room: int) -> str:
    if len(mdp.start_state) == 1:
        state = int(mdp.start_state[0])
        place = names.place(world, state)
        return names.with_minus(mdp.state_names[state], look.glyphs) + (f" ({place})" if place else "")
    chances = [
        f"{names.state_name(world, int(state), look.glyphs)} with {names.chance(float(p), look.glyphs)}"
        for state, p in zip(mdp.start_state[:20], mdp.start_probability[:20], strict=True)
    ]
    more = ["…"] if len(mdp.start_state) > 20 else []
    return _listed([*chances, *more], room, look)


def _end(world: World, mdp: TabularMDP, look: Look, room: int) -> str:
    if isinstance(world.drawing, Arms):
        return "every pull is an episode of its own"
    reached = _terminal(mdp)
    listed = [*reached[:_MANY_NAMES], *reached[_MANY_NAMES:][-1:]]
    terminal = [names.state_name(world, int(state), look.glyphs) for state in listed]
    text = (
        f"terminal {_listed(terminal, room, look)}: nothing follows an outcome that ends there, worth 0"
        if terminal
        else "no state is terminal"
    )
    return text + _time_limit(mdp)


def _time_limit(space: FiniteSpace) -> str:
    if not space.time_limit:
        return ""
    return (
        f"; after {space.time_limit:,} steps the time limit cuts the episode off, which is no end: "
        "the last step still bootstraps"
    )


def _actions(snapshot: Snapshot, look: Look) -> list[str]:
    return [_action(snapshot, action, look) for action in shown_order(snapshot.world)]


def _action(snapshot: Snapshot, action: int, look: Look) -> str:
    """Return the arrow and the name of ``action``, or its name alone."""
    name = snapshot.world.space.action_names[action]
    arrow = names.action_name(snapshot.world, action, look.glyphs)
    is_direction = names.is_direction(snapshot.world, action)
    return f"{arrow} {name}" if is_direction and arrow != name else name


def _listed(items: Sequence[str], room: int, look: Look) -> str:
    """Return ``items`` separated by commas; the first ones and the last if they take more than two lines.

    Where the names themselves have commas, semicolons keep them apart.
    """
    between = "; " if any("," in item for item in items[:1]) else ", "
    shown: list[str] = []
    taken = 0
    for number, item in enumerate(items):
        taken += cell_len(to_ascii(item, look.glyphs)) + 2
        if taken > 2 * room - 30 and number < len(items) - 1:
            return between.join([*shown, look.glyphs.ellipsis, items[-1]])
        shown.append(item)
    return between.join(shown)


def _labelled(label: str, text: str, look: Look, width: int) -> list[Line]:
    palette = look.palette
    spelled = to_ascii(label, look.glyphs)
    lines: list[Line] = []
    for number, line in enumerate(wrapped(text, max(1, width - _LABEL - 1), palette.text, look)):
        lines.append([Piece(f" {spelled if number == 0 else '':<{_LABEL}}", palette.strong), *line])
    return lines


# The panel


WAITING: Final = "the world is being built"


class ModelPanel(Panel, can_focus=True):
    """⟨S, A, P, R, γ⟩ above one pair: up and down change its state, left and right its action."""

    BINDINGS: ClassVar[list[BindingType]] = [
        binding("up", "move_state(-1)", "model.up", "Previous state"),
        binding("down", "move_state(1)", "model.down", "Next state"),
        binding("left", "move_action(-1)", "model.left", "Previous action"),
        binding("right", "move_action(1)", "model.right", "Next action"),
        binding("pageup", "scroll_by(-1)", "model.page_up", "Scroll up"),
        binding("pagedown", "scroll_by(1)", "model.page_down", "Scroll down"),
    ]

    _pair: int | None = None
    _first = 0
    _lines = 0

    @property
    def pair(self) -> int | None:
        """The pair whose outcomes are shown, None before the first snapshot."""
        if self._pair is None and self.snapshot is not None:
            space, mdp = self.snapshot.world.space, self.snapshot.world.mdp
            start = self.snapshot.counters.state if mdp is None else int(mdp.start_state[0])
            pairs = space.pairs_of(start)
            return shown_pairs(self.snapshot.world, pairs)[0] if pairs else space.pairs - 1
        return self._pair

    def show_pair(self, pair: int) -> None:
        """Show the outcomes of ``pair``."""
        self._pair = pair
        self.redraw()
        if self.snapshot is not None and self.is_attached and not self.snapshot.agent.holds(pair):
            self.post_message(Scrolled())

    def picture(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Return the part of the model that is in view."""
        pair = self.pair
        if snapshot is None or pair is None:
            return strips_of([[Piece(f" {WAITING}", self.look.palette.dim)]], width, height, self.look)
        self.heading = f"Model ⟨S, A, P, R, γ⟩ · {snapshot.recipe.scenario.title}"
        model = model_lines(snapshot, self.look, width)
        one_pair = pair_lines(snapshot, pair, self.look, width)
        blank: Line = [Piece("", self.look.palette.text)]
        lines = [*model, blank, *one_pair]
        if len(lines) > height:  # what the arrows change stays in view
            lines = [*one_pair, blank, *model]
        self._lines = len(lines)
        self._first = max(0, min(self._first, len(lines) - height))
        self.footing = self.fitting(_keys(is_scrolled=len(lines) > height), width)
        return strips_of(lines[self._first :], width, height, self.look)

    def action_move_state(self, step: int) -> None:
        """Go to the next state that owns pairs, ``step`` of them on, keeping the action where it is legal."""
        if self.snapshot is None or self.pair is None:
            return
        world, space = self.snapshot.world, self.snapshot.world.space
        place = shown_place(world, int(space.pair_action[self.pair]))
        state = space.state_of(self.pair) + step
        while 0 <= state < space.states and not len(space.pairs_of(state)):
            state += step
        if 0 <= state < space.states:
            pairs = shown_pairs(world, space.pairs_of(state))
            self.show_pair(
                min(pairs, key=lambda pair: abs(shown_place(world, int(space.pair_action[pair])) - place))
            )

    def action_move_action(self, step: int) -> None:
        """Go to another action of the same state."""
        if self.snapshot is None or self.pair is None:
            return
        space = self.snapshot.world.space
        pairs = shown_pairs(self.snapshot.world, space.pairs_of(space.state_of(self.pair)))
        place = pairs.index(self.pair) + step
        if 0 <= place < len(pairs):
            self.show_pair(pairs[place])

    def action_scroll_by(self, pages: int) -> None:
        """Scroll by so many pages."""
        self._scroll(pages * max(1, self.size.height - 2))

    def on_mouse_scroll_down(self, event: events.MouseScrollDown) -> None:
        """Scroll down by a few lines."""
        event.stop()
        self._scroll(3)

    def on_mouse_scroll_up(self, event: events.MouseScrollUp) -> None:
        """Scroll up by a few lines."""
        event.stop()
        self._scroll(-3)

    def _scroll(self, lines: int) -> None:
        self._first = max(0, min(self._first + lines, self._lines - self.size.height))
        self.redraw()


def _keys(*, is_scrolled: bool) -> list[str]:
    """Return the keys of the panel, longest form first."""
    pair, scroll, close = "↑ ↓: state   ← →: action", "pgup pgdn: scroll", "m: close"
    forms = [(pair, close), (close,)]
    if is_scrolled:
        forms = [(pair, scroll, close), (scroll, close), (close,)]
    return ["   ".join(form) for form in forms]
