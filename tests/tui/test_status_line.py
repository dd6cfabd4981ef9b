from __future__ import annotations

import pytest
from samples import bandit, lake, look, planning, student

from rl_tui.lab.snapshot import Phase, Snapshot
from rl_tui.tui.widgets.status_line import StatusLine


def drawn(snapshot: Snapshot | None, width: int = 80, *, ascii: bool = False) -> str:  # noqa: A002
    (row,) = StatusLine(look(ascii)).picture(snapshot, width, 1)
    assert row.cell_length == width
    return row.text


def running(width: int = 80, **changes: object) -> str:
    usual = {"phase": Phase.RUNNING, "speed": None, "steps_per_second": 38.2e6, "episodes": 12_345}
    return drawn(lake(**({"step": 151_002} | usual | changes)), width)


def test_the_short_form() -> None:
    text = running()
    assert text.startswith(" FrozenLake 4×4 slippery ")
    assert text.split("  ")[-1].strip() == "38 M/s"
    for part in ("▶ max", "ep 12,345", "step 151,002"):
        assert part in text


def test_the_long_form() -> None:
    text = running(120)
    assert text.startswith(" FrozenLake 4×4 slippery · Q-learning · seed 0 ")
    assert text.endswith("38.2 M steps/s")
    assert "episode 12,345" in text


@pytest.mark.parametrize("width", [80, 120])
def test_nothing_moves_while_it_runs(width: int) -> None:
    early = running(width, episodes=1, step=12, steps_per_second=3.0)
    late = running(width, episodes=98_765_432, step=876_543_210, steps_per_second=999.4e6)
    unknown = running(width, steps_per_second=None)
    for label in ("ep", "step", "▶"):
        assert early.index(label) == late.index(label) == unknown.index(label)


def test_the_speed_is_blank_while_unknown() -> None:
    assert "/s" not in running(steps_per_second=None)


def test_a_wanted_speed() -> None:
    assert "▶ 10/s" in running(speed=10.0)
    assert "▶ 100,000/s" in running(speed=100_000.0)


def test_paused() -> None:
    assert "❚❚ paused" in drawn(student())
    assert "|| paused" in drawn(student(), ascii=True)


def test_a_bandit_counts_pulls() -> None:
    assert "pull 400 of 1,000" in drawn(bandit(400))
    assert "step" not in drawn(bandit(400))
    text = drawn(bandit())
    assert "■ budget spent" in text
    assert "pull 1,000 of 1,000" in text


def test_preparing_tells_what_it_waits_for() -> None:
    text = drawn(lake(0, phase=Phase.PREPARING, message="loading the learner"))
    assert "FrozenLake 4×4 slippery" in text
    assert "preparing: loading the learner" in text
    long = "loading the learner; the very first time it is compiled, which takes a few seconds"
    assert "preparing: loading the learner; the very first time" in drawn(
        lake(0, phase=Phase.PREPARING, message=long)
    )


def test_a_breakdown_takes_the_row() -> None:
    why = "Q(6, left) left ±1e12 at step 12,345"
    text = drawn(lake(phase=Phase.STOPPED, message=why))
    assert text.strip() == f"■ stopped: {why}"


def test_before_the_first_snapshot() -> None:
    assert drawn(None).strip() == "the world is being built"


@pytest.mark.parametrize("width", [1, 2, 10, 25, 40, 60, 79, 99, 100, 200])
@pytest.mark.parametrize("phase", list(Phase))
def test_it_fits_any_width(width: int, phase: Phase) -> None:
    for snapshot in (lake(phase=phase, message="a message"), bandit(400, phase=phase, message="a message")):
        drawn(snapshot, width)
        assert drawn(snapshot, width, ascii=True).isascii()


def test_ascii() -> None:
    text = drawn(lake(), 120, ascii=True)
    assert text.isascii()
    assert text.startswith(" FrozenLake 4x4 slippery - Q-learning - seed 0 ")


def test_a_planner_counts_sweeps_and_says_when_it_is_done() -> None:
    assert "sweep 12 " in drawn(planning())
    assert " ep " not in drawn(planning())
    message = "converged after 37 sweeps: no value moved by more than 1e-09 in the last one"
    done = planning(37, phase=Phase.DONE, message=message)
    for width in (80, 120):
        text = drawn(done, width)
        assert "■ converged after 37 sweeps  " in text
        assert "sweep 37" in text
    assert "# converged after" in drawn(done, ascii=True)
