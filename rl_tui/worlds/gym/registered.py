"""Making the environments that Gymnasium knows by name, without a word on the terminal."""

from __future__ import annotations

import threading
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rl_tui.common.findings import near, one_line, shown
from rl_tui.common.interrupts import is_interrupt
from rl_tui.common.limits import LARGEST_ARGUMENTS, LONGEST_TIME_LIMIT
from rl_tui.common.own_ids import OWN_IDS
from rl_tui.worlds.gym.env_call import ENVIRONMENT_CALL
from rl_tui.worlds.gym.modules import registered_id
from rl_tui.worlds.sections.world_section import WorldRefusedError

if TYPE_CHECKING:
    from gymnasium import Env

LONGEST_REASON: Final = 200
SMALL: Final = ("gymnasium.envs.toy_text.", "gymnasium.envs.classic_control.")
# Which warnings are shown is one setting for all threads
_MAKING: Final = threading.Lock()


def made(name: str, kwargs: Mapping[str, Any]) -> Env[Any, Any]:
    """Return a new environment of the registered id ``name``, made with ``kwargs``.

    An id ``module:ID`` imports that module first, if that is allowed.

    It has the wrappers that its registration asks for (the time limit), but not the one that checks: what an
    environment answers is checked here. Raises WorldRefusedError where it is not registered or cannot be
    made. From the first call on Gymnasium keeps its advice to itself.
    """
    import gymnasium

    gymnasium.logger.min_level = gymnasium.logger.ERROR + 1
    name = registered_id(name)
    if name not in gymnasium.registry:
        known = (id_ for id_, spec in gymnasium.registry.items() if _may_serve(id_, spec.entry_point))
        expected = f"the id of a registered environment{near(name, known)}"
        raise WorldRefusedError(("id",), shown(name), expected)
    if size_of(kwargs) > LARGEST_ARGUMENTS:
        expected = f"at most {LARGEST_ARGUMENTS:,} characters and values in all"
        raise WorldRefusedError(("kwargs",), f"{size_of(kwargs):,} characters and values", expected)
    try:
        with ENVIRONMENT_CALL, _MAKING, warnings.catch_warnings():
            warnings.simplefilter("ignore")
            # a map without a start divides by zero; the check of the start distribution says that plainly
            with np.errstate(invalid="ignore", divide="ignore"):
                # by its spec: looking an id up warns about newer versions, no concern of a scenario
                spec = gymnasium.registry[name]
                return gymnasium.make(spec, **{"disable_env_checker": True, **kwargs})
    except BaseException as error:  # a constructor may raise anything
        if is_interrupt(error):
            raise
        reason = reason_of(error)
        if kwargs:
            found = f"what makes {name} fail ({reason})"
            raise WorldRefusedError(("kwargs",), found, f"what {name} takes") from error
        found = f"{name}, which cannot be made ({reason})"
        raise WorldRefusedError(("id",), found, "one that can be made here") from error


@contextmanager
def looked_at(name: str, kwargs: Mapping[str, Any]) -> Iterator[Env[Any, Any]]:
    """Yield a new environment to be read and closed again.

    Raises WorldRefusedError as :func:`made` does, and where it raises something while it is looked at.
    """
    environment = made(name, kwargs)
    try:
        yield environment
    except WorldRefusedError:
        raise
    except BaseException as error:  # attributes are an environment's own code too
        if is_interrupt(error):
            raise
        found = f"{name}, which cannot be read ({reason_of(error)})"
        raise WorldRefusedError(("id",), found, "one that tells its states and actions") from error
    finally:
        close(environment)


def close(environment: Env[Any, Any]) -> None:
    """Let ``environment`` give back what it holds."""
    try:
        with ENVIRONMENT_CALL:
            environment.close()
    except BaseException as error:  # a failure to close concerns no one any more
        if is_interrupt(error):
            raise


def size_of(arguments: Mapping[str, Any]) -> int:
    """Return how many characters and values there are in ``arguments``."""
    size = 0
    to_count: list[Any] = [arguments]
    while to_count:
        value = to_count.pop()
        if isinstance(value, Mapping):
            to_count += [*value, *value.values()]
        elif isinstance(value, list):
            to_count += value
        size += len(value) if isinstance(value, str) else 1
    return size


def _may_serve(id_: str, entry_point: object) -> bool:
    """Return, by where an environment comes from and without making it, whether it is worth suggesting.

    Of Gymnasium's own, few have states and actions that are discrete or few real numbers.
    """
    entry = str(entry_point)
    if id_.startswith(OWN_IDS):
        return False
    return entry.startswith(SMALL) or not entry.startswith(("gymnasium.", "<"))


def reason_of(error: BaseException) -> str:
    """Return what an environment raised, in one line of at most 200 characters that is safe to print."""
    name, text = type(error).__name__, text_of(error)
    return one_line(f"{name}: {text}" if text else name, LONGEST_REASON)


def text_of(thing: object) -> str:
    """Return the text of what comes from an environment, which may fail at that too."""
    try:
        return str(thing)
    except Exception:
        return f"a {type(thing).__name__} that cannot be written"


def time_limit_of(environment: Env[Any, Any]) -> int:
    """Return after how many steps its registration truncates an episode, 0 for never.

    Raises WorldRefusedError where that is no number of steps.
    """
    most_steps = environment.spec.max_episode_steps if environment.spec else None
    limit = 0 if most_steps is None else most_steps
    if not isinstance(limit, int) or isinstance(limit, bool) or not 0 <= limit <= LONGEST_TIME_LIMIT:
        expected = f"a whole number from 0 to {LONGEST_TIME_LIMIT:,}"
        raise WorldRefusedError(("kwargs", "max_episode_steps"), shown(limit), expected)
    return limit
