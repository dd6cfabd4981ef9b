"""The colours of borders, lists and boxes: one dark theme and one light one, besides those of Textual."""

from __future__ import annotations

from typing import Final

from textual.theme import Theme

DARK: Final = Theme(
    name="dark",
    primary="#6cb6eb",
    secondary="#8fb8b0",
    accent="#f0b45f",
    foreground="#dde3e8",
    background="#0e1318",
    surface="#151c23",
    panel="#1f2932",
    success="#7fc8a9",
    warning="#e8c267",
    error="#f08a7a",
    dark=True,
    variables={
        "border": "#6cb6eb",
        "border-blurred": "#3d4a56",
        "scrollbar": "#4a5a68",
        "scrollbar-background": "#151c23",
    },
)

LIGHT: Final = Theme(
    name="light",
    primary="#00629b",
    secondary="#3d6b64",
    accent="#9a5b00",
    foreground="#1d242a",
    background="#fbfbf9",
    surface="#f2f2ee",
    panel="#e4e5e0",
    success="#1c7a52",
    warning="#8a6400",
    error="#b3261e",
    dark=False,
    variables={
        "border": "#00629b",
        "border-blurred": "#a8b0b6",
        "scrollbar": "#a8b0b6",
        "scrollbar-background": "#e9eae5",
    },
)
