"""The characters that an environment requests."""

from __future__ import annotations

import pytest

from rl_tui.screen.theme.glyphs import encoding_of


@pytest.mark.parametrize(
    ("environ", "utf8_mode", "encoding"),
    [
        ({"LANG": "C", "LC_CTYPE": "C.UTF-8"}, True, "ascii"),  # Python's reading of LANG=C
        ({"LC_ALL": "C"}, True, "ascii"),
        ({"LC_ALL": "POSIX", "LANG": "en_GB.UTF-8"}, True, "ascii"),
        ({"LANG": "C", "LC_CTYPE": "C.UTF-8"}, False, "UTF-8"),
        ({"LANG": "C", "LC_CTYPE": "en_GB.UTF-8"}, False, "UTF-8"),
        ({"LC_ALL": "C.UTF-8", "LANG": "C"}, False, "UTF-8"),
        ({"LANG": "de_DE.ISO-8859-15@euro"}, False, "ISO-8859-15"),
        ({"LANG": "en_GB"}, False, "latin-1"),
        ({"LC_CTYPE": "C.UTF-8"}, True, "latin-1"),  # without any setting
        ({}, False, "latin-1"),
    ],
)
def test_the_locale_names_the_encoding(environ: dict[str, str], utf8_mode: bool, encoding: str) -> None:
    assert encoding_of(environ, "latin-1", utf8_mode=utf8_mode) == encoding
