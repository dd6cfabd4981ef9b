from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from itertools import product
from types import SimpleNamespace
from typing import Any

import pytest
from program_samples import program, watched
from rich.style import Style
from samples import bandit, lake, look, planning, stepped_lake, student
from snapshots import changed

from rl_tui.live.pace.transport import WAITING
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.live.snapshot_builder import PREPARING, REBUILDING
from rl_tui.live.world_editor import EditorView
from rl_tui.runs.timeline.branches import Branch, Timeline
from rl_tui.screen.panels.status_line import COMPILING, IN_PYTHON, StatusLine
from rl_tui.screen.playground.actions.run import RunActions


def drawn(snapshot: Snapshot | None, width: int = 80, *, ascii: bool = False) -> str:  # noqa: A002
    (row,) = StatusLine(look(ascii)).picture(snapshot, width, 1)
    assert row.cell_length == width
    return row.text


def running(width: int = 80, **changes: object) -> str:
    usual = {"phase": Phase.RUNNING, "speed": None, "steps_per_second": 38.2e6, "episodes": 12_345}
    return drawn(lake(**({"step": 151_002} | usual | changes)), width)


def test_the_short_and_the_long_form() -> None:
    text = running()
    assert text.startswith(" FrozenLake 4×4 slippery ")
    assert text.endswith("step   151,002 ")
    for part in ("38 M/s", "▶ max", "ep  12,346"):
        assert part in text
    text = running(120)
    assert text.startswith(" FrozenLake 4×4 slippery  Q-learning · ε-greedy  ")
    assert "  38.2 M steps/s  " in text
    assert text.endswith("episode  12,346  step    151,002 ")


@pytest.mark.parametrize("width", [60, 80, 120])
def test_the_name_and_the_numbers_are_bold_and_what_it_does_is_reversed(width: int) -> None:
    (row,) = StatusLine(look()).picture(lake(151_002), width, 1)
    styles = {segment.text.strip(): segment.style for segment in row if segment.style is not None}
    strong = look().palette.strong
    assert styles["151,002"] == strong
    assert styles["❚❚ paused"] == strong + Style(reverse=True)
    assert {text: style for text, style in styles.items() if text.startswith("FrozenLake")}.popitem()[
        1
    ] == strong
    assert styles.get("Q-learning · ε-greedy", look().palette.dim) == look().palette.dim


@pytest.mark.parametrize(("phase", "is_past"), list(product((Phase.PAUSED, Phase.RUNNING), (False, True))))
@pytest.mark.parametrize(
    ("make", "counted"),
    [
        (lake, "ep(isode)? +13  step +1,234"),
        (student, "ep(isode)? +13  step +1,234"),
        (stepped_lake, "ep(isode)? +13  step +1,234"),
        (partial(watched, program()), "ep(isode)? +13  step +1,234"),
        (planning, "sweep +13  step +1,234"),
        (bandit, "pull +400 of 1,000"),
    ],
)
def test_no_field_is_missing(
    make: Callable[..., Snapshot], counted: str, phase: Phase, is_past: bool
) -> None:
    snapshot = changed(
        make(400) if make is bandit else make(),
        phase=phase,
        speed=None,
        steps_per_second=38.2e6,
        timeline=past() if is_past else Timeline(),
        episode_step=1,
        episodes=12,
        step=1_234,
    )
    state = {
        (Phase.PAUSED, False): "❚❚ paused",
        (Phase.PAUSED, True): "◀ past, only shown" if snapshot.program else "◀ the past",
        (Phase.RUNNING, False): "▶ max",
        (Phase.RUNNING, True): "▶ replaying",
    }[phase, is_past]
    # in the past, the end of the run replaces the speed
    is_told = is_past and phase is Phase.PAUSED
    for width, speed in ((90, ("end 10k", "38 M/s")), (120, ("end 10,000", "38.2 M steps/s"))):
        text = drawn(snapshot, width)
        assert re.search(f"{speed[not is_told]} +{re.escape(state)}   *{counted} *$", text), text


@pytest.mark.parametrize("width", [80, 120])
def test_nothing_moves_while_it_runs(width: int) -> None:
    early = running(width, episodes=1, step=12, steps_per_second=3.0)
    late = running(width, episodes=98_765_432, step=876_543_210, steps_per_second=999.4e6)
    unknown = running(width, steps_per_second=None)
    for label in (" ep", " step ", "▶"):
        assert early.index(label) == late.index(label) == unknown.index(label)


def test_the_speed_is_blank_while_unknown() -> None:
    assert "/s" not in running(steps_per_second=None)


def test_at_full_speed_it_says_whether_machine_code_comes() -> None:
    assert f"▶ {COMPILING}" in running(interpreted=True)
    never = running(interpreted=True, stays_interpreted="no numba")
    assert f"▶ {IN_PYTHON}" in never
    assert COMPILING not in never


def test_why_runs_stay_interpreted_is_said_once(monkeypatch: pytest.MonkeyPatch) -> None:
    told = list[str]()
    screen: Any = SimpleNamespace(tell=lambda text, **_: told.append(text))
    nothing: Any = None
    monkeypatch.setattr(RunActions, "_told", set())
    for stays_interpreted in ("", "no numba", "no numba", "", "no numba"):
        # another scenario, another screen
        RunActions(screen, nothing, nothing, nothing).announce(lake(stays_interpreted=stays_interpreted))
    assert told == ["no numba"]


def test_a_wanted_speed_and_a_pause() -> None:
    assert "❚❚ paused" in drawn(student())
    assert "|| paused" in drawn(student(), ascii=True)
    assert "▶ 10/s" in running(speed=10.0)
    assert "9.8/s" not in running(speed=10.0, steps_per_second=9.8)
    assert " 52 k/s " in running(speed=100_000.0, steps_per_second=52_000.0)
    assert " 9.8 steps/s " in running(120, speed=10.0, steps_per_second=9.8)
    assert "▶ 100,000/s" in running(speed=100_000.0)


def test_a_bandit_counts_pulls() -> None:
    assert "pull   400 of 1,000" in drawn(bandit(400))
    assert "step" not in drawn(bandit(400))
    text = drawn(bandit())
    assert "■ budget spent" in text
    assert "pull 1,000 of 1,000" in text


def test_preparing_tells_what_it_waits_for() -> None:
    preparing = lake(0, phase=Phase.PREPARING, message=PREPARING)
    assert "FrozenLake 4×4 slippery" in drawn(preparing)
    for width in (60, 120):
        assert f"preparing: {PREPARING}" in drawn(preparing, width)


def test_a_breakdown_takes_the_row() -> None:
    why = "Q(6, left) left ±1e12 at step 12,345"
    text = drawn(lake(phase=Phase.STOPPED, message=why))
    assert text.strip() == f"■ stopped: {why}"


def test_before_the_first_snapshot() -> None:
    assert drawn(None).strip() == "the world is being built"
    line = StatusLine(look())
    line.title = "Cliff walking"
    for width in (60, 80, 120):
        (row,) = line.picture(None, width, 1)
        assert row.text == " Cliff walking  the world is being built".ljust(width)


@pytest.mark.parametrize("phase", list(Phase))
def test_it_fits_any_width(phase: Phase) -> None:
    for snapshot in (lake(phase=phase, message="a message"), bandit(400, phase=phase, message="a message")):
        for width in (1, 2, 10, 25, 40, 60, 79, 99, 100, 200):
            drawn(snapshot, width)
            assert drawn(snapshot, width, ascii=True).isascii(), width


def test_ascii() -> None:
    text = drawn(lake(), 120, ascii=True)
    assert text.isascii()
    assert text.startswith(" FrozenLake 4x4 slippery  Q-learning - epsilon-greedy  ")


def test_the_episode_is_the_one_that_the_agent_is_in() -> None:
    assert "ep       1 " in drawn(lake(0))
    assert "ep       1 " in drawn(lake(7, episodes=0, episode_step=7))
    assert "ep       1 " in drawn(lake(8, episodes=1, episode_step=0))
    assert "ep       2 " in drawn(lake(8, episodes=1, episode_step=0, is_at_beginning=True))
    assert "ep       2 " in drawn(lake(9, episodes=1, episode_step=1))
    assert "ep       2 " in drawn(lake(8, episodes=1, episode_step=0, last_step=None))


def test_a_planner_counts_sweeps_and_says_when_it_is_done() -> None:
    assert "sweep      13 " in drawn(planning())
    assert " ep " not in drawn(planning())
    message = "converged after 37 sweeps: no value moved by more than 1e-09 in the last one"
    done = planning(37, phase=Phase.DONE, message=message)
    for width in (80, 120):
        text = drawn(done, width)
        assert "■ converged after 37 sweeps  " in text
        assert re.search("sweep +37 ", text)
    assert "# converged after" in drawn(done, ascii=True)


# Time


def past(here: int = 1_234, end: int = 10_000, branches: int = 1) -> Timeline:
    forks = (Branch(f"branch {number}", (), 0, 100, end, here) for number in range(2, branches + 1))
    return Timeline((Branch("branch 1", end=end, here=here), *forks), branches - 1)


@pytest.mark.parametrize("width", [60, 80, 100, 120])
def test_the_past_is_told_with_how_far_it_goes(width: int) -> None:
    text = drawn(lake(1_234, timeline=past()), width)
    assert "◀ the past" in text
    assert re.search("step +1,234 ", text)
    assert ("end 10" in text) is (width > 60)
    assert "paused" not in text
    assert "end 10" not in drawn(lake(10_000, timeline=past(10_000)), width)


@pytest.mark.parametrize("width", [80, 100, 120])
def test_nothing_moves_on_the_way_into_the_past(width: int) -> None:
    present = drawn(lake(10_000, timeline=past(10_000)), width)
    then = drawn(lake(9_999, timeline=past(9_999)), width)
    for label in (" ep", " step"):
        assert present.index(label) == then.index(label)
    assert present.index("❚❚") == then.index("◀")


@pytest.mark.parametrize("width", [80, 120])
def test_the_longest_past_is_not_cut_off(width: int) -> None:
    text = drawn(lake(99_999_999, timeline=past(99_999_999, 876_543_210, 12)), width).rstrip()
    assert text.endswith("step    100.0M" if width == 80 else "step 99,999,999")
    assert ("end 877M" if width == 80 else "end 876,543,210") in text


def test_a_branch_is_named_where_there_are_several() -> None:
    assert "branch" not in drawn(lake(timeline=past()), 120)
    starts = {110: "branch 2", 120: "Q-learning · branch 2", 140: "Q-learning · ε-greedy · branch 2"}
    for width, details in starts.items():
        text = drawn(lake(timeline=past(branches=2)), width)
        assert text.startswith(f" FrozenLake 4×4 slippery  {details}  ")


def named(width: int, name: str = "an evening", **changes: object) -> str:
    line = StatusLine(look())
    line.name_session(name)
    (row,) = line.picture(lake(**changes), width, 1)
    assert row.cell_length == width
    return row.text


def test_the_name_of_the_session_stands_first() -> None:
    assert named(140).startswith(" an evening  FrozenLake 4×4 slippery · Q-learning · ε-greedy  ")
    assert named(110).startswith(" an evening  FrozenLake 4×4 slippery  ")
    assert named(80).startswith(" an evening  ")
    branches = past(branches=2)
    assert named(120, timeline=branches).startswith(" an evening  FrozenLake 4×4 slippery · branch 2  ")
    assert named(80, timeline=branches).startswith(" an evening  branch 2 ")


@pytest.mark.parametrize("width", [1, 20, 40, 60, 80])
def test_the_longest_name_moves_nothing(width: int) -> None:
    text = drawn(lake(), width)
    assert named(width, "x" * 80)[-10:] == text[-10:]


def test_running_in_the_past_repeats_what_happened() -> None:
    text = running(timeline=past(), speed=10.0)
    assert "▶ replaying" in text
    assert "38 M/s" in text


@pytest.mark.parametrize("width", [80, 100, 120])
@pytest.mark.parametrize(
    "why", ["breakpoint: state 6", "the next change of the greedy policy", "the greedy policy is optimal"]
)
def test_why_it_paused_is_not_cut_off(why: str, width: int) -> None:
    for timeline in (Timeline(), past(branches=2)):
        text = drawn(lake(1_234, paused_by=why, timeline=timeline), width)
        assert f"❚❚ {why}  " in text
        assert re.search("step +1,234 ", text)
        assert text.strip().startswith(("FrozenLake", "❚❚"))
        assert f"|| {why}" in drawn(lake(1_234, paused_by=why), width, ascii=True)


@pytest.mark.parametrize("width", [80, 120])
@pytest.mark.parametrize("what", ["the next reward", "the next change of the greedy policy"])
def test_what_it_runs_until(what: str, width: int) -> None:
    text = running(width, until=what)
    assert f"▶ until {what}  " in text
    assert re.search("step +151,002 ", text)
    unknown = running(width, until=what, steps_per_second=None, step=7)
    assert unknown.index(" step ") == text.index(" step ")


def test_why_it_paused_is_gone_once_it_runs() -> None:
    assert "breakpoint" not in running(paused_by="breakpoint: state 6")


def test_the_way_to_another_moment_is_told() -> None:
    message = "replaying from the seed: 12,000 of 100,000 steps, about 3 s"
    for width in (60, 80, 120):
        assert message in drawn(lake(phase=Phase.SEEKING, message=message), width)
    assert "FrozenLake" in drawn(lake(phase=Phase.SEEKING, message=message))


def test_what_a_replay_waits_for_is_told() -> None:
    message = WAITING.format(steps=2_000_000)
    for width in (80, 120):
        assert message in drawn(lake(phase=Phase.SEEKING, message=message), width)
    assert "2,000,000 steps to replay: waiting for the compiler" in drawn(
        lake(phase=Phase.SEEKING, message=message), 60
    )


def test_that_learning_waits_for_a_world_is_told_whatever_the_run_was_doing() -> None:
    for phase in (Phase.PAUSED, Phase.RUNNING):
        waiting = replace(lake(phase=phase, message=REBUILDING), editor=EditorView(rebuilding=True))
        for width in (60, 80, 120):
            assert REBUILDING in drawn(waiting, width)


def test_a_short_way_changes_nothing() -> None:
    seeking, paused = (drawn(lake(phase=phase)) for phase in (Phase.SEEKING, Phase.PAUSED))
    assert seeking == paused


def test_a_reason_longer_than_the_row_is_shortened() -> None:
    long = f"the optimal policy is unknown: {'x' * 50}"
    assert drawn(lake(paused_by=long)).rstrip().endswith("…")
    assert drawn(lake(paused_by=long), ascii=True).isascii()
    assert long in drawn(lake(paused_by=long), 120)


def test_a_short_title_stays_beside_a_long_message() -> None:
    message = "the environment has not answered for 4 s; esc leaves it"
    line = StatusLine(look())
    line.show_unanswered(4)
    (row,) = line.picture(student(), 80, 1)
    assert row.text.rstrip().endswith(message)
    assert row.text.startswith(" A student")


@pytest.mark.parametrize("width", [60, 80, 120])
def test_an_environment_that_does_not_answer(width: int) -> None:
    line = StatusLine(look())
    line.show_unanswered(1_234)
    told = "the environment has not answered for 1,234 s; esc leaves it"
    for snapshot in (None, lake(phase=Phase.RUNNING)):
        (row,) = line.picture(snapshot, width, 1)
        assert row.cell_length == width
        assert told[: width - 2] in row.text
    line.show_unanswered(0)
    (row,) = line.picture(lake(phase=Phase.RUNNING), width, 1)
    assert "answered" not in row.text


def test_a_program_that_does_not_answer_has_the_line_where_it_stands() -> None:
    line = StatusLine(look())
    line.show_unanswered(12)
    (row,) = line.picture(watched(program(stands_at="line 7")), 100, 1)
    assert "your program, in line 7, has not answered for 12 s; esc leaves it" in row.text
