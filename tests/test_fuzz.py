"""The first hundreds of inputs of fuzz.py."""

from __future__ import annotations

import pytest
from fuzz import fuzz
from fuzz_inputs import LESSON, SCENARIO, SESSION


@pytest.mark.exhaustive("tries hundreds of files")
@pytest.mark.parametrize(("kind", "count"), [(SCENARIO, 300), (SESSION, 200), (LESSON, 300)])
def test_whatever_a_file_holds_it_is_used_or_refused_in_one_line(kind, count):
    figures = fuzz(kind, count, seed=0, screens=0, quick=True)
    assert figures.found == []
    assert figures.inputs == count
    accepted = sum(number for result, number in figures.results.items() if result.startswith("accepted"))
    assert count / 20 < accepted < count / 2, "inputs of both kinds, or it tests little"
