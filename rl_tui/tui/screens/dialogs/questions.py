"""What a prompt asks for: the seed, or the number of a hyper-parameter."""

from __future__ import annotations

from typing import Any

from rl_tui.agents.hyperparameters import PARAMETERS, SAMPLE_AVERAGE, Parameter
from rl_tui.tui.draw.to_ascii import to_ascii
from rl_tui.tui.panels.controls.settings import option_text
from rl_tui.tui.panels.controls.slider_scale import parsed
from rl_tui.tui.screens.dialogs.choice import word_choice
from rl_tui.tui.screens.dialogs.dialog import Dialog
from rl_tui.tui.screens.dialogs.prompt import Prompt
from rl_tui.tui.theme.glyphs import Glyphs

_EXAMPLES = {"initial_q": "0 or 2.5"}


def ask_value(name: str, value: float | str, glyphs: Glyphs, *, another_run: bool = False) -> Dialog[Any]:
    """Return what asks for a number or a word for ``name``; in all else as :func:`ask_number`."""
    if PARAMETERS[name].range is None:
        return word_choice(name, value, glyphs)
    return ask_number(name, value, glyphs, another_run=another_run)


def ask_number(name: str, value: float | str, glyphs: Glyphs, *, another_run: bool = False) -> Prompt:
    """Return the prompt for the hyper-parameter ``name``, whose ``value`` is in force.

    ``another_run`` tells that the value is for one beside this one.
    """
    parameter = PARAMETERS[name]
    starts = "; the run starts again" if name == "initial_q" and not another_run else ""
    word = "; 1/N is the sample average" if SAMPLE_AVERAGE in parameter.words else ""

    def read(text: str) -> float | str:
        try:
            return parsed(text, parameter)
        except ValueError:
            raise ValueError(to_ascii(_expected(parameter), glyphs)) from None

    title = "Initial Q" if name == "initial_q" else parameter.symbol
    hint = f"{parameter.help}{word}{starts}"
    return Prompt(to_ascii(title, glyphs), to_ascii(hint, glyphs), option_text(value), read)


def ask_seed(seed: int) -> Prompt:
    """Return the prompt for the seed; ``seed`` is the one in force."""
    hint = "the same seed gives the same run; the run starts again"
    return Prompt("Seed", hint, str(seed), _read_seed)


def _expected(parameter: Parameter) -> str:
    """Return what to type, naming the range."""
    if parameter.name in _EXAMPLES and parameter.range is not None:
        ends = f"from {parameter.range.low:g} to {parameter.range.high:g}".replace("e+", "e")
        return f"type a number {ends}, such as {_EXAMPLES[parameter.name]}"
    return f"type {parameter.expected_in_words}"


def _read_seed(text: str) -> int:
    """Return the whole number in ``text``; raises ValueError saying what it may be."""
    if not (text.isascii() and text.isdigit()):
        raise ValueError("type a whole number, 0 or more")
    return int(text)
