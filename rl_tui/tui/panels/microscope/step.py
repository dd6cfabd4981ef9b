"""The last step as the agent–environment loop in five parts (Sutton & Barto, 2nd ed., Fig. 3.1)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from rl_tui.lab.last_step.story import StepStory
from rl_tui.tui.draw.names import COUNTED
from rl_tui.tui.draw.pieces import Line, Piece, first_that_fits
from rl_tui.tui.panels.last_step.last_step import ENDED, ENDED_SWEEP
from rl_tui.tui.panels.last_step.words import StepWords
from rl_tui.tui.panels.microscope.section import MicroscopeSection
from rl_tui.tui.theme.look import Look

STEP_HEADING: Final = "The step"
STEP_ROWS: Final = 5
_LABEL: Final = 8
_GAP: Final = "   "

_Form = tuple[str, str, str]  # symbol, value and remark


def step_section(words: StepWords, look: Look, width: int) -> MicroscopeSection:
    """Return state, action and why, reward, next state, and what was updated: a line each."""
    parts = {
        "state": [
            ("s = ", words.state, remark) for remark in (words.place, words.place.removesuffix(COUNTED), "")
        ],
        **(_planned() if words.story.last.planned else _taken(words)),
        "update": _update(words),
    }
    lines = [_line(label, forms, look, width) for label, forms in parts.items()]
    return MicroscopeSection(STEP_HEADING, lines, STEP_ROWS, _which(words.story))


def _planned() -> dict[str, list[_Form]]:
    return {
        "action": _remarks("none: every action is tried", "every action"),
        "reward": _remarks("all of them: see the backup", "all"),
        "next": _remarks("all of them: see the backup", "all"),
    }


def _taken(words: StepWords) -> dict[str, list[_Form]]:
    landings = [
        ("s′ = ", words.next_state, ", ".join(filter(None, (moved, words.landmark, ending))))
        for ending in (words.endings or ("",))
        for moved in _moved(words)
    ]
    return {
        "action": [("a = ", words.action, reason) for reason in (*words.choices, "")],
        "reward": [("r = ", words.reward, "")],
        "next": _remarks("none: every pull is an episode", "none")
        if words.story.is_bandit
        else [*landings, ("s′ = ", words.next_state, "")],
    }


def _update(words: StepWords) -> list[_Form]:
    waiting = words.story.terms.waiting
    if not words.estimate:
        return _remarks(f"none: {waiting}", waiting, "none")
    change = f" {words.update.before} → {words.update.after}"
    return [(words.estimate, change, remark) for remark in (words.story.algorithm.name, "")]


def _remarks(*texts: str) -> list[_Form]:
    return [("", "", text) for text in texts]


def _line(label: str, forms: Sequence[_Form], look: Look, width: int) -> Line:
    """Return the first of ``forms`` that fits, behind ``label``."""
    palette = look.palette
    head = Piece(f" {label:<{_LABEL}}", palette.dim)
    lines = []
    for symbol, value, remark in forms:
        gap = _GAP if value else ""
        tail = [Piece(f"{gap}{remark}", palette.text)] if remark else []
        lines.append([head, Piece(symbol, palette.dim), Piece(value, palette.strong), *tail])
    return first_that_fits(lines, width, look)


def _moved(words: StepWords) -> list[str]:
    """Return what became of the action, the longest form first; empty where there is nothing to tell."""
    chance = f"p {words.chance}" if words.chance else ""
    if not words.went:
        with_wind = [", ".join(filter(None, (words.wind, chance)))] if words.wind else []
        return [*with_wind, chance, ""]
    return [f"{words.outcome} ({chance})", f"{words.slip}, {chance}", words.slip]


def _which(story: StepStory) -> Sequence[str]:
    """Return which step of the run it is, longest form first; an episode that has ended has no number."""
    last = story.last
    step = f"{last.step:,}"
    if last.planned:
        return f"{step}, {ENDED_SWEEP if story.ends_episode else f'sweep {last.episode:,}'}", step
    if story.is_bandit:
        return (step,)
    episode = f"{step}, {ENDED if story.ends_episode else f'episode {last.episode:,}'}"
    where = f"with step {last.episode_step:,}" if story.ends_episode else f"its step {last.episode_step:,}"
    place = f"{episode}, {where}" if last.episode_step else episode
    return place, episode, step
