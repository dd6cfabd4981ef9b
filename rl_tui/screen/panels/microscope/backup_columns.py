"""The outcomes of a backup as columns of text, as many as there is room for."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from rl_tui.agents.update_terms import Lookup
from rl_tui.live.last_step.backup import Backup, Leaf
from rl_tui.screen.draw import names, numbers
from rl_tui.screen.draw.precision import agrees, column_figure, leading_zeros, parsed
from rl_tui.screen.panels.microscope.section import aligned, columns_of
from rl_tui.screen.panels.model.pair import HIDDEN
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.drawing import Arms
from rl_tui.worlds.mdp.tabular_mdp import UNKNOWN_ACTION
from rl_tui.worlds.world import World

_VALUE: Final = "V(s′)"
_VALUE_HEADS: Final = {
    Lookup.BEST: "max Q(s′,·)",
    Lookup.NEXT: "Σ π Q(s′,·)",
    Lookup.MEAN: "Σ π Q(s′,·)",
}
_SHARE: Final = "p·(r + γV)"
_GAP: Final = "  "
_DECIMALS: Final = 3
_MORE: Final = 5  # decimals beyond the fewest

_Column = list[str]  # the head, then a text for each outcome


def outcome_rows(
    world: World, backup: Backup, leaves: Sequence[Leaf], look: Look, room: int, *, secret: bool
) -> list[str]:
    """Return the heads and a row for each of ``leaves``, in ``room`` cells if they can be made to fit.

    What an outcome adds to the expected target is left out first, then a long head, then what is said of the
    next state. ``secret`` hides true rewards.
    """
    columns = _Columns(world, backup, leaves, look)
    always = [*columns.went(), columns.chance(), columns.reward(secret=secret)]
    if isinstance(world.drawing, Arms):
        return _joined(always)
    head = _VALUE_HEADS.get(backup.lookup, _VALUE)
    forms = (
        [*always, columns.landing(remarks=True), columns.value(head), *columns.shares()],
        [*always, columns.landing(remarks=True), columns.value(head)],
        [*always, columns.landing(remarks=True), columns.value(_VALUE)],
        [*always, columns.landing(remarks=False), columns.value(_VALUE)],
    )
    rows: list[str] = []
    for form in forms:
        rows = _joined(form)
        if columns_of(rows[0], look) <= room:
            break
    return rows


class _Columns:
    """The columns; those of numbers are aligned at the right."""

    def __init__(self, world: World, backup: Backup, leaves: Sequence[Leaf], look: Look) -> None:
        self._world = world
        self._backup = backup
        self._leaves = leaves
        self._look = look
        self._decimals = self._decimals_that_agree()

    def went(self) -> list[_Column]:
        """Return what really happens, where the world slips."""
        meant = int(self._world.space.pair_action[self._backup.pair])
        if all(leaf.action in (UNKNOWN_ACTION, meant) for leaf in self._backup.leaves):
            return []
        glyphs = self._look.glyphs
        texts = [
            "?" if leaf.action == UNKNOWN_ACTION else names.action_name(self._world, leaf.action, glyphs)
            for leaf in self._leaves
        ]
        return [self._filled(["went", *texts])]

    def chance(self) -> _Column:
        """Return the probabilities."""
        known = [leaf.probability for leaf in self._leaves]
        texts = ["?" if each is None else names.chance(each, self._look.glyphs) for each in known]
        return self._filled(["p", *texts], right=True)

    def reward(self, *, secret: bool) -> _Column:
        """Return the mean rewards and the noise around them."""
        glyphs = self._look.glyphs
        texts = []
        for leaf in self._leaves:
            mean = HIDDEN if secret else numbers.brief(leaf.reward, glyphs, decimals=4)
            noise = f"±{numbers.brief(leaf.noise, glyphs, decimals=2)}" if leaf.noise and not secret else ""
            texts.append(mean + noise)
        return self._filled(["r", *texts], right=True)

    def landing(self, *, remarks: bool) -> _Column:
        """Return the next states, with what is to be said of them."""
        texts = []
        for leaf in self._leaves:
            name = names.state_name(self._world, leaf.next_state, self._look.glyphs)
            remark = names.landmark(self._world, leaf.next_state) or ("ends" if leaf.terminated else "")
            texts.append(f"{name}: {remark}" if remark and remarks else name)
        return self._filled(["s′", *texts])

    def value(self, head: str) -> _Column:
        """Return what the next states are taken to be worth."""
        known = [leaf.value for leaf in self._leaves]
        texts = [
            "?" if each is None else column_figure(each, self._decimals, self._look.glyphs) for each in known
        ]
        return self._filled([head, *texts], right=True)

    def shares(self) -> list[_Column]:
        """Return what each outcome adds to the expected target, where that is known."""
        texts = []
        for leaf in self._leaves:
            if leaf.probability is None or leaf.value is None:
                return []
            share = self._share(leaf.probability, leaf.reward, leaf.value)
            texts.append(column_figure(share, self._decimals, self._look.glyphs))
        return [self._filled([_SHARE, *texts], right=True)]

    def _share(self, probability: float, reward: float, value: float) -> float:
        return probability * (reward + self._backup.gamma * value)

    def _decimals_that_agree(self) -> int:
        """Return the fewest decimals with which the shares are those of the printed values."""
        known = [leaf.value for leaf in self._leaves if leaf.value and abs(leaf.value) >= numbers.NEGLIGIBLE]
        fewest = _DECIMALS + max(0, leading_zeros(*known) - 1)
        most = fewest + _MORE
        return next((each for each in range(fewest, most) if self._agree(each)), most)

    def _agree(self, decimals: int) -> bool:
        glyphs = self._look.glyphs
        for leaf in self._leaves:
            if leaf.probability is None or leaf.value is None:
                return True
            printed = parsed(column_figure(leaf.value, decimals, glyphs), glyphs)
            shown = column_figure(self._share(leaf.probability, leaf.reward, leaf.value), decimals, glyphs)
            worked_out = self._share(leaf.probability, leaf.reward, printed)
            if not agrees(worked_out, shown, glyphs, decimals):
                return False
        return True

    def _filled(self, column: _Column, *, right: bool = False) -> _Column:
        width = max(columns_of(text, self._look) for text in column)
        return [aligned(text, width, self._look, right=right) for text in column]


def _joined(columns: Sequence[_Column]) -> list[str]:
    return [_GAP.join(row) for row in zip(*columns, strict=True)]
