"""What stands on the border of the Q-table: what is shown, how much of it, and the layers to choose from."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from rl_tui.common.words import counted
from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.tui.draw.pieces import Piece, wrapped
from rl_tui.tui.draw.to_ascii import separated, to_ascii
from rl_tui.tui.panels.panel import Panel
from rl_tui.tui.panels.policies.names import POLICY_NAMES
from rl_tui.tui.panels.q_table.form import Scene
from rl_tui.tui.panels.q_table.layers import Layer, other_lane
from rl_tui.tui.panels.q_table.list import ListForm
from rl_tui.tui.panels.q_table.sheet import Form
from rl_tui.tui.panels.snapshot_facts import has_estimates
from rl_tui.tui.theme.glyphs import Glyphs
from rl_tui.tui.theme.look import Look

COMPUTING: Final = "computing the exact answer …"
FOLLOWS: Final = "follows the agent"
FOLLOW_HINT: Final = "esc: follow the agent"
TITLES: Final = {
    Layer.Q: "Q",
    Layer.OPTIMAL: "Q*, exact",
    Layer.ERROR: "Q − Q*",
    Layer.POLICY: "Q of a policy",
    Layer.LANES: "Q − other lane",
    Layer.VISITS: "Visits",
}
_CAPTIONS: Final = {
    Layer.OPTIMAL: "what each action is worth",
    Layer.ERROR: "how wrong each estimate is",
    Layer.POLICY: "exact",
    Layer.VISITS: "how often each was tried",
}
NO_TABLE: Final = "no table found in your program"
_KEY: Final = "v:"
EXACT_KEY: Final = "h: Q*"


def headings(snapshot: Snapshot, layer: Layer, size: str, panel: Panel, lane: str = "") -> tuple[str, ...]:
    """Return what ``panel`` is called while it shows ``layer``, the longest form first.

    ``lane`` is the number of the lane where another table stands beside it. Alone, and with runs side by
    side, it is marked with the number of the shown one.
    """
    group = snapshot.run_group
    if group.lanes and not lane:
        lane = f"{panel.look.glyphs.cursor}{group.shown + 1}"
    other = other_lane(snapshot) if layer is Layer.LANES else None
    if other is None:
        title, studied = TITLES[layer], snapshot.answers.studied
        if layer is Layer.POLICY and studied is not None:
            title = f"Q of {POLICY_NAMES[studied].of}"
        captions = panel.captioned(title, _CAPTIONS.get(layer, ""))
        if layer is Layer.Q and not has_estimates(snapshot):
            size, captions = NO_TABLE, ()
        forms = (*(f"{each} · {size}" for each in captions), *captions, f"{title} · {size}", title)
        return tuple(f"{lane} · {each}" for each in forms) if lane else forms
    title, own = f"Q − Q of {other.name}", snapshot.run_group.lanes[snapshot.run_group.shown].name
    number = 1 + next(place for place, lane in enumerate(snapshot.run_group.lanes) if lane is other)
    return tuple(
        f"{lane} · {each}"
        for each in (
            f"Q of {own} − Q of {other.name} · {size}",
            f"{title} · {size}",
            title,
            f"Q − Q of lane {number}",
        )
    )


def size_in_words(scene: Scene, form: Form) -> str:
    """Return how large the table is: ``11 states × 4``, ``5 pairs``."""
    if isinstance(form, ListForm):
        return counted(form.entries, "arm" if scene.world.is_bandit else "pair")
    return f"{form.entries:,} states × {len(scene.world.action_names)}"


def footings(layer: Layer, choices: Sequence[Layer], glyphs: Glyphs, *, hides_exact: bool) -> list[str]:
    """Return the key and the layers that it goes through, then the key and ``layer``, which is shown.

    Behind them stands the key that shows what is exact, where ``hides_exact`` says that this is hidden.
    """
    marked = [
        f"{glyphs.mark_left}{each}{glyphs.mark_right}" if each is layer else f" {each} " for each in choices
    ]
    all_layers, one = f"{_KEY}{''.join(marked)}".rstrip(), f"{_KEY} {layer}"
    return [*(f"{each} · {EXACT_KEY}" for each in (all_layers, one) if hides_exact), all_layers, one]


def followed(footings: Sequence[str], *, is_following: bool) -> list[str]:
    """Return ``footings`` behind whether the table follows the agent."""
    follow = FOLLOWS if is_following else FOLLOW_HINT
    return [*(f"{follow} · {each}" for each in footings), follow]


def layer_at(footing: str, column: int, choices: Sequence[Layer], glyphs: Glyphs) -> Layer | None:
    """Return the layer named in ``column`` of ``footing``; None where there is no room for all names."""
    text = separated(footing, glyphs)
    end = text.find(_KEY) + len(_KEY)
    for layer in choices:
        name = to_ascii(layer, glyphs)
        start = text.find(name, end)
        if start < 0:
            return None  # there is room for one name only: a click is the key
        end = start + len(name)
        if start - 1 <= column <= end:
            return layer
    return None


def no_answer(snapshot: Snapshot, width: int, look: Look) -> list[list[Piece]]:
    """Return why there is no exact answer, or that it is to come, in lines of ``width`` cells."""
    palette, refused = look.palette, snapshot.exact_answer.refused
    text = f"No exact answer: {refused}" if refused else COMPUTING
    lines = wrapped(text, max(1, width - 2), palette.text if refused else palette.dim, look)
    return [[Piece(" ", palette.text), *line] for line in lines]
