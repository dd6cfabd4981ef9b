"""Tests are of one kind each, and are found by what they are about."""

from __future__ import annotations

import pytest
from kinds import KINDS, about

pytestmark = pytest.mark.unit


def test_each_test_is_of_one_kind(request: pytest.FixtureRequest) -> None:
    for item in request.session.items:
        assert sum(item.get_closest_marker(kind) is not None for kind in KINDS) == 1, item.nodeid


def test_a_module_has_the_tests_that_import_it(request: pytest.FixtureRequest) -> None:
    found = about(request.session.items, "KINDS")
    assert {item.path.name for item in found} == {"test_kinds.py"}


def test_what_no_test_is_about_is_said_with_what_is_near(request: pytest.FixtureRequest) -> None:
    with pytest.raises(pytest.UsageError, match="no test is about 'test-kindz': see rl-tui list"):
        about([], "test-kindz")
    with pytest.raises(pytest.UsageError, match="no test is about 'kin'"):
        about([request.node], "kin")
