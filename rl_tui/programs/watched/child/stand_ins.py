"""Replacements for functions of notebooks, and for missing modules for logs."""

from __future__ import annotations

import builtins
import sys
from collections.abc import Callable, Iterator, Mapping
from typing import Any, Final, Self

from rl_tui.common.made_modules import MadeModules
from rl_tui.programs.watched.child.errors import is_users_file

Note = Callable[[str], None]
_LOGGING: Final = frozenset({"IPython", "wandb", "tensorboardX"})
_SHELL: Final = "get_ipython() belongs to notebooks: its commands are skipped"


class Nothing:
    """Accepts every call and attribute, and does nothing."""

    def __init__(self, *_: Any, **__: Any) -> None:
        pass

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return Nothing()

    def __call__(self, *_: Any, **__: Any) -> Nothing:
        """Do nothing."""
        return Nothing()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def __iter__(self) -> Iterator[Any]:
        return iter(())

    def __getitem__(self, _: Any) -> Nothing:
        return Nothing()

    def __setitem__(self, *_: Any) -> None:
        pass


def stand_in(note: Note) -> None:
    """Offer the replacements, and `note` the first use of each."""

    def get_ipython() -> Nothing:
        if not is_users_file(sys._getframe(1).f_code.co_filename):  # a library looks for a notebook
            raise NameError("name 'get_ipython' is not defined")
        note(_SHELL)
        return Nothing()

    builtins.get_ipython = get_ipython  # type: ignore[attr-defined]
    builtins.display = print  # type: ignore[attr-defined]
    sys.meta_path.append(MadeModules(_is_for_logs, lambda name: _content(name, note)))


def _is_for_logs(name: str) -> bool:
    top, _, inner = name.partition(".")
    is_ours = isinstance(getattr(sys.modules.get(top), "__loader__", None), MadeModules)
    return top in _LOGGING and (not inner or is_ours)


def _content(name: str, note: Note) -> Mapping[str, Any]:
    top = name.partition(".")[0]
    note(f"{top} is not installed: its functions do nothing")
    shown = {"display": print} if top == "IPython" else {}
    return {**shown, "__getattr__": Nothing().__getattr__}
