"""The shape of a graph as a person draws it, while that is not in force."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from rl_tui.lab.live.editing.world_editor import EditorView
from rl_tui.tui.draw.to_ascii import to_ascii
from rl_tui.tui.panels.world.graph.shape import GraphAction, GraphShape, Node, graph_action, on_grid
from rl_tui.tui.theme.glyphs import Glyphs
from rl_tui.worlds.drawing import Graph
from rl_tui.worlds.editing.graph_draft import GraphDraft, chances_of
from rl_tui.worlds.world import Prospect, World


class _Graphs(NamedTuple):
    """What is drawn, what is in force, and the number of each state: those in force keep theirs."""

    draft: GraphDraft
    base: GraphDraft
    number_of: Mapping[str, int]


def draft_shape(editor: EditorView, world: World, graph: Graph, glyphs: Glyphs) -> GraphShape | None:
    """Return the shape of what is drawn; states of ``world`` come first and keep their numbers.

    Actions that are not in force are hatched. Their pairs have numbers below 0 where ``world`` has none. None
    where all that is drawn is in force, or nobody knows where a state stands.
    """
    draft, base = editor.draft, editor.base
    if draft is base or not isinstance(draft, GraphDraft) or not isinstance(base, GraphDraft):
        return None
    space = world.space
    names = [*space.state_names, *(each for each in draft.states if each not in space.state_names)]
    places = [
        _place(draft, name) or (graph.places[state] if state < space.states else None)
        for state, name in enumerate(names)
    ]
    known = [place for place in places if place is not None]
    if len(known) < len(names):
        return None
    graphs = _Graphs(draft, base, {name: number for number, name in enumerate(names)})
    acting = {str(each.get("state")) for each in draft.transitions}
    nodes = tuple(
        Node(to_ascii(name, glyphs), column, row, name not in acting)
        for name, (column, row) in zip(names, on_grid(known), strict=True)
    )
    actions = [
        _action(graphs, entry, -1 - number, world, glyphs) for number, entry in enumerate(draft.transitions)
    ]
    return GraphShape(nodes, tuple(sorted(actions, key=lambda action: action.source)))


def _place(draft: GraphDraft, name: str) -> tuple[int, int] | None:
    places = draft.rules.get("place")
    at: Sequence[int] = places.get(name, ()) if isinstance(places, Mapping) else ()
    return (int(at[0]), int(at[1])) if len(at) == 2 else None


def _action(
    graphs: _Graphs, entry: Mapping[str, Any], missing: int, world: World, glyphs: Glyphs
) -> GraphAction:
    """Return the action of ``entry``; its pair is ``missing`` where the world has none of that name."""
    state, name, space = str(entry.get("state")), str(entry.get("action")), world.space
    source = graphs.number_of[state]
    pair = None
    if source < space.states and name in space.action_names:
        pair = space.pair_of(source, space.action_names.index(name))
    is_new = graphs.base.entry(state, name) != entry
    prospects = [
        Prospect(graphs.number_of[target], chance, (_reward(entry, target),))
        for target, chance in chances_of(entry).items()
    ]
    shown = f"{glyphs.drafted if is_new else ''}{to_ascii(name, glyphs)}"
    return graph_action(shown, source, missing if pair is None else pair, prospects, glyphs)


def _reward(entry: Mapping[str, Any], target: str) -> float:
    to = entry.get("to")
    outcome = to.get(target) if isinstance(to, Mapping) else None
    own = outcome.get("reward") if isinstance(outcome, Mapping) else None
    reward = entry.get("reward") if own is None else own
    return float(reward) if isinstance(reward, int | float) else 0.0
