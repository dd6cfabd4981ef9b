"""Pictures without a terminal."""

from __future__ import annotations

from pathlib import Path

import pytest
from called import assert_refused, called
from shipped import shipped_lessons

from rl_tui.live.sessions.place import session_folder


def picture(tmp_path: Path, name: str, *args: str) -> bytes:
    file = tmp_path / name
    result = called("screenshot", *args, "--out", file)
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


@pytest.mark.parametrize(
    "call",
    [
        *(
            ("--lesson", "loop", *more)
            for more in (("student",), ("--seed", "3"), ("--alpha", "0.1"), ("--big",))
        ),
        ("--lesson", "loop", "--watch", "a.py"),
        ("--lesson", "loop", "--panels", "few"),
        ("student", "--panels", "world,curv"),
        ("student", "--panels", ""),
    ],
)
def test_what_a_lesson_or_a_picture_does_not_have_is_refused(call: tuple[str, ...]) -> None:
    result = called("screenshot", *call, "--out", "-")
    assert (result.exit_code, result.stdout, result.stderr.count("\n")) == (2, "", 1)


@pytest.mark.screen
def test_it_may_begin_with_few_panels_or_with_the_world_alone(tmp_path: Path) -> None:
    call = ("frozenlake", "--size", "80x24")
    pressed, big = (picture(tmp_path, "a.svg", *call, *more) for more in (("--keys", "f"), ("--big",)))
    assert pressed == big
    few, named = (picture(tmp_path, "a.svg", *call, "--panels", each) for each in ("few", "world,table"))
    assert b"Nothing&#160;is&#160;learned" in few
    assert b"discount" not in named


def test_an_unknown_theme_is_refused() -> None:
    assert_refused(called("screenshot", "student", "--theme", "beige", "--out", "-"), 1, "beige")


def test_a_session_given_by_its_name_is_refused_with_its_path() -> None:
    path = session_folder() / "my-run.json"
    path.parent.mkdir(parents=True)
    path.touch()
    assert_refused(called("screenshot", "my-run", "--out", "-"), 1, str(path))
    assert "session" not in called("screenshot", "my-walk", "--out", "-").stderr
