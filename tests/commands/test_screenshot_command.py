"""Pictures without a terminal: the same call gives the same bytes."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner

from rl_tui.commands.main import program
from rl_tui.lessons.catalogue import shipped_lessons


def picture(tmp_path: Path, name: str, *args: str) -> bytes:
    file = tmp_path / name
    result = CliRunner().invoke(program, ["screenshot", *args, "--out", str(file)])
    assert (result.exit_code, result.stdout, result.stderr) == (0, "", "")
    return file.read_bytes()


@pytest.mark.screen
def test_without_a_scenario_it_is_the_catalogue(tmp_path: Path) -> None:
    assert b"Begin here" in picture(tmp_path, "a.svg", "--size", "80x24").replace(b"&#160;", b" ")


@pytest.mark.screen
def test_a_lesson_is_shown_at_its_first_page_and_goes_on_by_keys(tmp_path: Path) -> None:
    lesson = shipped_lessons()[0]
    call = ("--lesson", lesson.id, "--size", "120x40")
    first, second = picture(tmp_path, "a.svg", *call), picture(tmp_path, "b.svg", *call)
    assert first == second
    assert lesson.pages[0].title in first.decode().replace("&#160;", " ")
    turned = picture(tmp_path, "c.svg", *call, "--keys", ".").decode().replace("&#160;", " ")
    assert lesson.pages[1].title in turned


@pytest.mark.parametrize("more", [("student",), ("--seed", "3"), ("--alpha", "0.1"), ("--watch", "a.py")])
def test_a_lesson_brings_its_own_runs(more: tuple[str, ...]) -> None:
    result = CliRunner().invoke(program, ["screenshot", "--lesson", "loop", *more, "--out", "-"])
    assert (result.exit_code, result.stdout, result.stderr.count("\n")) == (2, "", 1)


@pytest.mark.parametrize(
    "call",
    [
        ("student", "--panels", "world,curv"),
        ("student", "--panels", ""),
        ("--lesson", "loop", "--panels", "few"),
        ("--lesson", "loop", "--big"),
    ],
)
def test_panels_that_there_are_not_here_are_refused(call: tuple[str, ...]) -> None:
    result = CliRunner().invoke(program, ["screenshot", *call, "--out", "-"])
    assert (result.exit_code, result.stdout, result.stderr.count("\n")) == (2, "", 1)


@pytest.mark.screen
def test_it_may_begin_with_few_panels_or_with_the_world_alone(tmp_path: Path) -> None:
    call = ("frozenlake", "--size", "80x24")
    pressed, big = (picture(tmp_path, "a.svg", *call, *more) for more in (("--keys", "f"), ("--big",)))
    assert pressed == big
    few, named = (picture(tmp_path, "a.svg", *call, "--panels", each) for each in ("few", "world,table"))
    assert b"Nothing&#160;is&#160;learned" in few
    assert b"discount" not in named


@pytest.mark.screen
def test_stdout_takes_the_picture() -> None:
    result = CliRunner().invoke(program, ["screenshot", "student", "--size", "80x24", "--out", "-"])
    assert result.exit_code == 0
    assert result.stdout.startswith("<svg")


def test_an_unknown_theme_is_refused() -> None:
    result = CliRunner().invoke(program, ["screenshot", "student", "--theme", "beige", "--out", "-"])
    assert result.exit_code == 1
    assert "beige" in result.stderr
    assert result.stderr.count("\n") == 1
