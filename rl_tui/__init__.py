"""rl-tui: watch a tabular reinforcement-learning agent learn, in any terminal.

From Python: :func:`train`, :func:`solve`, :func:`evaluate` and :func:`scenarios` do what the commands do, and
return numbers and arrays. An error that the user can fix is raised as :class:`Error`, in one line. After
``import rl_tui``, Gymnasium has every shipped scenario as ``rl_tui/NAME-v0``. Other modules are imported when
they are needed.
"""

from rl_tui.common.after_import import after_import

# typing itself takes longer to import than all of this
TYPE_CHECKING = False
if TYPE_CHECKING:
    from rl_tui.commands.python.answers import evaluate, scenarios, solve
    from rl_tui.commands.python.training import train
    from rl_tui.common.errors import UserError as Error

__version__ = "1.0.0"
__all__ = ["Error", "__version__", "evaluate", "scenarios", "solve", "train"]

_PLACES = {
    "Error": ("rl_tui.common.errors", "UserError"),
    "evaluate": ("rl_tui.commands.python.answers", "evaluate"),
    "scenarios": ("rl_tui.commands.python.answers", "scenarios"),
    "solve": ("rl_tui.commands.python.answers", "solve"),
    "train": ("rl_tui.commands.python.training", "train"),
}


def _register_scenarios(_: object) -> None:
    import rl_tui.worlds.environments.registration  # noqa: F401


after_import("gymnasium", _register_scenarios)


def __getattr__(name: str) -> object:
    """Return what is offered under ``name``, imported now."""
    if name not in _PLACES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    module, attribute = _PLACES[name]
    found = globals()[name] = getattr(import_module(module), attribute)
    return found


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
