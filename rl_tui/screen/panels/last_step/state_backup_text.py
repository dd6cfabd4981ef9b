"""A planner's Bellman equation in numbers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import Final, NamedTuple

import numpy as np

from rl_tui.live.last_step.step_report import StateBackup
from rl_tui.screen.draw import names
from rl_tui.screen.draw.action_order import shown_pairs
from rl_tui.screen.draw.precision import agrees, figure, in_brackets, leading_zeros, parsed
from rl_tui.screen.panels.last_step.update_text import setting
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.worlds.world import World

_FEWEST: Final = 2
_MOST: Final = 5  # decimals beyond the leading zeros
_NAMES: Final = {None: "optimality", "evaluation": "evaluation", "improvement": "improvement"}
_LAWS: Final = {
    None: "V(s) ← max Σ p [r + γ V(s′)]",
    "evaluation": "V(s) ← Σ π(a|s) Σ p [r + γ V(s′)]",
    "improvement": "π(s) ← argmax Σ p [r + γ V(s′)]",
}


class ActionText(NamedTuple):
    """An action's sign, terms (``0 + .99·.34``), and value."""

    sign: str
    worked_out: str
    q: str
    counts: bool


@lru_cache(maxsize=2)
def backup_text(world: World, backup: StateBackup, glyphs: Glyphs) -> BackupText:
    """Write ``backup`` with consistent decimals."""
    fewest = _FEWEST + leading_zeros(backup.value, *backup.q.tolist())
    text = BackupText(world, backup, glyphs, fewest)
    for decimals in range(fewest, fewest + _MOST):
        text = BackupText(world, backup, glyphs, decimals)
        if text.comes_out:
            break
    return text


class BackupText:
    """``V(6) ← max{↑0 →.06 ↓.34 ←.06} = .34``."""

    def __init__(self, world: World, backup: StateBackup, glyphs: Glyphs, decimals: int) -> None:
        self._backup, self._glyphs, self._decimals = backup, glyphs, decimals
        pairs = shown_pairs(world, backup.pairs)
        self._places = [pair - backup.pairs.start for pair in pairs]
        numbers = [int(world.space.pair_action[pair]) for pair in pairs]
        self._are_directions = all(names.is_direction(world, number) for number in numbers)
        self.actions = [
            ActionText(
                names.action_name(world, number, glyphs),
                self._worked_out(place),
                self._figure(float(backup.q[place])),
                backup.chance[place] > 0.0,
            )
            for number, place in zip(numbers, self._places, strict=True)
        ]
        self._taken = [each for each in self.actions if each.counts]
        self._value = self._figure(backup.value)
        state = names.state_name(world, backup.state, glyphs)
        improves = backup.phase == "improvement"
        self.kind, self.law = _NAMES[backup.phase], _LAWS[backup.phase]
        self.left = f"{'π' if improves else 'V'}{'' if world.is_bandit else f'({state})'}"
        of = "argmax" if improves else "max"
        self.right = self._mean() if backup.phase == "evaluation" else self._best(of)
        self.result = self._chosen() if improves else self._value

    def lines(self, arrow: str) -> Sequence[str]:
        """Return forms of the equation."""
        start = f"{self.left} {arrow} "
        return (*(f"{start}{each} = {self.result}" for each in self.right), f"{start}{self.result}")

    def _figure(self, x: float) -> str:
        return figure(x, self._decimals, self._glyphs)

    @property
    def comes_out(self) -> bool:
        """True if printed numbers give the result and the best."""
        backup = self._backup
        if backup.phase == "evaluation":
            mean = sum(parsed(each.q, self._glyphs) for each in self._taken) / max(1, len(self._taken))
            if not agrees(mean, self._value, self._glyphs, self._decimals, 0.5):
                return False
        else:
            of_best = {each.q for each in self._taken}
            others = {each.q for each in self.actions if not each.counts}
            if len(of_best) > 1:  # equally good, but rounded differently
                return False
            if of_best & others and float(np.ptp(backup.q)) > 10.0 ** -(self._decimals + 2):
                return False
        if not backup.is_split:
            return True
        for place, action in zip(self._places, self.actions, strict=True):
            reward, bootstrap = (parsed(each, self._glyphs) for each in self._terms(place))
            if not agrees(reward + backup.gamma * bootstrap, action.q, self._glyphs, self._decimals):
                return False
        return True

    def _terms(self, place: int) -> tuple[str, str]:
        reward, bootstrap = self._backup.reward[place], self._backup.bootstrap[place]
        return self._figure(float(reward)), self._figure(float(bootstrap))

    def _worked_out(self, place: int) -> str:
        if not self._backup.is_split:
            return ""
        reward, bootstrap = self._terms(place)
        gamma = setting(self._backup.gamma, self._glyphs)
        return f"{reward} + {gamma}{self._glyphs.times}{in_brackets(bootstrap, self._glyphs)}"

    def _mean(self) -> Sequence[str]:
        first, *others = self._taken
        if not others:
            return (first.worked_out,) if first.worked_out else ()
        share = names.chance(float(self._backup.chance.max()), self._glyphs)
        minus, more = self._glyphs.minus, f" + {self._glyphs.ellipsis}"
        added = [f" + {each.q}".replace(f"+ {minus}", f"{minus} ") for each in others]
        sums = ("".join(added), *((more + added[-1],) if len(added) > 1 else ()), more)
        return [f"{share}{self._glyphs.times}({first.q}{each})" for each in sums]

    def _best(self, of: str) -> Sequence[str]:
        gap, between = ("", " ") if self._are_directions else (" ", ", ")
        signed = [f"{each.sign}{gap}{each.q}" for each in self.actions]
        numbers = [", ".join(each.q for each in self.actions)] if of == "max" else []
        forms = [between.join(signed), *numbers, *self._elided(signed, between)]
        return [f"{of}{{{each}}}" for each in forms]

    def _elided(self, signed: Sequence[str], between: str) -> Iterator[str]:
        values = self._backup.q[self._places].tolist()
        ranks = [(not each.counts, -value) for each, value in zip(self.actions, values, strict=True)]
        best_first = sorted(range(len(signed)), key=ranks.__getitem__)
        for count in range(len(signed) - 1, 0, -1):
            kept = sorted(best_first[:count])
            yield between.join((*(signed[each] for each in kept), self._glyphs.ellipsis))

    def _chosen(self) -> str:
        gap = "" if self._are_directions else " or "
        return gap.join(each.sign for each in self._taken)
