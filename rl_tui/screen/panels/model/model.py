"""The model of a scenario, ⟨S, A, P, R, γ⟩, and one pair in full.

The notation follows Sutton & Barto, 2nd ed., section 3.1.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import lru_cache
from typing import ClassVar, Final

import numpy as np
from rich.cells import cell_len
from textual.binding import BindingType
from textual.geometry import Size
from textual.strip import Strip

from rl_tui.common.words import counted
from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.draw import names, numbers
from rl_tui.screen.draw.action_order import shown_order, shown_pairs, shown_place
from rl_tui.screen.draw.to_ascii import to_ascii
from rl_tui.screen.kit.bindings import binding
from rl_tui.screen.kit.blocks import BLANK, Block, Labelled, Text, lines_of
from rl_tui.screen.kit.scrolling import Scrolled, ScrolledPanel, page_bindings
from rl_tui.screen.kit.snapshot_facts import hides_means, reward_range
from rl_tui.screen.panels.last_step.update_text import setting
from rl_tui.screen.panels.model.pair import UNKNOWN, action_text, means_key, pair_blocks
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.drawing import Arms
from rl_tui.worlds.mdp.space import FiniteSpace, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP
from rl_tui.worlds.world import World

# The model in words


ALIKE: Final = "none: the agent cannot tell some states apart (not Markov)"
_MANY_NAMES: Final = 100  # two lines never hold more
_LABEL: Final = 9


def model_blocks(snapshot: Snapshot, look: Look) -> Iterator[Block]:
    """Yield the model, and start and end of episodes."""
    world, space, mdp = snapshot.world, snapshot.world.space, snapshot.world.mdp
    others = _without_pairs(space)
    actors = f"; {space.states - len(others):,} with actions" if len(others) else ""
    actions = [action_text(world, action, look) for action in shown_order(world)]
    pairs = counted(space.pairs, "state–action pair")
    reason = ALIKE if world.prospects else UNKNOWN
    parts: dict[str, str | Callable[[int], str]] = {
        "S": lambda room: (
            f"{counted(space.states, 'state')}: {_listed(space.state_names, room, look)}{actors}"
        ),
        "A": lambda room: f"{counted(len(actions), 'action')}: {_listed(actions, room, look)}",
        "P": f"{reason}; {pairs}" if mdp is None else f"{pairs}, {counted(len(mdp.next_state), 'outcome')}",
        "R": reason if mdp is None else _rewards(snapshot, mdp, look),
        "γ": setting(snapshot.agent.hyperparameters.gamma, look.glyphs),
        "start": "drawn by the environment" if mdp is None else lambda room: _start(world, mdp, look, room),
        "end": f"where the environment says so{_time_limit(space)}"
        if mdp is None
        else lambda room: _end(world, mdp, look, room),
    }
    for label, text in parts.items():
        yield Labelled(label, look.palette.strong, _LABEL, Text(text, look.palette.text, "", ""))


# Questions about every state are answered once per world, not in every frame
@lru_cache(maxsize=1)
def _without_pairs(space: FiniteSpace) -> IntArray:
    return np.flatnonzero(np.diff(space.first_pair) == 0)


@lru_cache(maxsize=1)
def _terminal(mdp: TabularMDP) -> IntArray:
    return np.intersect1d(mdp.next_state[mdp.terminated], _without_pairs(mdp))


def _rewards(snapshot: Snapshot, mdp: TabularMDP, look: Look) -> str:
    glyphs = look.glyphs
    rewards, drift = reward_range(mdp), mdp.drift_std
    known = ""
    if rewards.noise:
        deviation = numbers.brief(rewards.noise, glyphs)
        known = f", normally distributed around their mean (standard deviation {deviation})"
    if drift:
        known += f"; after every step each mean moves by a random step of standard deviation {drift:g}"
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
    text = f"terminal {_listed(terminal, room, look)}, of value 0" if terminal else "no state is terminal"
    return text + _time_limit(mdp)


def _time_limit(space: FiniteSpace) -> str:
    truncated = f"; truncated after {space.time_limit:,} steps: the last one still bootstraps"
    return truncated if space.time_limit else ""


def _listed(items: Sequence[str], room: int, look: Look) -> str:
    """Return ``items`` in up to two lines, with the first and the last.

    Semicolons separate names that contain commas.
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


# The panel


WAITING: Final = "the world is being built"


class ModelPanel(ScrolledPanel):
    """⟨S, A, P, R, γ⟩ above one pair, chosen by arrows."""

    BINDINGS: ClassVar[list[BindingType]] = [
        *page_bindings("model"),
        binding("up", "move_state(-1)", "model.up", "Previous state"),
        binding("down", "move_state(1)", "model.down", "Next state"),
        binding("left", "move_action(-1)", "model.left", "Previous action"),
        binding("right", "move_action(1)", "model.right", "Next action"),
    ]
    title = "Model"
    _pair: int | None = None
    _highest = 0  # most rows of a pair so far: the box only grows, to stay calm

    @property
    def pair(self) -> int | None:
        """The displayed pair, or None."""
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

    def get_content_height(self, container: Size, viewport: Size, width: int) -> int:
        """Return the most rows so far."""
        lines = lines_of(self.blocks(self.snapshot, 0), width, self.look)
        self._highest = max(self._highest, len(lines))
        return self._highest

    def redraw(self) -> None:
        """Draw again, and enlarge the box if needed."""
        super().redraw()
        if self.is_attached and self._rows_wanted > self._highest:
            self._highest = self._rows_wanted
            self.refresh(layout=True)

    def picture(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Return the visible part of the model."""
        strips = super().picture(snapshot, width, height)
        if snapshot is not None:
            self.heading = f"Model ⟨S, A, P, R, γ⟩ · {snapshot.recipe.scenario.title}"
        return strips

    def blocks(self, snapshot: Snapshot | None, left_out: int) -> Iterator[Block]:
        """Yield model and pair. The pair comes first if short of space."""
        pair = self.pair
        if snapshot is None or pair is None:
            yield Text(WAITING, self.look.palette.dim)
            return
        parts = model_blocks(snapshot, self.look), pair_blocks(snapshot, pair, self.look)
        above, below = parts[::-1] if left_out else parts
        yield from above
        yield BLANK
        yield from below

    def hints(self, snapshot: Snapshot | None, *, is_scrolled: bool) -> Sequence[str]:
        """Return forms of the keys."""
        pair, close = "↑ ↓: state   ← →: action", "esc: close"
        if not is_scrolled:
            return f"{pair}   {close}", close
        scroll = f"pgup pgdn: scroll   {close}"
        return f"{pair}   {scroll}", scroll, close

    def action_move_state(self, step: int) -> None:
        """Go to the next state with actions. Keep the action if available."""
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
