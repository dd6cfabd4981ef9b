"""Hints for words that are not commands but keys on screen."""

from __future__ import annotations

from typing import Final

from rl_tui.screen.keys.action import Action, Place
from rl_tui.screen.keys.registry import ACTIONS
from rl_tui.worlds.files.shipped import shipped_folder

_UNRELATED: Final = 3


def key_on_screen(word: str) -> str:
    """Return a hint that names the key for `word` and the command that opens its screen.

    Returns:
        The hint. Empty if no key matches, or if `word` is a scenario.
    """
    found = min(ACTIONS, key=lambda action: (_distance(action, word), _is_special(action)))
    if _distance(found, word) == _UNRELATED or (shipped_folder() / f"{word}.toml").is_file():
        return ""
    label = "" if found.label.lower().rstrip("…") == word.lower().rstrip("…") else f" ({found.label})"
    return f"on screen it is the key {found.shown}{label}: {_command(found)}"


def _distance(action: Action, word: str) -> int:
    """Return 0 if `word` is the label, 1 an alias, 2 the first word of the help, else 3."""
    word, label, verb = (
        word.lower().rstrip("…"),
        action.label.lower().rstrip("…"),
        action.help.split()[0].strip(",;").lower(),
    )
    return (word == label, word in f"{label} {action.aliases}".split(), word == verb, True).index(True)


def _is_special(action: Action) -> bool:
    """Return True if the playground of a scenario does not have this action."""
    return Place.PLAYGROUND not in action.place or action.of_program or action.of_lesson


def _command(action: Action) -> str:
    if action.of_program:
        return "rl-tui watch SCRIPT.py"
    if action.of_lesson or action.place == Place.LESSONS:
        return "rl-tui learn"
    return "rl-tui" if action.place == Place.CATALOGUE else "rl-tui play"
