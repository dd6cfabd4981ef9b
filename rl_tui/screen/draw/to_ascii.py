"""Texts in the terminal's characters."""

from __future__ import annotations

import re
from typing import Final

from rl_tui.screen.theme.glyphs import Glyphs

# Pairs: a character, then its spelling
_SPELLINGS: Final = """
α alpha   γ gamma   ε epsilon   δ delta   θ theta   λ lambda   τ tau   π pi   σ sigma   μ mu   Σ sum
− -   – -   — -   … ...   · *   × x   ′ '   ’ '   ‘ '   “ "   ” "
← <-   → ->   ↑ ^   ↓ v   ↖ ^<   ↗ ^>   ↙ v<   ↘ v>
₀ 0   ₁ 1   ₂ 2   ₃ 3   ₙ n   ₜ t   ₊ +   ⁿ ^n   ᵀ ^T
⁰ 0   ¹ ^1   ² ^2   ³ ^3   ⁵ ^5   ⁶ ^6   ⁷ ^7   ⁺ +   ⁻ -
√ sqrt   ≤ <=   ≥ >=   ≈ ~   ≠ !=   ± +/-   ∞ inf   ⟨ <   ⟩ >
◤ x   ▫ .   ✓ v   ✗ x   ★ G   ● O   ◉ @   ▸ >   ◆ +   ▾ v   ↻ T   ╱ %
┃ |   ╍ :   ┆ Y   █ #   ┈ .   ░ :   • "   ◦ '
¼ 1/4   ½ 1/2   ¾ 3/4   ⅓ 1/3   ⅔ 2/3   é e   ö o   ü u   ä a
"""
_WORDS: Final = _SPELLINGS.split()
_SPELLED: Final = dict(zip(_WORDS[::2], _WORDS[1::2], strict=True)) | {"\u0304": "bar"}

# · alone is a product sign, but after a comma it means any action, as in max Q(s',a)
_ANY_ACTION: Final = (",·)", ",a)")
# A spelled-out letter needs a blank before its factor: gamma V, delta e
_FACTOR: Final = re.compile(r"([αγεδθλτπσμΣ])(?=[A-Za-zα-ω])")


def to_ascii(text: str, glyphs: Glyphs) -> str:
    """Write ASCII if ``glyphs`` is the ASCII set. Unknown characters become ``?``."""
    if glyphs.name != "ascii":
        return text
    apart = _FACTOR.sub(r"\1 ", text.replace(*_ANY_ACTION))
    spelled = "".join(_SPELLED.get(character, character) for character in apart)
    return spelled.encode("ascii", "replace").decode("ascii")


def separated(text: str, glyphs: Glyphs) -> str:
    """Return :func:`to_ascii`, with dots as separators."""
    return to_ascii(text.replace(" · ", " – "), glyphs) if glyphs.name == "ascii" else text
