"""An MDP as labelled nodes and edges, and as a list of edges.

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
from rl_tui.screen.draw.to_ascii import to_ascii
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
    """A state: name, place, and whether it is terminal."""

    name: str
    column: int
    row: int
    terminal: bool


class GraphBranch(NamedTuple):
    """One outcome of an action. An unknown ``probability`` is None."""

    target: int
    probability: float | None
    label: str


class GraphAction(NamedTuple):
    """One pair, with a branch per next state, likeliest first. A bundle has more ``pairs``."""

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
        """Return the shape with one action for all of a state that differ only by name."""
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
        """Return the actions, by their first pair, that are or contain one of ``pairs``."""
        return frozenset(each.pair for each in self.actions if not pairs.isdisjoint((each.pair, *each.pairs)))


class Signs(NamedTuple):
    """The marks on a graph. ``differing`` states have other greedy actions in the second run."""

    agent: int
    cursor: int | None
    breakpoints: Breakpoints
    differing: frozenset[int]
    editor: EditorView


class GraphScene(NamedTuple):
    """The ``values`` of a graph in one ``form``, and its ``signs``."""

    values: StateValues
    form: NumberForm
    signs: Signs


def graph_shape(world: World, graph: Graph, glyphs: Glyphs, *, is_kept: bool = False) -> GraphShape:
    """Return the shape of ``world``. ``is_kept`` hides probabilities."""
    space, mdp = world.space, world.mdp
    places = zip(space.state_names, on_grid(graph.places), strict=True)
    nodes = tuple(
        Node(to_ascii(name, glyphs), *place, not space.pairs_of(state))
        for state, (name, place) in enumerate(places)
    )
    actions = tuple(
        graph_action(
            to_ascii(space.action_names[int(space.pair_action[pair])], glyphs),
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
    """Return ``places`` without empty columns and rows."""
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
    """Return an action labelled with rewards and probabilities."""
    texts = {each.next_state: _rewards_text(each.rewards, glyphs) for each in prospects}
    targets = sorted(prospects, key=lambda each: -(each.probability or _LIKELY))
    if len(set(texts.values())) == 1:
        label = f"{name} {texts[targets[0].next_state]}"
        texts = dict.fromkeys(texts, "")
    else:
        label = name
    branches = []
    for each in targets:
        chance = DEPENDS if each.probability is None else probability_text(each.probability)
        said = f"{chance} {texts[each.next_state]}".strip() if len(targets) > 1 else ""
        branches.append(GraphBranch(each.next_state, each.probability, said))
    return GraphAction(pair, state, name, label, tuple(branches))


def _rewards_text(rewards: Sequence[float], glyphs: Glyphs) -> str:
    """Return one reward, or the range if it depends on the history: ``0..+10?``."""
    texts = [reward_text(reward, glyphs) for reward in rewards]
    return texts[0] if len(texts) == 1 else f"{texts[0]}..{texts[-1]}{DEPENDS}"


def reward_text(reward: float, glyphs: Glyphs) -> str:
    """Return a reward in three digits with its sign."""
    return f"{reward:+.3g}".replace("-", glyphs.minus) if reward else "0"


def probability_text(probability: float) -> str:
    """Return a probability in two decimals, or more near 0 and 1."""
    for decimals in (2, 3, 4, 5):
        rounded = round(probability, decimals)
        if 0.0 < rounded < 1.0 and abs(rounded - probability) < 0.02 * min(probability, 1.0 - probability):
            return f"{rounded:.{decimals}f}".strip("0")
    return "1" if probability > 0.5 else f"{probability:.0e}"


# The edges as text


_VALUE_WIDTH: Final = 6
_LEAST_TEXT: Final = 20  # characters of an edge: narrower panels omit names and values


def draw_edge_list(canvas: Canvas, shape: GraphShape, scene: GraphScene, look: Look, top: int) -> None:
    """Draw one line per action from ``top`` on. Narrow panels omit V, then names."""
    (values, form, signs), width = scene, canvas.width
    names = max((len(shape.nodes[action.source].name) for action in shape.actions), default=0)
    with_values = width >= names + _VALUE_WIDTH + 3 + _LEAST_TEXT
    with_names = width >= names + 2 + _LEAST_TEXT
    x = 1 + (names + 1) * with_names + (_VALUE_WIDTH + 1) * with_values
    shown = shape.actions[top : top + canvas.height]
    for y, action in enumerate(shown):
        if y == 0 or shown[y - 1].source != action.source:
            state = action.source
            _put_mark(canvas, y, state, signs, look)
            if with_names:
                style = look.palette.focus if state == signs.cursor else look.palette.text + Style(bold=True)
                canvas.put(1, y, shape.nodes[state].name, style)
                flag = values.flag(state, signs.differing, look)
                style = values.flag_style(state, look.palette.text, look)
                after = 1 + len(shape.nodes[state].name) + len(flag)
                canvas.put(after - len(flag), y, flag, style)
                # one cell is free after the longest name
                marks = list(marks_of(signs.editor, state).signs(look))[: names + 2 - after]
                for place, mark in enumerate(marks, start=after):
                    canvas.put(place, y, *mark)
            if with_values:
                text = values.text(state, form, look)
                canvas.put(2 + names, y, text.rjust(_VALUE_WIDTH), values.style(state, look))
        greedy = action.pair in values.greedy
        style = look.palette.best if greedy else look.palette.text
        text = edge_text(shape, action, greedy, look)
        if len(text) > width - x >= len(tight := edge_text(shape, action, greedy, look, is_tight=True)):
            text = tight
        canvas.put(x, y, whole_words(text, width - x, look), style)
        if action.pair in signs.breakpoints.pairs:
            canvas.put(x, y, look.glyphs.breakpoint, look.palette.breakpoint)


def _put_mark(canvas: Canvas, y: int, state: int, signs: Signs, look: Look) -> None:
    here, palette = state == signs.agent, look.palette
    if state in signs.breakpoints.states:
        canvas.put(0, y, look.glyphs.agent if here else look.glyphs.breakpoint, palette.breakpoint)
    elif state == signs.cursor:
        canvas.put(0, y, look.glyphs.agent if here else look.glyphs.cursor, palette.focus)
    elif here:
        canvas.put(0, y, look.glyphs.agent, palette.agent)


def edge_text(
    shape: GraphShape, action: GraphAction, greedy: bool, look: Look, *, is_tight: bool = False
) -> str:
    """Return ``─study −2─▶ Pass .8 / Class .2``, closer if ``is_tight``."""
    line = look.glyphs.bold if greedy else look.glyphs.thin
    targets = (f"{shape.nodes[branch.target].name} {branch.label}".strip() for branch in action.branches)
    if is_tight:
        return f"{line}{action.label}{look.glyphs.head_right}{'/'.join(targets)}"
    return f"{line}{action.label}{line}{look.glyphs.head_right} {' / '.join(targets)}"


def whole_words(text: str, width: int, look: Look) -> str:
    """Return ``text`` cut at a word, so that no number loses digits."""
    if len(text) <= width:
        return text
    ellipsis = look.glyphs.ellipsis
    words = text.split(" ")
    while words and len(" ".join(words)) + 1 + len(ellipsis) > width:
        words.pop()
    return " ".join([*words, ellipsis]) if words else ellipsis[: max(0, width)]
