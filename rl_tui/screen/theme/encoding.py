"""Which characters a terminal takes, by what its environment says."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

_PLAIN: Final = ("C", "POSIX")
_PUT_THERE_BY_PYTHON: Final = "C.UTF-8"


def encoding_of(environ: Mapping[str, str], encoding: str | None, *, utf8_mode: bool) -> str | None:
    """Return the encoding that the locale names, or ``encoding``, that of Python's output, if it names none.

    Python writes UTF-8 in the locales C and POSIX whatever the terminal takes (``utf8_mode``), and sets
    LC_CTYPE to say so: PEP 538 and 540. A person who asks for C asks for ASCII.
    """
    character_type = environ.get("LC_CTYPE", "")
    if utf8_mode and character_type == _PUT_THERE_BY_PYTHON:
        character_type = ""
    name = environ.get("LC_ALL") or character_type or environ.get("LANG") or ""
    if name in _PLAIN:
        return "ascii"
    _, _, named = name.partition("@")[0].partition(".")
    return named or encoding
