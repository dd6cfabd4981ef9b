"""What the scripts of planners and of learners have in common."""

from __future__ import annotations

from importlib import import_module
from typing import Any, Final

from rl_tui.common.errors import UserError
from rl_tui.lab.export.settings_text import Told
from rl_tui.lab.export.template import fill
from rl_tui.lab.export.worlds.text import WorldText

BEGIN_WORLD: Final = "env.reset(seed=SEED)  # the randomness of the world"
_RANDOM_TIES: Final = """def argmax(values):
    # The place of the greatest value; one of equals is drawn. (np.argmax takes the first of them,
    # and where all values are equal, as at the start, an agent may then never get anywhere.)
    return int(rng.choice(np.flatnonzero(values == values.max())))"""
_FIRST_OF_TIES: Final = """def argmax(values):
    # The place of the greatest value; of equals the first
    return int(np.argmax(values))"""


def template(package: str, name: str) -> Any:
    """Return the module of texts of an algorithm (``algorithms``) or of an action rule (``rules``).

    Raises UserError where nobody has written them yet.
    """
    try:
        return import_module(f"rl_tui.lab.export.{package}.{name.replace('-', '_')}")
    except ModuleNotFoundError as error:
        raise UserError(f"there is no script for {name} yet") from error


def argmax(told: Told) -> str:
    """Return the function that finds the best action, with the ties that are told."""
    return _RANDOM_TIES if told.values.ties == "random" else _FIRST_OF_TIES


def report(text: WorldText, told: Told) -> str:
    """Return what prints the policy; values that a planner has worked out are equal but for rounding."""
    worked_out = "np.isclose(values, values.max(), rtol=0, atol=1e-6)"
    equals = worked_out if told.planner else "values == values.max()"
    return fill(text.report, {**text.report_pieces, "equals": equals})
