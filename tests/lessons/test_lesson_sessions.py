"""A lesson in a session file."""

# ruff: noqa: E501

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from fuzz_seeds import signed
from lesson_sessions import TEXT, all_done, lesson, record, run_of, setup, taken, write
from shipped import shipped_lessons

from rl_tui.common.errors import UserError
from rl_tui.lessons.file.view import Given, begun
from rl_tui.lessons.lesson import lesson_folder, lesson_of
from rl_tui.live.sessions.document import VERSION
from rl_tui.live.sessions.replay import replay_target, replayed
from rl_tui.live.sessions.session import SessionError, encoded, read_session

# In the format before there were lessons
OLD = r"""{"format": "rl-tui session", "version": 1, "program": "0.1.0", "title": "old", "kept": true, "saved": "2026-11-23T18:52:51Z", "scenario": {"id": "two", "kind": "file", "title": "Two", "text": "title = \"Two\"\n[mdp]\nstart = \"a\"\ntransition = [\n  { state = \"a\", action = \"stay\", reward = -1, to = \"a\" },\n  { state = \"a\", action = \"go\", reward = 2, to = \"end\" },\n]\n"}, "lanes": [{"seed": 7, "algorithm": "q-learning", "hyperparameters": {"alpha": 0.1, "step_size_schedule": "exponential", "alpha_min": 0.0, "alpha_decay": 0.0, "gamma": 0.99, "policy": "epsilon-greedy", "epsilon": 0.1, "epsilon_schedule": "exponential", "epsilon_min": 0.0, "epsilon_decay": 0.0, "temperature": 0.1, "confidence": 2.0, "baseline": "mean", "lambda": 0.9, "traces": "replacing", "n": 4, "planning_steps": 10, "threshold": 0.0001, "accuracy": 1e-09, "initial_q": 0.0, "ties": "random"}, "branches": [{"name": "branch 1", "parent": null, "fork": 0, "end": 40, "here": 40, "shared": 0, "journal": [{"step": 0, "set": "alpha", "to": 0.5}, {"step": 3, "take": 1}]}, {"name": "branch 2", "parent": 0, "fork": 2, "end": 20, "here": 10, "shared": 1, "journal": [{"step": 2, "algorithm": "sarsa"}]}], "branch": 1}, {"seed": 7, "algorithm": "sarsa", "hyperparameters": {"alpha": 0.1, "step_size_schedule": "exponential", "alpha_min": 0.0, "alpha_decay": 0.0, "gamma": 0.99, "policy": "epsilon-greedy", "epsilon": 0.1, "epsilon_schedule": "exponential", "epsilon_min": 0.0, "epsilon_decay": 0.0, "temperature": 0.1, "confidence": 2.0, "baseline": "mean", "lambda": 0.9, "traces": "replacing", "n": 4, "planning_steps": 10, "threshold": 0.0001, "accuracy": 1e-09, "initial_q": 0.0, "ties": "random"}, "branches": [{"name": "branch 1", "parent": null, "fork": 0, "end": 0, "here": 0, "shared": 0, "journal": []}], "branch": 0}], "shown": 0, "breakpoints": {"states": [0], "pairs": []}, "speed": 5.0, "digest": "", "drawn": [[0, 1]], "answer_hidden": true, "table": {"q": [0.0, 1.0], "visits": [1, 2], "episodes": 3, "state": 0}, "checksum": "321178fda5cf09423b4215db9a361ef591ca7b701109d38b829cbd53a890dc88"}"""


def read(text: str, folder: Path) -> Any:
    path = folder / "mine.json"
    path.write_text(text, encoding="utf-8")
    return read_session(path)


def test_a_session_of_the_first_format_opens(tmp_path: Path) -> None:
    stored = read(OLD, tmp_path)
    opened = stored.record()
    assert (stored.title, stored.step, stored.algorithm, stored.changes) == ("old", 10, "sarsa", 3)
    assert opened.lesson is None
    assert [len(branch.journal) for branch in opened.lanes[0].branches] == [2, 2]
    assert opened.drawn.choices == ((0, 1),)
    run, _ = replayed(replay_target(opened))
    assert run.step == 10


def test_the_first_format_has_no_lessons(tmp_path: Path) -> None:
    fields = json.loads(encoded(record(begun(lesson()))))
    with pytest.raises(SessionError, match="format 1 has no lesson"):
        read(signed({**fields, "version": 1}), tmp_path)


def test_everything_comes_back(tmp_path: Path) -> None:
    done = all_done(lesson())
    stored = read_session(write(tmp_path, "a.json", done, run_of(setup(done.lesson, "lake"), 60)))
    back = stored.record().lesson
    assert back is not None
    assert stored.document.version == VERSION == 2
    assert (back.lesson.id, back.lesson.text, back.page) == ("evening", TEXT, "lake")
    assert (back.given, back.skipped, back.hints, back.finished) == (
        done.given,
        ("start",),
        (("go", 2),),
        True,
    )
    for evidence, before in zip(back.passed, done.passed, strict=True):
        assert (evidence.page, evidence.journal, evidence.step) == (before.page, before.journal, before.step)
        assert (evidence.claim, evidence.program) == (before.claim, before.program)
        assert evidence.recipe.scenario.section == before.recipe.scenario.section
        assert evidence.recipe.hyperparameters == before.recipe.hyperparameters
    assert stored.title == "An evening"


def test_it_goes_on_where_the_file_of_the_lesson_is_not(tmp_path: Path) -> None:
    taking = begun(lesson(str(tmp_path / "nowhere" / "evening.toml"))).open("guess")
    back = read_session(write(tmp_path, "a.json", taking)).record().lesson
    assert back is not None
    assert back.lesson.title == "An evening"
    assert back.lesson.source == tmp_path / "nowhere" / "evening.toml"


def test_of_a_shipped_lesson_no_path_is_kept(tmp_path: Path) -> None:
    shipped = shipped_lessons()[0]
    path = write(tmp_path, "a.json", begun(shipped))
    assert str(lesson_folder()) not in path.read_text(encoding="utf-8")
    back = read_session(path).record().lesson
    assert back is not None
    assert back.lesson.source == shipped.source


def test_a_variant_comes_back(tmp_path: Path) -> None:
    text = TEXT.replace("[figures]", '[variants]\nwhen = ["one", "two"]\n[figures]').replace(
        "Begin", "${when}"
    )
    second = lesson_of(text, Path("evening.toml"), "2")
    back = read_session(write(tmp_path, "a.json", begun(second))).record().lesson
    assert back is not None
    assert back.lesson.variant == "2"
    assert back.lesson.pages[0].title == "two"


def test_a_session_of_a_lesson_is_replayed_like_any_other(tmp_path: Path) -> None:
    of = lesson()
    stored = read_session(write(tmp_path, "a.json", all_done(of), run_of(setup(of), 40, taken(0, 1))))
    run, _ = replayed(replay_target(stored.record()))
    assert run.step == 40


SOUND = json.loads(encoded(record(all_done(lesson()))))
EVIDENCE = "passed.0"


def changed(place: str, value: Any) -> str:
    fields = json.loads(json.dumps(SOUND))
    holder: Any = fields["lesson"]
    *way, last = [int(step) if step.isdigit() else step for step in place.split(".")]
    for step in way:
        holder = holder[step]
    holder[last] = value
    return signed(fields)


REFUSED = {
    "no lesson at all": (lambda: changed("text", "hello"), "the lesson in it has an error: "),
    "a lesson without pages": (lambda: changed("text", TEXT[: TEXT.index("[[pages]]")]), "the lesson in it has an error: pages"),
    "a faulty lesson": (lambda: changed("text", TEXT.replace("minutes = 5", "minutes = -5")), "the lesson in it has an error: minutes"),
    "a lesson of 1 MB": (lambda: changed("text", "#" * 1_000_001), "at most 1000000"),
    "figures that grow": (
        lambda: changed("text", f'text = "{"{a}" * 300_000}"\n[figures]\na = {{ value = "{"x" * 9_000}", by = "1" }}'),
        "the lesson in it has an error: ",
    ),
    "variants that grow": (
        lambda: changed("text", f'text = "{"${a}" * 200_000}"\n[variants]\na = ["{"x" * 9_000}"]'),
        "the lesson in it has an error: variants",
    ),
    "placeholders of nothing": (lambda: changed("text", f'text = "{"{abc}" * 190_000}"\n[figures]\n' + "\n".join(f'f{n} = {{ value = "1", by = "1" }}' for n in range(290))), "the lesson in it has an error: "),
    "no such variant": (lambda: changed("text", "[variants]\na = [1]\n").replace('"variant": ""', '"variant": "7"'), "checksum"),
    "a variant that is not there": (
        lambda: signed({**SOUND, "lesson": {**SOUND["lesson"], "text": f"{TEXT}\n[variants]\na = [1]", "variant": "7"}}),
        "the lesson in it has an error: variants",
    ),
    "a path as id": (lambda: changed("id", "../../evening"), "the lesson's file has another name"),
    "another id": (lambda: changed("id", "morning"), "the lesson's file has another name"),
    "an id that moves the cursor": (lambda: changed("id", "\x1b[2J"), "lesson.id: U+001B is a control character"),
    "a source that moves the cursor": (lambda: changed("source", "\x1b[2J"), "lesson.source: U+001B"),
    "a title without end": (lambda: changed("title", "x" * 1_000), "lesson.title"),
    "a page that is not there": (lambda: changed("page", "guesses"), 'lesson.page: there is no such page as "guesses"'),
    "a page that asks nothing": (lambda: changed("given.0.page", "go"), "lesson.given: there is no such page"),
    "no such choice": (lambda: changed("given.1.answer", 2), "lesson.given[1].answer is 2.0; expected a choice, 0 to 1"),
    "half a choice": (lambda: changed("given.1.answer", 0.5), "lesson.given[1].answer"),
    "an answer that is none": (lambda: changed("given.0.answer", "x"), "lesson.given[0].answer"),
    "a digest that is none": (lambda: changed("given.0.digest", "abc"), "lesson.given[0].digest"),
    "a step before the first": (lambda: changed("given.0.step", -2), "lesson.given[0].step"),
    "answers without end": (lambda: changed("given", SOUND["lesson"]["given"] * 5_000), "at most 10000"),
    "a task that is none": (lambda: changed("passed.0.page", "guess"), "lesson.passed: there is no such page"),
    "tasks without end": (lambda: changed("passed", SOUND["lesson"]["passed"] * 400), "at most 1000"),
    "evidence of an unknown algorithm": (lambda: changed(f"{EVIDENCE}.algorithm", "luck"), 'lesson.passed[0].algorithm is "luck"'),
    "evidence of a setting out of range": (lambda: changed(f"{EVIDENCE}.hyperparameters.gamma", 2.0), "lesson.passed[0].hyperparameters: gamma"),
    "evidence of an unknown setting": (lambda: changed(f"{EVIDENCE}.hyperparameters.luck", 2.0), "no setting"),
    "evidence that no world is": (lambda: changed(f"{EVIDENCE}.scenario.text", "[mdp]"), "the scenario in it cannot be played"),
    "evidence of a module": (lambda: changed(f"{EVIDENCE}.scenario", {"id": "gym:os:X-v0", "kind": "gymnasium", "title": "t"}), "names a module"),
    "evidence beyond its end": (lambda: changed(f"{EVIDENCE}.step", 0), "lesson.passed[0].journal: step 1 is out of order, or beyond the end of the branch"),
    "evidence out of order": (lambda: changed(f"{EVIDENCE}.journal", [{"step": 1, "take": 0}, {"step": 0, "take": 0}]), "out of order"),
    "evidence of no change": (lambda: changed(f"{EVIDENCE}.journal", [{"step": 1}]), "lesson.passed[0].journal[0]: not a change"),
    "evidence without end": (lambda: changed(f"{EVIDENCE}.journal", [{"step": 0, "take": 0}] * 200_001), "at most 200000"),
    "evidence of a far step": (lambda: changed(f"{EVIDENCE}.step", 10**18), "lesson.passed[0].step"),
    "a program without end": (lambda: changed(f"{EVIDENCE}.program", "x" * 200_001), "at most 200000"),
    "hints of nothing": (lambda: changed("hints", {"a": 1}), "lesson.hints: there is no such page"),
    "hints without end": (lambda: changed("hints", dict.fromkeys(map(str, range(50_000)), 1)), "at most 100"),
    "hints before the first": (lambda: changed("hints.go", -1), "lesson.hints"),
    "pages skipped that are not there": (lambda: changed("skipped", ["a"]), "lesson.skipped: there is no such page"),
    "a page skipped without end": (lambda: changed("skipped", ["go"] * 1_001), "at most 1000"),
    "more than there is": (lambda: changed("luck", 1), "lesson.luck"),
    "a word for a truth value": (lambda: changed("finished", "yes"), "lesson.finished"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_is_refused_in_one_short_line(name: str, tmp_path: Path) -> None:
    text, message = REFUSED[name]
    with pytest.raises(SessionError) as error:
        read(text(), tmp_path).record()
    line = str(error.value)
    assert message in line
    assert len(line.splitlines()) == 1
    assert len(line) < 1_000


def test_what_would_not_be_read_again_is_not_written() -> None:
    taking = begun(lesson())
    taking = replace(taking, given=(Given("quiz", 0, False),) * 10_001)
    with pytest.raises(UserError, match="more than 10,000 answers"):
        encoded(record(taking))
