"""What a prompt asks for before a run starts again: the initial Q, the seed."""

from __future__ import annotations

from rl_tui.agents.hyperparameters import PARAMETERS
from rl_tui.tui.screens.prompt import Prompt


def ask_initial_q(value: float) -> Prompt:
    """Return the prompt for what every estimate starts from; ``value`` is the one in force."""
    hint = f"{PARAMETERS['initial_q'].help}; the run starts again"
    return Prompt("Initial Q", hint, f"{value:g}", _read_initial_q)


def ask_seed(seed: int) -> Prompt:
    """Return the prompt for the seed; ``seed`` is the one in force."""
    hint = "the same seed gives the same run; the run starts again"
    return Prompt("Seed", hint, str(seed), _read_seed)


def _read_initial_q(text: str) -> float:
    """Return the number in ``text``; raises ValueError naming the range."""
    parameter = PARAMETERS["initial_q"]
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not parameter.accepts(value):
        ends = f" from {parameter.range.low:g} to {parameter.range.high:g}" if parameter.range else ""
        raise ValueError(f"type a number{ends}, such as 0 or 2.5".replace("e+", "e"))
    return value


def _read_seed(text: str) -> int:
    """Return the whole number in ``text``; raises ValueError saying what it may be."""
    if not (text.isascii() and text.isdigit()):
        raise ValueError("type a whole number, 0 or more")
    return int(text)
