"""What stands on the border of the Q-table: which layer of what it shows, and the keys of the layers."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from rl_tui.common.words import counted
from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.tui.panels.q_table.form import Scene
from rl_tui.tui.panels.q_table.layers import Layer, other_lane
from rl_tui.tui.panels.q_table.list import ListForm
from rl_tui.tui.panels.q_table.sheet import Form
from rl_tui.tui.theme.glyphs import Glyphs

TITLES: Final = {
    Layer.Q: "Q",
    Layer.OPTIMAL: "Q*, exact",
    Layer.ERROR: "Q − Q*",
    Layer.LANES: "Q − other lane",
    Layer.VISITS: "Visits",
}
CAPTIONS: Final = {
    Layer.OPTIMAL: "what each action is worth",
    Layer.ERROR: "how wrong each estimate is",
    Layer.VISITS: "how often each was tried",
}


def headings(
    snapshot: Snapshot, layer: Layer, lane: str, captions: Iterable[str], size: str
) -> tuple[str, ...]:
    """Return the heading for ``layer`` of a table of this ``size``, the longest form first.

    ``lane`` is the number of the lane where another table stands beside it, else empty.
    """
    other = other_lane(snapshot) if layer is Layer.LANES else None
    if other is None:
        title = TITLES[layer]
        forms = (*(f"{each} · {size}" for each in captions), *captions, f"{title} · {size}", title)
        return tuple(f"{lane} · {each}" for each in forms) if lane else forms
    group = snapshot.run_group
    title, own = f"Q − Q of {other.name}", group.lanes[group.shown].name
    number = 1 + next(place for place, each in enumerate(group.lanes) if each is other)
    return (
        f"Q of {own} − Q of {other.name} · {size}",
        f"{title} · {size}",
        title,
        f"Q − Q of lane {number}",
    )


def layer_keys(layers: Iterable[Layer], shown: Layer, glyphs: Glyphs) -> tuple[str, str]:
    """Return the key of the ``layers`` with all their names, and with the one ``shown`` alone."""
    marked = [
        f"{glyphs.mark_left}{layer}{glyphs.mark_right}" if layer is shown else f" {layer} "
        for layer in layers
    ]
    return f"v:{''.join(marked)}".rstrip(), f"v: {shown}"


def size_in_words(scene: Scene, form: Form) -> str:
    """Return how many rows ``form`` has."""
    if isinstance(form, ListForm):
        noun = "arm" if scene.world.is_bandit else "pair"
        return counted(form.entries, noun)
    return f"{form.entries:,} states × {len(scene.world.action_names)}"
