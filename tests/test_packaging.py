"""The wheel and the sdist."""

from __future__ import annotations

import os
import re
import runpy
import subprocess
import sys
import tarfile
import zipfile
from email import message_from_string
from email.message import Message
from pathlib import Path

import pytest

import rl_tui

ROOT = Path(__file__).parents[1]
SCENARIOS = {path.name for path in (ROOT / "scenarios").glob("*.toml")}
LESSONS = {path.name for path in (ROOT / "lessons").glob("*.toml")}
VERSION = rl_tui.__version__
README = (ROOT / "README.md").read_text(encoding="utf-8")
LINK = re.compile(r"(!?)\[[^\]]*\]\(([^)]+)\)")
EPOCH = "1700000000"


def build(source: Path, target: Path, *what: str) -> None:
    subprocess.run(
        [sys.executable, "-m", "build", "--no-isolation", *what, "--outdir", str(target), str(source)],
        check=True,
        capture_output=True,
        env=os.environ | {"SOURCE_DATE_EPOCH": EPOCH},
    )


@pytest.fixture(scope="module")
def dist(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("dist")
    build(ROOT, folder, "--wheel", "--sdist")
    return folder


def wheel_in(folder: Path) -> Path:
    return folder / f"rl_tui-{VERSION}-py3-none-any.whl"


def sdist_in(folder: Path) -> Path:
    return folder / f"rl_tui-{VERSION}.tar.gz"


def names_in(wheel: Path) -> set[str]:
    with zipfile.ZipFile(wheel) as archive:
        return set(archive.namelist())


def test_the_wheel_holds_package_styles_scenarios_and_lessons_and_nothing_else(dist: Path) -> None:
    names = names_in(wheel_in(dist))
    assert {f"rl_tui/scenarios/{name}" for name in SCENARIOS} <= names
    assert LESSONS
    assert {f"rl_tui/lessons/{name}" for name in LESSONS} <= names
    assert "rl_tui/docs/lake.py" in names
    assert {"rl_tui/py.typed", "rl_tui/commands/main.py", "rl_tui/screen/glossary/glossary.toml"} <= names
    styles = {path.relative_to(ROOT).as_posix() for path in (ROOT / "rl_tui").glob("**/*.tcss")}
    assert styles
    assert styles <= names
    script_texts = {path.relative_to(ROOT).as_posix() for path in (ROOT / "rl_tui").glob("**/*.py.txt")}
    assert "rl_tui/agents/algorithms/q_learning.py.txt" in script_texts
    assert script_texts <= names
    assert {name.split("/")[0] for name in names} == {"rl_tui", f"rl_tui-{VERSION}.dist-info"}
    assert not any("__pycache__" in name for name in names)


def metadata_of(wheel: Path) -> Message:
    with zipfile.ZipFile(wheel) as archive:
        return message_from_string(archive.read(f"rl_tui-{VERSION}.dist-info/METADATA").decode())


@pytest.fixture
def source(dist: Path, tmp_path: Path) -> Path:
    """Return the sdist, unpacked, with another time and mode of each file."""
    with tarfile.open(sdist_in(dist)) as archive:
        # before Python 3.11.4 there are no filters
        archive.extractall(tmp_path, **({"filter": "data"} if hasattr(tarfile, "data_filter") else {}))
    source = tmp_path / f"rl_tui-{VERSION}"
    for path in source.rglob("*"):
        os.utime(path, (10**9, 10**9))
        path.chmod(0o700 if path.is_dir() else 0o600)
    return source


@pytest.mark.exhaustive("builds both once more")
def test_the_sdist_is_enough_to_build_both_again_with_the_same_bytes(
    dist: Path, source: Path, tmp_path: Path
) -> None:
    assert {path.name for path in (source / "scenarios").glob("*.toml")} == SCENARIOS
    assert {path.name for path in (source / "lessons").glob("*.toml")} == LESSONS
    for name in ("README.md", "LICENSE", "CHANGELOG.md", "SECURITY.md", "CITATION.cff", "tests", "examples"):
        assert (source / name).exists()
    build(source, tmp_path / "again", "--wheel", "--sdist")
    for place in (wheel_in, sdist_in):
        assert place(tmp_path / "again").read_bytes() == place(dist).read_bytes()


def test_as_long_as_no_repository_is_known_the_index_shows_the_readme_as_it_is(dist: Path) -> None:
    metadata = metadata_of(wheel_in(dist))
    assert metadata["Description-Content-Type"] == "text/markdown"
    assert str(metadata.get_payload()).rstrip() == README.rstrip()
    assert metadata.get_all("Project-URL") is None


@pytest.mark.exhaustive("builds the wheel once more")
def test_one_address_in_pyproject_is_enough_for_an_index(source: Path, tmp_path: Path) -> None:
    project = source / "pyproject.toml"
    text = project.read_text(encoding="utf-8")
    empty = '\nrepository = ""\n'
    assert text.count(empty) == 1
    project.write_text(
        text.replace(empty, '\nrepository = "https://example.org/me/rl-tui/"\n'), encoding="utf-8"
    )
    build(source, tmp_path / "known", "--wheel")
    metadata = metadata_of(wheel_in(tmp_path / "known"))
    assert f"](https://example.org/me/rl-tui/raw/v{VERSION}/docs/playground.svg)" in str(
        metadata.get_payload()
    )
    assert "Issues, https://example.org/me/rl-tui/issues" in metadata.get_all("Project-URL", [])


def test_links_of_the_index_point_at_the_same_files_of_the_repository() -> None:
    absolute = runpy.run_path(str(ROOT / "hatch_build.py"))["absolute"]
    before, after = (LINK.findall(text) for text in (README, absolute(README, "https://a.b/c", "v1")))
    assert any(mark for mark, _ in before)
    for (mark, link), (same_mark, other) in zip(before, after, strict=True):
        is_outside = re.match(r"\w+:|#", link)
        kind = "raw" if mark else "blob"
        assert (same_mark, other) == (mark, link if is_outside else f"https://a.b/c/{kind}/v1/{link}")
        assert is_outside or (ROOT / link).exists()


def test_all_name_the_same_version() -> None:
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    newest = re.search(r"^## \[(.+)\] - (.+)$", changes, re.MULTILINE)
    assert newest
    assert newest[1] == VERSION
    assert f"\nversion: {newest[1]}\ndate-released: {newest[2]}\n" in citation
    assert len(changes.splitlines()) <= 150
