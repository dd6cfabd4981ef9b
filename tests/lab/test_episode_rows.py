"""Rows of episodes on a disk that is full."""

from __future__ import annotations

import resource
from collections.abc import Iterator
from pathlib import Path
from typing import TextIO

import pytest

from rl_tui.lab.episode_rows import HEADER, csv_file
from rl_tui.worlds.errors import UserError

MOST = 10_000  # bytes


@pytest.fixture
def small_disk() -> Iterator[None]:
    """No file can become larger than a few bytes, which fails as a full disk does."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (MOST, hard))
    yield
    resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


@pytest.mark.usefixtures("small_disk")
@pytest.mark.parametrize("rows", [2, 2_000])
def test_a_file_that_cannot_be_written_to_its_end_is_not_left(tmp_path: Path, rows: int) -> None:
    path = tmp_path / "rows.csv"
    with (
        pytest.raises(UserError, match=r"rows\.csv: cannot be written \(File too large\)$"),
        csv_file(path) as stream,
    ):
        stream.writelines(["1,1,0.0,10\n" * 1_000] * rows)
    assert not path.exists()


def test_a_device_is_not_removed() -> None:
    with (
        pytest.raises(UserError, match=r"^/dev/full: cannot be written \(No space left on device\)$"),
        csv_file(Path("/dev/full")),
    ):
        pass
    assert Path("/dev/full").is_char_device()


def test_what_was_written_is_kept_where_something_else_fails(tmp_path: Path) -> None:
    path = tmp_path / "rows.csv"

    def fail(stream: TextIO) -> None:
        stream.write("1,1,0.0,10\n")
        raise UserError("it breaks down")

    with pytest.raises(UserError, match="breaks"), csv_file(path) as stream:
        fail(stream)
    assert path.read_text() == f"{HEADER}1,1,0.0,10\n"
