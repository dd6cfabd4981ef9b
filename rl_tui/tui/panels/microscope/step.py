"""The last step as the agent–environment loop in five parts (Sutton & Barto, 2nd ed., Fig. 3.1)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from rl_tui.agents.catalogue import BY_ID
from rl_tui.agents.last_step import LastStep
from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.tui.draw.pieces import Line, Piece, first_that_fits
from rl_tui.tui.panels.last_step.loop_text import LoopText
from rl_tui.tui.panels.microscope.section import MicroscopeSection
from rl_tui.tui.theme.look import Look

STEP_HEADING: Final = "The step"
STEP_ROWS: Final = 5
_LABEL: Final = 8
_GAP: Final = "   "


def step_section(
    snapshot: Snapshot, last: LastStep, text: LoopText, look: Look, width: int
) -> MicroscopeSection:
    """Return state, action and why, reward, next state, and what was updated: a line each."""
    writer = _Writer(snapshot, last, text, look, width)
    return MicroscopeSection(
        STEP_HEADING, [getattr(writer, part)() for part in _PARTS], STEP_ROWS, _which(last, text)
    )


_PARTS: Final = ("state", "action", "reward", "next_state", "update")


class _Writer:
    def __init__(self, snapshot: Snapshot, last: LastStep, text: LoopText, look: Look, width: int) -> None:
        self._algorithm = BY_ID[snapshot.agent.learned_by[0]]
        self._last = last
        self._text = text
        self._look = look
        self._width = width

    def state(self) -> Line:
        place = self._text.place
        return self._line("state", [("s = ", self._text.state, tail) for tail in (place, "")])

    def action(self) -> Line:
        if self._last.planned:
            return self._line(
                "action", [("", "", tail) for tail in ("none: every action is tried", "every action")]
            )
        reasons = (self._text.choice, self._text.brief_choice)
        return self._line("action", [("a = ", self._text.action, reason) for reason in (*reasons, "")])

    def reward(self) -> Line:
        if self._last.planned:
            return self._line("reward", [("", "", tail) for tail in ("all of them: see the backup", "all")])
        return self._line("reward", [("r = ", self._text.reward, "")])

    def next_state(self) -> Line:
        text = self._text
        if self._last.planned:
            return self._line("next", [("", "", tail) for tail in ("all of them: see the backup", "all")])
        if text.is_bandit:
            return self._line("next", [("", "", tail) for tail in ("none: every pull is an episode", "none")])
        tails = [
            ", ".join(filter(None, (moved, text.landmark, ending)))
            for ending in (text.endings or ("",))
            for moved in _moved(text)
        ]
        return self._line("next", [("s′ = ", text.next_state, tail) for tail in (*tails, "")])

    def update(self) -> Line:
        text, names = self._text, (self._algorithm.name, "")
        if not text.estimate:
            return self._line("update", [("", "", tail) for tail in (f"none: {text.waiting}", text.waiting)])
        change = f" {text.update.before} → {text.update.after}"
        return self._line("update", [(text.estimate, change, name) for name in names])

    def _line(self, label: str, forms: Sequence[tuple[str, str, str]]) -> Line:
        """Return the first form that fits of symbol, value and remark."""
        palette = self._look.palette
        head = Piece(f" {label:<{_LABEL}}", palette.dim)
        lines = []
        for symbol, value, remark in forms:
            gap = _GAP if value else ""
            tail = [Piece(f"{gap}{remark}", palette.text)] if remark else []
            lines.append([head, Piece(symbol, palette.dim), Piece(value, palette.strong), *tail])
        return first_that_fits(lines, self._width, self._look)


def _moved(text: LoopText) -> list[str]:
    """Return what became of the action, the longest form first; empty where there is nothing to tell."""
    chance = f"p {text.chance}" if text.chance else ""
    if not text.went:
        return [chance, ""]
    verb = "went" if text.went == text.meant else "slipped"
    return [
        f"meant {text.meant}, {verb} {text.went} ({chance})",
        f"{verb} {text.went}, {chance}",
        f"{verb} {text.went}",
    ]


def _which(last: LastStep, text: LoopText) -> tuple[str, ...]:
    """Return which step of the run it is, longest form first."""
    if last.planned:
        return f"{last.step:,}, sweep {last.episode:,}", f"{last.step:,}"
    if text.is_bandit:
        return (f"{last.step:,}",)
    episode = f"{last.step:,}, episode {last.episode:,}"
    place = f"{episode}, its step {last.episode_step:,}" if last.episode_step else episode
    return place, episode, f"{last.step:,}"
