"""Classes with reset and step, and tables of many shapes."""

from __future__ import annotations

from pathlib import Path

import pytest
from watched_scripts import check_q_learning, lines_of, script_in, watched

from rl_tui.programs.diagnosis.diagnosis import verdict_of
from rl_tui.programs.grading.watch_report import watch_report
from rl_tui.programs.watched.program_log import ProgramLog
from rl_tui.programs.watched.program_world import world_of_program

pytestmark = pytest.mark.process

FIELD = """\
import random
import numpy as np
from collections import defaultdict
class Field:
    actions = {actions}
    def reset(self):
        self.row, self.column = 3, 0
        return self.seen()
    def seen(self):
        row, column = self.row, self.column
        return {state}
    def step(self, action):
        down, right = dict(zip(self.actions, ((-1, 0), (1, 0), (0, -1), (0, 1))))[action]
        self.row, self.column = min(3, max(0, self.row + down)), min(3, max(0, self.column + right))
        place = 4 * self.row + self.column
        return {result}
world = Field()
"""
LEARNING = """
{table}
for episode in range(800):
    s, done = world.reset(), False
    while not done:
        a = random.choice(world.actions)
        s2, r, done, *_ = world.step(a)
        ahead = 0.0 if done else max({row2})
        {cell} += 0.25 * (r + 0.9 * ahead - {cell})
        s = s2
"""
INT, PAIR, LIST = "4 * row + column", "(row, column)", "[row, column]"
NUMBERS, NAMES = "[0, 1, 2, 3]", "['up', 'down', 'left', 'right']"
THREE = "self.seen(), float(place == 3) - 0.1, place in (3, 10)"


def field(state: str = INT, actions: str = NUMBERS, result: str = THREE) -> str:
    return FIELD.format(state=state, actions=actions, result=result)


def learning(table: str, row2: str, cell: str) -> str:
    return LEARNING.format(table=table, row2=row2, cell=cell)


def check_field(log: ProgramLog, table: str | None, form: str, states: int) -> None:
    check_q_learning(log, table, form, 0.25, 0.9)
    report = watch_report("x", log, verdict_of(log))
    assert report["environment"] == {"id": "Field", "states": states, "actions": 4}


@pytest.mark.parametrize(
    ("state", "table", "row2", "cell", "form"),
    [
        (INT, "Q = np.zeros((16, 4))", "Q[s2]", "Q[s, a]", "array"),
        (INT, "Q = [[0.0] * 4 for _ in range(16)]", "Q[s2]", "Q[s][a]", "lists"),
        (PAIR, "Q = np.zeros((4, 4, 4))", "Q[s2]", "Q[s][a]", "array"),
        (LIST, "Q = np.zeros((4, 4, 4))", "Q[tuple(s2)]", "Q[s[0], s[1], a]", "array"),
        ("np.array([row, column])", "Q = np.zeros((4, 4, 4))", "Q[tuple(s2)]", "Q[s[0], s[1], a]", "array"),
        (
            PAIR,
            "Q = [[[0.0] * 4 for _ in range(4)] for _ in range(4)]",
            "Q[s2[0]][s2[1]]",
            "Q[s[0]][s[1]][a]",
            "lists",
        ),
    ],
)
def test_a_table_with_places_is_found_before_the_first_step(
    state: str, table: str, row2: str, cell: str, form: str, tmp_path: Path
) -> None:
    path = script_in(tmp_path, field(state) + learning(table, row2, cell))
    log = watched(path, steps=1500)
    check_field(log, "Q", form, 16)
    assert log.recording.found_at == 0


@pytest.mark.parametrize(
    ("state", "actions", "table", "row2", "cell", "form"),
    [
        (PAIR, NUMBERS, "Q = defaultdict(lambda: np.zeros(4))", "Q[s2]", "Q[s][a]", "dict-of-arrays"),
        (
            PAIR,
            NAMES,
            "Q = defaultdict(lambda: dict.fromkeys(world.actions, 0.0))",
            "Q[s2].values()",
            "Q[s][a]",
            "dict-of-dicts",
        ),
        (
            LIST,
            NAMES,
            "Q = defaultdict(lambda: dict.fromkeys(world.actions, 0.0))",
            "Q[str(s2)].values()",
            "Q[str(s)][a]",
            "dict-of-dicts",
        ),
        (
            INT,
            NAMES,
            "Q = defaultdict(float)",
            "[Q[s2, each] for each in world.actions]",
            "Q[s, a]",
            "dict-of-pairs",
        ),
        (
            PAIR,
            NUMBERS,
            "Q = defaultdict(float)",
            "[Q[*s2, each] for each in world.actions]",
            "Q[*s, a]",
            "dict-of-parts",
        ),
        (
            "f'{row}-{column}'",
            NUMBERS,
            "Q = defaultdict(lambda: [0.0] * 4)",
            "Q[s2]",
            "Q[s][a]",
            "dict-of-arrays",
        ),
    ],
)
def test_a_table_with_keys_is_found_after_some_steps(
    state: str, actions: str, table: str, row2: str, cell: str, form: str, tmp_path: Path
) -> None:
    path = script_in(tmp_path, field(state, actions) + learning(table, row2, cell))
    log = watched(path, steps=1500)
    check_field(log, "Q", form, 16 - 2 + 2)


def test_names_are_those_of_the_program(tmp_path: Path) -> None:
    table = "Q = defaultdict(lambda: dict.fromkeys(world.actions, 0.0))"
    text = field(PAIR, NAMES) + learning(table, "Q[s2].values()", "Q[s][a]")
    log = watched(script_in(tmp_path, text), steps=1000)
    space = world_of_program(log.environments[0]).world.space
    assert sorted(space.action_names) == ["down", "left", "right", "up"]
    assert list(space.state_names[:2]) == ["(0, 0)", "(0, 1)"]
    assert len(set(space.state_names)) == space.states < 65
    assert (space.state_names[-2], space.state_names[-1]) == (f"#{space.states - 2}", "further states")


def test_actions_with_names_and_a_table_with_places_are_not_matched(tmp_path: Path) -> None:
    text = field(INT, NAMES) + learning("Q = np.zeros((16, 4))", "Q[s2]", "Q[s, world.actions.index(a)]")
    log = watched(script_in(tmp_path, text), steps=2000)
    assert (log.error, log.table, verdict_of(log).findings) == (None, None, ())


@pytest.mark.parametrize("result", [f"{THREE}, {{}}", f"{THREE}, False, {{}}"], ids=["four", "five"])
def test_more_values_may_come(result: str, tmp_path: Path) -> None:
    text = field(INT, NUMBERS, result) + learning("Q = np.zeros((16, 4))", "Q[s2]", "Q[s, a]")
    check_field(watched(script_in(tmp_path, text), steps=1500), "Q", "array", 16)


LIMITED = (
    field(INT, NUMBERS, "self.seen(), float(place == 3) - 0.1, place in (3, 10) or self.limit()").replace(
        "self.row, self.column = 3, 0\n", "self.row, self.column, self.left = 3, 0, 12\n"
    )
    + """
def limit(field):
    field.left -= 1
    return field.left < 0
Field.limit = limit
"""
)


@pytest.mark.parametrize("ahead", ["0.0 if done else max(Q[s2])", "0.0 if s2 in (3, 10) else max(Q[s2])"])
def test_a_limit_of_its_own_is_not_an_end(ahead: str, tmp_path: Path) -> None:
    text = LIMITED + learning("Q = np.zeros((16, 4)) + 1", "Q[s2]", "Q[s, a]")
    text = text.replace("0.0 if done else max(Q[s2])", ahead)
    log = watched(script_in(tmp_path, text), steps=1500)
    verdict = verdict_of(log)
    assert (log.error, verdict.findings, verdict.update.alpha) == (None, (), pytest.approx(0.25))


def test_a_bug_at_an_end_of_its_own_is_still_found(tmp_path: Path) -> None:
    text = field() + learning("Q = np.zeros((16, 4)) + 1", "Q[s2]", "Q[s, a]")
    log = watched(script_in(tmp_path, text.replace("0.0 if done else", "")), steps=1500)
    assert [each.fault for each in verdict_of(log).findings] == ["bootstraps-after-end"]


@pytest.mark.parametrize(
    ("first", "next_one", "why"),
    [
        ("0.5", "0.25", "its observations are numbers with fractions"),
        ("None", "1", "its reset() returns no state"),
        ("self", "self", "an observation has the type W"),
        ("[0] * 40", "[1] * 40", "an observation has 40 parts"),
    ],
)
def test_a_world_that_cannot_be_numbered_is_told(first: str, next_one: str, why: str, tmp_path: Path) -> None:
    text = f"""\
    class W:
        def reset(self):
            return {first}
        def step(self, action):
            return {next_one}, 0, False
    w = W()
    w.reset()
    for _ in range(300):
        w.step(0)
    """
    log = watched(script_in(tmp_path, text))
    assert (log.error, log.recording.count) == (None, 0)
    assert f"W is not watched: {why}" in log.notes


def test_a_world_with_more_states_than_expected_is_left(tmp_path: Path) -> None:
    text = """\
    class Line:
        def reset(self):
            self.at = 0
            return self.at
        def step(self, action):
            self.at += action
            return self.at, 0.0, False
    line = Line()
    line.reset()
    for step in range(20_000):
        line.step(1)
    """
    log = watched(script_in(tmp_path, text))
    assert log.recording.count == 16_383
    assert "Line is no longer watched: more than 16,384 states were seen" in log.notes


def test_an_agent_is_not_a_world(tmp_path: Path) -> None:
    text = (
        field()
        + """
class Agent:
    def reset(self):
        return None
    def act(self, state):
        return random.randrange(4)
    def step(self, state, action, reward):
        return 0
agent = Agent()
"""
        + learning("Q = np.zeros((16, 4))", "Q[s2]", "Q[s, a]").replace(
            "random.choice(world.actions)", "agent.act(s)"
        )
    )
    check_field(watched(script_in(tmp_path, text), steps=1500), "Q", "array", 16)


def test_a_copy_is_only_tried_out_and_an_inner_world_reports_alone(tmp_path: Path) -> None:
    text = (
        field()
        + """
import copy
class Outer:
    def reset(self):
        return world.reset()
    def step(self, action):
        trial = copy.deepcopy(world)
        trial.step(1)
        return world.step(action)
outer = Outer()
Q = np.zeros((16, 4))
outer.reset()
for _ in range(30):
    outer.step(2)
"""
    )
    log = watched(script_in(tmp_path, text))
    assert (log.error, log.recording.count, [each.id for each in log.environments]) == (None, 30, ["Field"])


def test_a_step_may_have_any_name_if_it_is_given_an_action(tmp_path: Path) -> None:
    text = field() + learning("Q = np.zeros((16, 4))", "Q[s2]", "Q[s, a]")
    text = text.replace(
        "def step(self, action):",
        "def peek(self, action):\n        return action\n    def play(self, action):",
    )
    log = watched(script_in(tmp_path, text.replace("world.step(a)", "world.play(world.peek(a))")))
    check_field(log, "Q", "array", 16)


def test_nothing_is_said_of_a_method_that_is_no_step_after_all(tmp_path: Path) -> None:
    text = """\
    class Board:
        def reset(self):
            self.moves = []
        def play(self, move):
            self.moves.append(move)
            return move, 1.0, len(self.moves) > 5
    board = Board()
    board.reset()
    print(*(board.play(each)[2] for each in range(8)))
    """
    log = watched(script_in(tmp_path, text))
    assert (log.error, log.recording.count, len(log.notes)) == (None, 0, 1)
    assert log.notes[0].startswith("nothing to watch, ")


LOOKS = """\
import random, numpy as np
class World:
    def reset(self):
        self.place = 0
        return self.place
    def look(self, action):
        ahead = max(0, self.place + (1 if action else -1))
        return ahead, float(ahead == 5), ahead == 5
    def play(self, action):
        ahead, reward, done = self.look(action)
        {change}
        return ahead, reward, done
    {more}
world = World()
q = np.zeros((6, 2))
for episode in range(200):
    s, done = world.reset(), False
    while not done:
        a = random.randrange(2)
        for each in range(2):
            world.look(each)
        n, r, done = world.{step}(a)
        world.place = n
        q[s, a] += 0.1 * (r + 0.9 * (0 if done else max(q[n])) - q[s, a])
        s = n
"""


@pytest.mark.parametrize(
    ("change", "step", "more", "world"),
    [
        ("self.place = ahead", "play", "", "World"),
        ("self.place += ahead - self.place", "play", "", "World"),
        ("self.seen, self.place = 1, ahead", "play", "", "World"),
        ("self.at = [0]; self.at[0] = ahead", "play", "", "World"),
        ("pass", "look", "", "world of q"),
        ("other = World(); other.place = self.place", "look", "", "world of q"),
        ("self.place = ahead", "play", "again = play", "world of q"),
    ],
)
def test_a_method_with_another_name_is_the_step_if_only_it_changes_the_object(
    change: str, step: str, more: str, world: str, tmp_path: Path
) -> None:
    text = LOOKS.replace("{change}", change).replace("{step}", step).replace("{more}", more)
    log = watched(script_in(tmp_path, text), steps=1_500)
    assert [each.id for each in log.environments] == [world]
    check_q_learning(log, "q", "array", 0.1, 0.9)


def test_a_function_attached_to_a_class_may_be_its_step(tmp_path: Path) -> None:
    text = LOOKS.replace("{change}", "self.place = ahead").replace("{step}", "proceed")
    inside, rest = text.split("    def play"), "    {more}\n"
    body, after = inside[1].split(rest)
    function = "def proceed" + body.replace("\n        ", "\n    ")
    text = f"{function}{inside[0]}    proceed = proceed\n{after}"
    log = watched(script_in(tmp_path, text), steps=1_500)
    assert [each.id for each in log.environments] == ["World"]
    check_q_learning(log, "q", "array", 0.1, 0.9)


def test_a_class_compiled_with_the_name_of_a_file_with_other_lines_is_left(tmp_path: Path) -> None:
    text = """\
    source = "class World:\\n def reset(self): pass\\n def proceed(self, action): return 1, 2, 3"
    print(1 + (
        2
    ))
    exec(compile(source, __file__, "exec"))
    """
    log = watched(script_in(tmp_path, text))
    assert (log.error, lines_of(log)) == (None, ["3"])


@pytest.mark.parametrize(
    ("state", "setting"),
    [(INT, "Q[10] = 0.0"), ("'end' if row == 0 and column == 3 else 4 * row + column", "Q['end'] = 0.0")],
)
@pytest.mark.parametrize(
    ("row", "row2", "form"),
    [
        ("dict.fromkeys(world.actions, 0.0)", "Q[s2].values()", "dict-of-dicts"),
        ("[0.0] * 4", "Q[s2]", "dict-of-arrays"),
    ],
)
def test_an_entry_that_is_not_a_row_is_left_out(
    row: str, row2: str, form: str, state: str, setting: str, tmp_path: Path
) -> None:
    table = f"Q = {{state: {row} for state in range(16)}}; {setting}"
    text = field(state) + learning(table, row2, "Q[s][a]") + f"    {setting}\n"
    check_q_learning(watched(script_in(tmp_path, text), steps=1_500), "Q", form, 0.25, 0.9)


def test_a_list_of_actions_tells_a_table_from_one_with_actions_first(tmp_path: Path) -> None:
    text = field(PAIR).replace("actions =", "action = ['n', 's', 'w', 'e']; actions =")
    text = text.replace("(3, row)", "(4, row)") + learning(
        "Q = np.zeros((4, 6, 5))", "Q[:, s2[0], s2[1]]", "Q[a][s]"
    )
    log = watched(script_in(tmp_path, text), steps=2_000)
    assert (log.error, log.table, log.recording.count) == (None, None, 2_000)


def test_a_short_program_is_seen_whole(tmp_path: Path) -> None:
    text = field(PAIR, NAMES) + "world.reset()\nfor _ in range(7):\n    world.step('up')\n"
    log = watched(script_in(tmp_path, text))
    assert (log.recording.count, log.recording.steps.reward.tolist()) == (7, pytest.approx([-0.1] * 7))


def test_a_world_in_a_window_runs_without_one(tmp_path: Path) -> None:
    text = """\
    import time, tkinter as tk
    class Maze(tk.Tk):
        def __init__(self):
            super().__init__()
            self.title("maze"); self.geometry("160x160")
            self.canvas = tk.Canvas(self, bg="white", height=160, width=160)
            self.me = self.canvas.create_rectangle(5, 5, 35, 35, fill="red")
            self.canvas.pack()
        def reset(self):
            self.update()
            self.canvas.delete(self.me)
            self.me = self.canvas.create_rectangle(5, 5, 35, 35)
            return self.canvas.coords(self.me)
        def step(self, action):
            self.canvas.move(self.me, 40 if action else 0, 0)
            seen = self.canvas.coords(self.me)
            return ("terminal" if seen[0] > 100 else seen), float(seen[0] > 100), seen[0] > 100
    Q = {}
    def row(s):
        return Q.setdefault(str(s), [0.0, 0.0])
    def learn():
        for episode in range(100):
            s, done = env.reset(), False
            while not done:
                time.sleep(0.5)
                a = episode % 2 or int(row(s)[1] >= row(s)[0])
                s2, r, done = env.step(a)
                row(s)[a] += 0.5 * (r + 0.9 * (0 if done else max(row(s2))) - row(s)[a])
                s = s2
        print("learned")
    env = Maze()
    env.after(100, learn)
    env.mainloop()
    """
    log = watched(script_in(tmp_path, text))
    assert (log.error, lines_of(log)) == (None, ["learned"])
    assert log.recording.count >= 300
    assert "tkinter opens no window: rl-tui shows the world" in log.notes
    assert "time.sleep() returns at once: you set the speed on screen" in log.notes
    update = verdict_of(log).update
    assert (update.alpha, update.gamma) == (pytest.approx(0.5), pytest.approx(0.9))


def test_places_in_a_window_are_plain_numbers(tmp_path: Path) -> None:
    text = """\
    import numpy as np, tkinter
    canvas = tkinter.Canvas(tkinter.Tk())
    item = canvas.create_oval(*(np.array([20, 20, 50, 50]) - 15))
    canvas.move(item, np.int64(40), np.float64(0))
    print(canvas.coords(item))
    """
    assert lines_of(watched(script_in(tmp_path, text))) == ["[45.0, 5.0, 75.0, 35.0]"]
