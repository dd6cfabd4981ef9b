"""The key bindings of actions."""

from __future__ import annotations

from collections.abc import Iterable

from textual.binding import Binding, BindingType

from rl_tui.screen.keys.action import Action
from rl_tui.screen.keys.registry import ACTIONS


def bindings_everywhere() -> list[BindingType]:
    """Return the app's bindings, which come first even in dialogs."""
    return bindings_of((action for action in ACTIONS if action.everywhere), priority=True)


def stopping_keys() -> frozenset[str]:
    """Return the keys that leave a panel, a screen or the program."""
    return frozenset(key for action in ACTIONS if action.leaves for key in action.keys)


def bindings_of(actions: Iterable[Action], *, priority: bool = False) -> list[BindingType]:
    """Return the bindings, in a menu only of old keys."""
    return [
        Binding(
            key, does, action.label, key_display=action.shown, tooltip=action.help, id=id_, priority=priority
        )
        for action in actions
        for key, does, id_ in (
            ("" if action.menu else action.key, action.textual_action, action.id),
            (action.old, f"old_key({action.id!r})", f"old.{action.id}"),
        )
        if key
    ]
