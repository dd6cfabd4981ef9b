"""An MDP as nodes and edges, drawn or as a list.

Rewards on edges are r(s, a, s′) (Sutton & Barto, 2nd ed., equation 3.6).
"""

from __future__ import annotations

from collections.abc import Sequence, Set
from dataclasses import dataclass, replace
from typing import Final, NamedTuple

from rich.style import Style

from rl_tui.live.pace.until import Breakpoints
from rl_tui.live.world_editor import EditorView
from rl_tui.screen.draw.canvas import Canvas
from rl_tui.screen.draw.names import DEPENDS
from rl_tui.screen.draw.number_form import NumberForm
from rl_tui.screen.kit.pointing import NOWHERE
from rl_tui.screen.panels.world.edit_marks import marks_of
from rl_tui.screen.panels.world.shown_policy import StateValues
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.drawing import Graph
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP
from rl_tui.worlds.world import Prospect, World

# Nodes and edges


_LIKELY: Final = 0.5
_LEAST_BUNDLE: Final = 3  # edges


class Node(NamedTuple):
    """A state."""

    name: str
    column: int
    row: int
    terminal: bool


class GraphBranch(NamedTuple):
    """One outcome. An unknown ``probability`` is None."""

    target: int
    probability: float | None
    label: str


class GraphAction(NamedTuple):
    """One pair, its branches likeliest first. A bundle has more ``pairs``."""

    pair: int
    source: int
    name: str
    label: str
    branches: tuple[GraphBranch, ...]
    pairs: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class GraphShape:
    """Labelled states and pairs."""

    nodes: tuple[Node, ...]
    actions: tuple[GraphAction, ...]

    def pairs_of(self, state: int) -> set[int]:
        """Return the pairs of ``state``."""
        return {action.pair for action in self.actions if action.source == state}

    def bundled(self) -> GraphShape:
        """Join actions that differ only by name."""
        bundles: dict[tuple[int, tuple[GraphBranch, ...], str], list[GraphAction]] = {}
        for action in self.actions:
            rewards = action.label.removeprefix(action.name)
            bundles.setdefault((action.source, action.branches, rewards), []).append(action)
        actions = []
        for (*_, rewards), each in bundles.items():
            if len(each) < _LEAST_BUNDLE:
                actions += each
            else:
                label, pairs = f"{len(each)} actions{rewards}", tuple(action.pair for action in each)
                actions.append(each[0]._replace(label=label, pairs=pairs))
        return replace(self, actions=tuple(actions))

    def marked(self, pairs: Set[int]) -> frozenset[int]:
        """Return the actions with one of ``pairs``."""
        return frozenset(each.pair for each in self.actions if not pairs.isdisjoint((each.pair, *each.pairs)))


class Signs(NamedTuple):
    """The marks on a graph. ``differing`` states have other greedy actions in the second run."""

    agent: int
    cursor: int | None
    breakpoints: Breakpoints
    differing: frozenset[int]
    editor: EditorView
    subject: range = NOWHERE
    next_states: frozenset[int] = frozenset()


class GraphScene(NamedTuple):
    """The ``values`` and ``signs`` of a graph."""

    values: StateValues
    form: NumberForm
    signs: Signs


def graph_shape(world: World, graph: Graph, glyphs: Glyphs, *, is_kept: bool = False) -> GraphShape:
    """Return the shape. ``is_kept`` hides probabilities."""
    space, mdp = world.space, world.mdp
    places = zip(space.state_names, on_grid(graph.places), strict=True)
    nodes = tuple(
        Node(glyphs.spelled(name), *place, not space.pairs_of(state))
        for state, (name, place) in enumerate(places)
    )
    actions = tuple(
        graph_action(
            glyphs.spelled(space.action_names[int(space.pair_action[pair])]),
            state,
            pair,
            world.prospects[pair] if mdp is None else _prospects(mdp, pair, is_kept=is_kept),
            glyphs,
        )
        for state in range(space.states)
        for pair in space.pairs_of(state)
    )
    return GraphShape(nodes, actions)


def on_grid(places: Sequence[tuple[int, int]]) -> list[tuple[int, int]]:
    """Drop empty columns and rows."""
    columns = sorted({column for column, _ in places})
    rows = sorted({row for _, row in places})
    return [(columns.index(column), rows.index(row)) for column, row in places]


def _prospects(mdp: TabularMDP, pair: int, *, is_kept: bool) -> tuple[Prospect, ...]:
    probabilities: dict[int, float] = {}
    rewards: dict[int, float] = {}
    for outcome in mdp.outcomes_of(pair):
        target, probability = int(mdp.next_state[outcome]), float(mdp.probability[outcome])
        probabilities[target] = probabilities.get(target, 0.0) + probability
        rewards[target] = rewards.get(target, 0.0) + probability * float(mdp.reward[outcome])
    means = {target: (rewards[target] / chance,) for target, chance in probabilities.items()}
    if is_kept:
        return tuple(Prospect(target, None, means[target]) for target in sorted(means))
    return tuple(Prospect(target, chance, means[target]) for target, chance in probabilities.items())


def graph_action(
    name: str, state: int, pair: int, prospects: Sequence[Prospect], glyphs: Glyphs
) -> GraphAction:
    """Label an action with rewards and probabilities."""
    texts = {each.next_state: _rewards_text(each.rewards, glyphs) for each in prospects}
    targets = sorted(prospects, key=lambda each: -(each.probability or _LIKELY))
    if len(set(texts.values())) == 1:
        label = f"{name} {texts[targets[0].next_state]}"
        texts = dict.fromkeys(texts, "")
    else:
        label = name
    branches = []
    for each in targets:
        reward = texts[each.next_state]
        if each.probability is not None:
            chance = probability_text(each.probability)
        else:
            chance = f"chance {DEPENDS}" if reward else DEPENDS
        said = f"{chance} {reward}".strip() if len(targets) > 1 else ""
        branches.append(GraphBranch(each.next_state, each.probability, said))
    return GraphAction(pair, state, name, label, tuple(branches))


def _rewards_text(rewards: Sequence[float], glyphs: Glyphs) -> str:
    texts = [reward_text(reward, glyphs) for reward in rewards]
    return (" or " if len(texts) == 2 else " to ").join(dict.fromkeys((texts[0], texts[-1])))


def reward_text(reward: float, glyphs: Glyphs) -> str:
    """Write three digits and the sign."""
    return f"{reward:+.3g}".replace("-", glyphs.minus) if reward else "0"


def probability_text(probability: float) -> str:
    """Write two decimals, near 0 and 1 more."""
    for decimals in (2, 3, 4, 5):
        rounded = round(probability, decimals)
        if 0.0 < rounded < 1.0 and abs(rounded - probability) < 0.02 * min(probability, 1.0 - probability):
            return f"{rounded:.{decimals}f}".strip("0")
    return "1" if probability > 0.5 else f"{probability:.0e}"


# The edges as text


_VALUE_WIDTH: Final = 6
END: Final = "end"
"""The value of a terminal state."""
_LEAST_TEXT: Final = 20  # characters of an edge: narrower panels omit names, or values below the names


class ListLine(NamedTuple):
    """``branches`` of an action, or none. ``row`` counts the state's lines."""

    state: int
    row: int
    action: GraphAction | None = None
    branches: tuple[GraphBranch, ...] = ()


class EdgeList:
    """The edges as text."""

    def __init__(self, shape: GraphShape, width: int) -> None:
        self._shape, self._width = shape.bundled(), width
        self._names = max((len(shape.nodes[action.source].name) for action in shape.actions), default=0)
        self._is_wide = width >= self._names + _VALUE_WIDTH + 3 + _LEAST_TEXT
        below = max(self._names, _VALUE_WIDTH)
        self._is_stacked = not self._is_wide and width >= below + 2 + _LEAST_TEXT
        self._block = self._names if self._is_wide else below
        self._x = 1 + (self._block + 1) * self._has_names + (_VALUE_WIDTH + 1) * self._is_wide
        self.lines = [line for state in range(len(shape.nodes)) for line in self._lines_of(state)]

    @property
    def _has_names(self) -> bool:
        return self._is_wide or self._is_stacked

    def _lines_of(self, state: int) -> list[ListLine]:
        actions = [action for action in self._shape.actions if action.source == state]
        parts: list[tuple[GraphAction | None, tuple[GraphBranch, ...]]] = []
        for action in actions:
            is_short = len(self._text(action, action.branches)) <= self._width - self._x
            parts += (
                [(action, action.branches)] if is_short else [(action, (each,)) for each in action.branches]
            )
        least = 2 if self._is_stacked and actions else int(self._has_names)
        parts += [(None, ())] * (least - len(parts))
        return [ListLine(state, row, *part) for row, part in enumerate(parts)]

    def _text(
        self, action: GraphAction, branches: Sequence[GraphBranch], line: str = "-", head: str = ">"
    ) -> str:
        """Return ``─study −2─▶ Pass .8 / Class .2``, closer if too long."""
        is_first = action.branches[0] in branches
        label = f"{line}{action.label}" if is_first else " " * (1 + len(action.label))
        targets = [f"{self._shape.nodes[each.target].name} {each.label}".strip() for each in branches]
        text = f"{label}{line}{head} {' / '.join(targets)}"
        return text if len(text) <= self._width - self._x else f"{label}{head}{'/'.join(targets)}"

    def draw(self, canvas: Canvas, scene: GraphScene, look: Look, top: int) -> None:
        """Draw the lines from ``top`` on."""
        values, _, signs = scene
        for y, line in enumerate(self.lines[top : top + canvas.height]):
            self._draw_state(canvas, y, line, scene, look)
            if line.action is None:
                continue
            greedy = not values.greedy.isdisjoint((line.action.pair, *line.action.pairs))
            stroke = look.glyphs.bold if greedy else look.glyphs.thin
            text = self._text(line.action, line.branches, stroke, look.glyphs.head_right)
            style = look.palette.best if greedy else look.palette.text
            canvas.put(self._x, y, _whole_words(text, self._width - self._x, look), style)
            if not signs.breakpoints.pairs.isdisjoint((line.action.pair, *line.action.pairs)):
                canvas.put(self._x, y, look.glyphs.breakpoint, look.palette.breakpoint)

    def _draw_state(self, canvas: Canvas, y: int, line: ListLine, scene: GraphScene, look: Look) -> None:
        (values, form, signs), state, node = scene, line.state, self._shape.nodes[line.state]
        is_named, ground = line.row == 0 or y == 0, values.style(state, look)
        if is_named:
            _put_mark(canvas, y, state, signs, look)
        if not self._has_names:
            return
        plain = ground if self._is_stacked else look.palette.text
        if self._is_stacked and line.row < 2:
            canvas.put(1, y, " " * self._block, ground)
        if is_named:
            style = look.palette.focus if state == signs.cursor else plain + Style(bold=True)
            canvas.put(1, y, node.name, style)
            flag = values.flag(state, signs.differing, look)
            after = 1 + len(node.name) + len(flag)
            canvas.put(after - len(flag), y, flag, values.flag_style(state, look.palette.text, look))
            # one cell is free after the longest name
            marks = list(marks_of(signs.editor, state).signs(look))[: self._block + 2 - after]
            for place, mark in enumerate(marks, start=after):
                canvas.put(place, y, *mark)
        text = END if node.terminal else values.text(state, form, look)
        if node.terminal or (self._is_wide and is_named):
            canvas.put(self._x - 1 - _VALUE_WIDTH * self._is_wide, y, text.rjust(_VALUE_WIDTH), ground)
        elif self._is_stacked and line.row == 1 and y:
            canvas.put(1, y, text, ground)


def _put_mark(canvas: Canvas, y: int, state: int, signs: Signs, look: Look) -> None:
    here, palette = state == signs.agent, look.palette
    if state in signs.breakpoints.states:
        canvas.put(0, y, look.glyphs.agent if here else look.glyphs.breakpoint, palette.breakpoint)
    elif state == signs.cursor:
        canvas.put(0, y, look.glyphs.agent if here else look.glyphs.cursor, palette.focus)
    elif here:
        canvas.put(0, y, look.glyphs.agent, palette.agent)


def _whole_words(text: str, width: int, look: Look) -> str:
    if len(text) <= width:
        return text
    ellipsis = look.glyphs.ellipsis
    words = text.split(" ")
    while words and len(" ".join(words)) + 1 + len(ellipsis) > width:
        words.pop()
    return " ".join([*words, ellipsis]) if words else ellipsis[: max(0, width)]
