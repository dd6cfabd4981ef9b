"""Colours of pictures and curves."""

from __future__ import annotations

from itertools import combinations, pairwise

import pytest
from colour_vision import contrast, least_distance, luminance
from rich.color import Color

from rl_tui.commands.reports.picture_text import COLOURS_256
from rl_tui.studies.pictures import colours

WHITE, BLACK = Color.parse("#ffffff"), Color.parse("#000000")
IN_FILES = [Color.parse(each) for each in colours.LINES]
IN_TERMINALS = [Color.parse(f"color({each})") for each in COLOURS_256]


def test_lines_are_seen_on_their_background() -> None:
    assert min(contrast(each, WHITE) for each in IN_FILES) >= 3
    assert min(contrast(each, ground) for each in IN_TERMINALS for ground in (WHITE, BLACK)) >= 2.8


def test_colour_blind_eyes_tell_lines_apart() -> None:
    for lines in (IN_FILES, IN_TERMINALS):
        assert min(least_distance(*couple) for couple in combinations(lines, 2)) > 23


def test_lines_beyond_the_colours_differ_in_their_dashes() -> None:
    looks = [(colours.line_colour(place), colours.line_dash(place, dashed=False)) for place in range(14)]
    assert len(set(looks)) == 14
    assert colours.line_dash(0, dashed=True) != colours.line_dash(0, dashed=False)


def test_texts_are_readable() -> None:
    for name in (colours.TEXT, colours.DIM):
        assert contrast(Color.parse(name), WHITE) >= 4.5
    shares = [place / 100 for place in range(101)]
    for share in shares:
        text, ground = colours.text_on_ramp(share), colours.ramp_colour(share)
        assert contrast(Color.parse(text), Color.parse(ground)) >= 4.5
    assert colours.contrast(colours.LINES[0], "#ffffff") == pytest.approx(
        contrast(IN_FILES[0], WHITE), rel=1e-3
    )


def test_the_ramp_gets_darker_all_the_way_and_its_steps_are_seen_by_all_eyes() -> None:
    ramp = [Color.parse(each) for each in colours.RAMP]
    brightness = [luminance(each) for each in ramp]
    assert brightness == sorted(brightness, reverse=True)
    assert min(least_distance(*neighbours) for neighbours in pairwise(ramp)) > 3
    assert (colours.ramp_colour(-1.0), colours.ramp_colour(2.0)) == (colours.RAMP[0], colours.RAMP[-1])
    assert colours.ramp_colour(0.1) == colours.RAMP[1]
