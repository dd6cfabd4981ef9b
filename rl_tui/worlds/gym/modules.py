"""Modules that environment ids may import: those allowed by name."""

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
    """Allow ids of the form ``name:ID``, which import the module.

    Raises:
        UserError: `name` is not a module name, or this is a kiosk.
    """
    if in_kiosk():
        raise UserError(f"kiosk mode imports no modules: leave out {OPTION}")
    if not _is_name(name):
        raise UserError(f"{shown(name)} is not the name of a module, such as my_package.environments")
    ALLOWED.add(name)


def module_of(id_: str) -> str:
    """Return the module in an environment id, or an empty text."""
    module, colon, _ = id_.partition(":")
    return module if colon else ""


def refusal_of(id_: str) -> Finding | None:
    """Return why an id is refused (our own scenario, or a module not allowed), or None."""
    if id_.rpartition(":")[2].startswith(OWN_IDS):
        return Finding(("id",), f"{shown(id_)} is a scenario of rl-tui; name another environment")
    if ":" not in id_ or (module_of(id_) in ALLOWED and not in_kiosk()):
        return None
    found = f"{shown(id_)} names a module, which is not imported"
    if _is_name(module_of(id_)) and not in_kiosk():
        return Finding(("id",), f"{found}; if you trust it, add {OPTION} {module_of(id_)}")
    return Finding(("id",), f"{found}; use the id of a registered environment")


def registered_id(id_: str) -> str:
    """Import the module in `id_`, and return the rest of the id.

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
            found = f"{module} cannot be imported ({reason}); name a module of this Python"
            raise WorldRefusedError(("id",), found) from error
    return id_.partition(":")[2] if module else id_


def _is_name(text: str) -> bool:
    return text.isascii() and all(part.isidentifier() for part in text.split("."))
