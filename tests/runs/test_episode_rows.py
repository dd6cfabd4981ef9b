"""Rows of episodes on a full disk."""

from __future__ import annotations

import resource
from collections.abc import Iterator
from pathlib import Path
from typing import TextIO

import pytest

from rl_tui.common.errors import UserError
from rl_tui.runs.training.episode_rows import HEADER, csv_file

MOST = 10_000  # bytes
MANY = ["1,1,0.0,10\n"] * 2_000


@pytest.fixture
def small_disk() -> Iterator[None]:
    """Limit files to a few bytes, which fails like a full disk."""
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


@pytest.mark.usefixtures("small_disk")
def test_neither_a_link_nor_what_it_leads_to_is_removed(tmp_path: Path) -> None:
    target, link = tmp_path / "target.csv", tmp_path / "link.csv"
    target.touch()
    link.symlink_to(target)
    with pytest.raises(UserError, match=r"link\.csv: cannot be written"), csv_file(link) as stream:
        stream.writelines(MANY)
    assert link.is_symlink()
    assert target.is_file()


@pytest.mark.usefixtures("small_disk")
def test_what_was_put_in_its_place_meanwhile_is_not_removed(tmp_path: Path) -> None:
    path, other = tmp_path / "rows.csv", tmp_path / "other.csv"
    other.write_text("of somebody else")

    def write(stream: TextIO) -> None:
        other.replace(path)
        stream.writelines(MANY)

    with pytest.raises(UserError, match="cannot be written"), csv_file(path) as stream:
        write(stream)
    assert path.read_text() == "of somebody else"
