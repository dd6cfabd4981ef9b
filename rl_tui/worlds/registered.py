"""Making the environments that Gymnasium knows by name, without a word on the terminal."""

from __future__ import annotations

import threading
import warnings
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rl_tui.worlds.findings import Finding, near, one_line, shown
from rl_tui.worlds.world_section import WorldRefusedError

if TYPE_CHECKING:
    from gymnasium import Env

LONGEST_REASON: Final = 200
SMALL: Final = ("gymnasium.envs.toy_text.", "gymnasium.envs.classic_control.")
# Which warnings are shown is one setting for all threads
_MAKING: Final = threading.Lock()


def made(name: str, kwargs: Mapping[str, Any]) -> Env[Any, Any]:
    """Return a new environment of the registered id ``name``, made with ``kwargs``.

    It has the wrappers that its registration asks for (the time limit), but not the one that checks: what an
    environment answers is checked here. Raises WorldRefusedError where it is not registered or cannot be
    made. From the first call on Gymnasium keeps its advice to itself.
    """
    import gymnasium

    gymnasium.logger.min_level = gymnasium.logger.ERROR + 1
    if name not in gymnasium.registry:
        known = (id_ for id_, spec in gymnasium.registry.items() if _may_serve(spec.entry_point))
        expected = f"the id of a registered environment{near(name, known)}"
        raise WorldRefusedError(Finding(("id",), shown(name), expected))
    try:
        with _MAKING, warnings.catch_warnings():
            warnings.simplefilter("ignore")
            # a map without a start divides by zero; the check of the start distribution tells that plainly
            with np.errstate(invalid="ignore", divide="ignore"):
                # by its spec: looking an id up warns about newer versions, no concern of a scenario
                spec = gymnasium.registry[name]
                return gymnasium.make(spec, **{"disable_env_checker": True, **kwargs})
    except Exception as error:  # whatever an environment's constructor may raise
        reason = reason_of(error)
        finding = (
            Finding(("kwargs",), f"what makes {name} fail ({reason})", f"what {name} takes")
            if kwargs
            else Finding(("id",), f"{name}, which cannot be made ({reason})", "one that can be made here")
        )
        raise WorldRefusedError(finding) from error


def _may_serve(entry_point: object) -> bool:
    """Tell from where an environment comes from, without making it, whether it is worth suggesting.

    Of Gymnasium's own, few have states and actions that are discrete or few real numbers.
    """
    entry = str(entry_point)
    return entry.startswith(SMALL) or not entry.startswith(("gymnasium.", "<"))


def reason_of(error: Exception) -> str:
    """Return what an environment raised, in one line of at most 200 characters that is safe to print."""
    return one_line(f"{type(error).__name__}: {error}", LONGEST_REASON)


def time_limit_of(environment: Env[Any, Any]) -> int:
    """Return after how many steps its registration truncates an episode, 0 for never."""
    return (environment.spec.max_episode_steps if environment.spec else None) or 0
