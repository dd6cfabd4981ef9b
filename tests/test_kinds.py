"""Every test has one kind and a subject."""

from __future__ import annotations

import pytest
from kinds import KINDS, TESTS, about, may_be_about

pytestmark = pytest.mark.unit


def test_each_test_is_of_one_kind(request: pytest.FixtureRequest) -> None:
    for item in request.session.items:
        assert sum(item.get_closest_marker(kind) is not None for kind in KINDS) == 1, item.nodeid


def test_an_exhaustive_test_says_why(request: pytest.FixtureRequest) -> None:
    for item in request.session.items:
        mark = item.get_closest_marker("exhaustive")
        assert mark is None or (len(mark.args) == 1 and mark.args[0]), item.nodeid


@pytest.mark.parametrize(
    ("subject", "file"),
    [
        ("exhaustive", "test_kinds.py"),  # the text names it
        ("prioritized-sweeping", "agents/test_batches.py"),  # a row of the catalogue of algorithms
        ("softmax", "agents/test_policies.py"),
    ],
)
def test_a_file_is_chosen_by_its_text_or_by_the_catalogue_that_it_goes_through(
    subject: str, file: str
) -> None:
    assert may_be_about(TESTS / file, subject)
    assert not may_be_about(TESTS / "studies" / "statistics" / "test_comparison.py", subject)


def test_a_module_has_the_tests_that_import_it(request: pytest.FixtureRequest) -> None:
    found = about(request.session.items, "KINDS")
    assert {item.path.name for item in found} == {"test_kinds.py"}


def test_what_no_test_is_about_is_said_with_what_is_near(request: pytest.FixtureRequest) -> None:
    with pytest.raises(pytest.UsageError, match="no test is about 'test-kindz': see rl-tui list"):
        about([], "test-kindz")
    with pytest.raises(pytest.UsageError, match="no test is about 'kin'"):
        about([request.node], "kin")
