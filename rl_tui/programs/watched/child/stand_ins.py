"""Replacements for functions of notebooks, and for missing modules for logs."""

from __future__ import annotations

import builtins
import sys
from collections.abc import Callable, Iterator, Sequence
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Any, Final, Self

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
    sys.meta_path.append(_LastFinder(note))


class _LastFinder:
    def __init__(self, note: Note) -> None:
        self._note = note

    def find_spec(
        self, fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        top, _, inner = fullname.partition(".")
        if top not in _LOGGING or (
            inner and not isinstance(getattr(sys.modules[top], "__loader__", None), _LastFinder)
        ):
            return None
        return ModuleSpec(fullname, self, is_package=True)  # type: ignore[arg-type]

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        return ModuleType(spec.name)

    def exec_module(self, module: ModuleType) -> None:
        top = module.__name__.partition(".")[0]
        self._note(f"{top} is not installed: its functions do nothing")
        shows_nothing = {"display": print} if top == "IPython" else {}
        module.__dict__.update(shows_nothing, __path__=[], __getattr__=Nothing().__getattr__)
