"""Hints for words that are not commands but keys on screen."""

from __future__ import annotations

from typing import Final

from rl_tui.screen.keys.action import Action, Place
from rl_tui.screen.keys.registry import ACTIONS
from rl_tui.worlds.files.shipped import shipped_folder

_UNRELATED: Final = 3


def key_on_screen(word: str) -> str:
    """Return a hint with the key for `word` and the command that opens its screen.

    Empty if no key matches, or if `word` is a scenario.
    """
    found = min(ACTIONS, key=lambda action: (_distance(action, word), _is_special(action)))
    if _distance(found, word) == _UNRELATED or (shipped_folder() / f"{word}.toml").is_file():
        return ""
    label = "" if found.label.lower().rstrip("…") == word.lower().rstrip("…") else f" ({found.label})"
    return f"it is a key on screen: start {_command(found)}, then press {found.shown}{label}"


def _distance(action: Action, word: str) -> int:
    # 0: label, 1: alias, 2: first word of the help
    word, label, verb = (
        word.lower().rstrip("…"),
        action.label.lower().rstrip("…"),
        action.help.split()[0].strip(",;").lower(),
    )
    return (word == label, word in f"{label} {action.aliases}".split(), word == verb, True).index(True)


def _is_special(action: Action) -> bool:
    # The playground of a scenario does not have it
    return Place.PLAYGROUND not in action.place or action.of_program or action.of_lesson


def _command(action: Action) -> str:
    if action.of_program:
        return "rl-tui watch SCRIPT.py"
    if action.of_lesson or action.place == Place.LESSONS:
        return "rl-tui learn"
    return "rl-tui" if action.place == Place.CATALOGUE else "rl-tui play"
