"""Where a word that is not a command exists as a key on screen."""

from __future__ import annotations

from typing import Final

from rl_tui.screen.keys.action import Action, Place
from rl_tui.screen.keys.registry import ACTIONS
from rl_tui.worlds.files.shipped import shipped_folder

_UNRELATED: Final = 3


def key_on_screen(word: str) -> str:
    """Return the key for ``word`` and the command that opens its screen.

    Empty if there is no such key, or if ``word`` is a scenario.
    """
    found = min(ACTIONS, key=lambda action: (_distance(action, word), _is_special(action)))
    if _distance(found, word) == _UNRELATED or (shipped_folder() / f"{word}.toml").is_file():
        return ""
    label = "" if found.label.lower().rstrip("…") == word.lower().rstrip("…") else f" ({found.label})"
    return f"on screen it is the key {found.shown}{label}: {_command(found)}"


def _distance(action: Action, word: str) -> int:
    """Return 0 for the label of ``action``, 1 for another name, 2 for the first word of its help."""
    word, label, verb = (
        word.lower().rstrip("…"),
        action.label.lower().rstrip("…"),
        action.help.split()[0].strip(",;").lower(),
    )
    return (word == label, word in f"{label} {action.aliases}".split(), word == verb, True).index(True)


def _is_special(action: Action) -> bool:
    """Return whether ``action`` is missing in the playground of a scenario."""
    return Place.PLAYGROUND not in action.place or action.of_program or action.of_lesson


def _command(action: Action) -> str:
    if action.of_program:
        return "rl-tui watch SCRIPT.py"
    if action.of_lesson or action.place == Place.LESSONS:
        return "rl-tui learn"
    return "rl-tui" if action.place == Place.CATALOGUE else "rl-tui play"
