"""Policy files."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from recipes import recipe

from rl_tui.agents.exact.policy_figures import Choice
from rl_tui.common.errors import UserError
from rl_tui.runs.answers.policy_values import DrawnPolicy
from rl_tui.runs.policy_file import policy_document, read_policy
from rl_tui.runs.recipe import begin
from rl_tui.worlds.mdp.space import FiniteSpace

STUDENT = begin(recipe("student")).world.space
"""Class: study, check phone. Phone: scroll, quit. Pass: sleep. Sleep is the end."""
LAKE = begin(recipe("frozenlake")).world.space


def read(folder: Path, content: Any, space: FiniteSpace = STUDENT) -> dict[int, Choice]:
    path = folder / "policy.json"
    path.write_text(content if isinstance(content, str) else json.dumps(content), encoding="utf-8")
    return read_policy(str(path), space)


def faults(folder: Path, content: Any) -> list[str]:
    with pytest.raises(UserError) as caught:
        read(folder, content)
    return [line.removeprefix(f"{folder / 'policy.json'}: ") for line in str(caught.value).splitlines()]


def test_an_action_or_the_chance_of_each_by_their_names(tmp_path: Path) -> None:
    said = {"Phone": "quit", "Class": {"study": 0.25, "check phone": 0.75}}
    assert read(tmp_path, said) == {1: 3, 0: {0: 0.25, 1: 0.75}}
    assert read(tmp_path, {}) == {}
    assert read(tmp_path, {"14": "right", "0": {"down": 1}}, LAKE) == {
        14: LAKE.pairs_of(14)[2],
        0: {LAKE.pairs_of(0)[1]: 1},
    }


def test_an_editor_on_windows_may_have_written_it(tmp_path: Path) -> None:
    assert read(tmp_path, '\ufeff{"Phone": "quit"}') == {1: 3}


@pytest.mark.parametrize(
    ("content", "fault"),
    [
        (
            {"Klass": "study"},
            'Klass: unknown state; use one of this world (did you mean "Class"?)',
        ),
        (
            {"Sleep": "sleep"},
            "Sleep: a terminal state has no actions; leave it out",
        ),
        (
            {"Phone": "quitt"},
            'Phone: "quitt" is not available here; choose one of scroll, quit (did you mean "quit"?)',
        ),
        ({"Phone": "sleep"}, 'Phone: "sleep" is not available here; choose one of scroll, quit'),
        (
            {"Phone": {"quit": 0.5, "sleep": 0.5}},
            "Phone.sleep: this action is not available here; choose one of scroll, quit",
        ),
        ({"Phone": 1}, 'Phone: found 1; expected an action, or a table {"ACTION": CHANCE}'),
        ({"Phone": ["quit"]}, 'Phone: found ["quit"]; expected an action, or a table {"ACTION": CHANCE}'),
        ({"Phone": None}, 'Phone: found None; expected an action, or a table {"ACTION": CHANCE}'),
        ({"Phone": {}}, "Phone: the chances sum to 0; make them sum to 1"),
        (
            {"Class": {"study": 0.5, "check phone": 0.5 + 2e-9}},
            "Class: the chances sum to 1.000000002; make them sum to 1",
        ),
        ({"Phone": {"quit": "1"}}, 'Phone.quit: found "1"; expected a number from 0 to 1'),
        ({"Phone": {"quit": True}}, "Phone.quit: found true; expected a number from 0 to 1"),
        ({"Phone": {"quit": 1.5}}, "Phone.quit: found 1.5; expected a number from 0 to 1"),
        ('{"Phone": {"quit": NaN}}', "Phone.quit: found nan; expected a number from 0 to 1"),
        ('{"Phone": {"quit": Infinity}}', "Phone.quit: found inf; expected a number from 0 to 1"),
        (
            '{"Phone": "quit", "Phone": "scroll"}',
            "Phone: this state is listed twice; list it once",
        ),
        (
            '{"Phone": {"quit": 0.5, "quit": 1}}',
            "Phone.quit: this action is listed twice; list it once",
        ),
        (
            '["quit"]',
            'found ["quit"]; expected a table, {"STATE": "ACTION"} or {"STATE": {"ACTION": CHANCE}}',
        ),
        ("{,}", "line 1, column 2: not valid JSON (Expecting property name enclosed in double quotes)"),
        ("", "line 1, column 1: not valid JSON (Expecting value)"),
        (f'{{"Phone": {"9" * 5_000}}}', "not valid JSON (Exceeds the limit"),
        ("[" * 100_000, "tables are nested too deeply"),
        ('{"Phone\\u001b[2J": "quit"}', r'"Phone\u001b[2J": unknown state'),
    ],
)
def test_a_fault_is_a_line_with_its_place(content: Any, fault: str, tmp_path: Path) -> None:
    (said,) = faults(tmp_path, content)
    assert said.startswith(fault)
    assert said.isprintable()


def test_all_faults_are_told_at_once_and_of_very_many_the_first(tmp_path: Path) -> None:
    said = faults(tmp_path, {"Class": {"study": -1, "check phone": 2}, "Phone": "run", "Nowhere": "go"})
    assert [line.split(":")[0] for line in said] == ["Class.study", 'Class."check phone"', "Phone", "Nowhere"]
    many = faults(tmp_path, {f"room {number}": "go" for number in range(150)})
    assert len(many) == 101
    assert many[-1] == "more than 100 errors; fix these first"


def test_what_cannot_be_read_is_said(tmp_path: Path) -> None:
    for path, found in ((tmp_path, "found a folder"), (tmp_path / "none.json", "no such file")):
        with pytest.raises(UserError, match=f"{path.name}: {found}; expected a JSON file"):
            read_policy(str(path), STUDENT)
    (tmp_path / "policy.json").write_bytes(b'{"Phone": "\xff"}')
    with pytest.raises(UserError, match="line 1: byte 0xff is not UTF-8; save the file as UTF-8"):
        read_policy(str(tmp_path / "policy.json"), STUDENT)


def test_what_is_written_is_read_as_it_was(tmp_path: Path) -> None:
    choices: dict[int, Choice] = {1: 3, 0: {0: 0.1, 1: 0.9}}
    document = policy_document(STUDENT, choices)
    assert document == {"Phone": "quit", "Class": {"study": 0.1, "check phone": 0.9}}
    assert read(tmp_path, document) == choices


def test_what_a_person_drew_is_written_by_its_names() -> None:
    quit_, sleep = (STUDENT.action_names.index(name) for name in ("quit", "sleep"))
    drawn = DrawnPolicy(((1, quit_), (2, quit_), (3, sleep)))
    assert drawn.pairs(STUDENT) == {1: 3}  # not available elsewhere
    assert policy_document(STUDENT, drawn.pairs(STUDENT)) == {"Phone": "quit"}
    assert drawn.chances(STUDENT).tolist() == [0.5, 0.5, 0.0, 1.0, 1.0]
