"""Modules that environment ids may import: only those that the user allowed by name."""

from __future__ import annotations

from importlib import import_module
from typing import Final

from rl_tui.common.errors import UserError
from rl_tui.common.findings import Finding, one_line, shown
from rl_tui.common.interrupts import is_interrupt
from rl_tui.common.kiosk import in_kiosk
from rl_tui.common.own_ids import OWN_IDS
from rl_tui.worlds.gym.env_call import ENVIRONMENT_CALL
from rl_tui.worlds.sections.schema import WorldRefusedError

OPTION: Final = "--allow-module"
_LONGEST_REASON: Final = 200
# Global, like imports
ALLOWED: Final[set[str]] = set()


def allow_module(name: str) -> None:
    """Allow ids of the form ``name:ID``, which import the module `name`.

    Raises:
        UserError: `name` is not a module name, or this is a kiosk.
    """
    if in_kiosk():
        raise UserError(f"kiosk mode imports no modules: leave {OPTION} out")
    if not _is_name(name):
        raise UserError(f"{shown(name)} is not the name of a module, such as my_package.environments")
    ALLOWED.add(name)


def module_of(id_: str) -> str:
    """Return the module in an environment id. Empty if there is none."""
    module, colon, _ = id_.partition(":")
    return module if colon else ""


def refusal_of(id_: str) -> Finding | None:
    """Return why an id may not be used, or None.

    Refused are our own scenarios, and ids that need a module which was not allowed.
    """
    if id_.rpartition(":")[2].startswith(OWN_IDS):
        return Finding(("id",), shown(id_), "another environment: this is a scenario of rl-tui")
    if ":" not in id_ or (module_of(id_) in ALLOWED and not in_kiosk()):
        return None
    expected = "the id of a registered environment, without a module to import"
    if _is_name(module_of(id_)) and not in_kiosk():
        expected = f"{expected}; if you trust that module: {OPTION} {module_of(id_)}"
    return Finding(("id",), shown(id_), expected)


def registered_id(id_: str) -> str:
    """Import the module in `id_`, if it is allowed, and return the rest of the id.

    Raises:
        WorldRefusedError: The module is not allowed, or cannot be imported.
    """
    refusal = refusal_of(id_)
    if refusal is not None:
        raise WorldRefusedError(*refusal)
    module = module_of(id_)
    if module:
        try:
            with ENVIRONMENT_CALL:
                import_module(module)
        except BaseException as error:  # an import may raise anything
            if is_interrupt(error):
                raise
            reason = one_line(f"{type(error).__name__}: {error}", _LONGEST_REASON)
            found = f"{module}, which cannot be imported ({reason})"
            raise WorldRefusedError(("id",), found, "a module of this Python's") from error
    return id_.partition(":")[2] if module else id_


def _is_name(text: str) -> bool:
    return text.isascii() and all(part.isidentifier() for part in text.split("."))
