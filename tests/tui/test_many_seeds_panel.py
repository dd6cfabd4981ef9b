"""What the panel of many seeds shows, at any size, and that its figures say no more than is known."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from lane_samples import side_by_side
from samples import bandit, lake, look
from snapshots import changed
from study_samples import bandit_study, cliff_study, difference, lake_study

from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.lab.many_seeds.figures import Estimate, LaneStudy, SeedStudy, StudyState
from rl_tui.tui.panels.many_seeds.figures import (
    FIGURES,
    LAST_100,
    REGRET,
    decimals_of,
    deviation,
    estimate_text,
    figure_text,
    may_count_again,
    shown_figures,
    verdict_of,
)
from rl_tui.tui.panels.many_seeds.many_seeds import ManySeeds
from rl_tui.tui.theme.glyphs import UNICODE

SIZES = ((118, 30), (97, 40), (58, 13), (36, 19), (36, 13), (26, 13), (26, 7), (16, 10), (5, 3), (1, 1))


def panel(snapshot: Snapshot | None, *, revealed: bool = False, ascii: bool = False) -> ManySeeds:  # noqa: A002
    made = ManySeeds(look(ascii))
    made.snapshot, made.revealed = snapshot, revealed
    return made


def drawn(snapshot: Snapshot | None, width: int = 58, height: int = 60, **how: Any) -> str:
    rows = panel(snapshot, **how).picture(snapshot, width, height)
    assert [row.cell_length for row in rows] == [width] * height
    return "\n".join(row.text.rstrip() for row in rows)


def said(snapshot: Snapshot | None, width: int = 58, **how: Any) -> str:
    """All words, wherever lines break."""
    return " ".join(drawn(snapshot, width, **how).split())


def lanes(study: SeedStudy, **changes: Any) -> Snapshot:
    return side_by_side(2, 1, study=study, **changes)


# What one run says


def test_each_figure_stands_beside_its_mean_and_error() -> None:
    lines = [line.split() for line in drawn(changed(lake(), study=lake_study())).splitlines()]
    assert ["last", "100", ".410", ".402", "±", ".010"] in lines
    assert ["greedy,", "exact", ".730", ".710", "±", ".006"] in lines


def test_it_tells_how_far_it_has_come_and_of_which_seeds() -> None:
    text = said(changed(lake(), study=lake_study()))
    assert text.startswith("64 of 256 seeds · low priority ━")
    assert "first 500 episodes of seeds 0 to 63" in text
    done = said(changed(lake(), study=lake_study(state=StudyState.DONE, seeds=256)))
    assert done.startswith("256 seeds first 500")
    by_steps = said(changed(lake(), study=lake_study(episodes=None, steps=2_000_000)))
    assert "first 2,000,000 steps of" in by_steps
    assert "first 1,000 pulls of" in said(changed(bandit(400), study=bandit_study()))


@pytest.mark.parametrize(
    ("own", "words"),
    [
        (0.41, "its last 100 is within one standard deviation (one is .083)"),
        (0.60, "this seed's last 100 is 2.4 standard deviations (one is .083) above the mean"),
        (0.20, "this seed's last 100 is 2.4 standard deviations (one is .083) below the mean"),
    ],
)
def test_it_says_how_usual_this_seed_is(own: float, words: str) -> None:
    (lane,) = lake_study().lanes
    lane = replace(lane, this_seed={LAST_100.id: own})
    assert words in said(changed(lake(), study=lake_study(lanes=(lane,))))


@pytest.mark.parametrize(
    "lane",
    [
        LaneStudy({}, {LAST_100.id: 0.5}),
        LaneStudy({LAST_100.id: Estimate(0.5, None, 1)}, {LAST_100.id: 0.5}),
        LaneStudy({LAST_100.id: Estimate(0.5, 0.0, 8)}, {LAST_100.id: 0.5}),
        LaneStudy({LAST_100.id: Estimate(0.5, 0.1, 8)}, {LAST_100.id: None}),
    ],
)
def test_nothing_is_said_of_it_where_that_is_not_known(lane: LaneStudy) -> None:
    assert deviation(LAST_100, lane) is None


def test_why_it_is_bounded_or_out_of_date_is_said() -> None:
    assert "a reason of its own" in said(changed(lake(), study=lake_study(message="a reason of its own")))
    out_of_time = said(changed(lake(), study=lake_study(state=StudyState.OUT_OF_TIME)))
    assert "processor time" in out_of_time
    assert "low priority" not in out_of_time
    outdated = changed(lake(), study=lake_study(is_outdated=True))
    assert "enter counts again" in said(outdated)
    assert "of each seed" in said(outdated)
    assert "standard deviation" not in said(outdated)


@pytest.mark.parametrize(
    ("study", "again"),
    [
        (None, False),
        (SeedStudy(StudyState.STARTING, most=256), False),
        (lake_study(), False),
        (lake_study(is_outdated=True), True),
        (lake_study(state=StudyState.DONE), True),
        (lake_study(state=StudyState.OUT_OF_TIME), True),
        (SeedStudy(StudyState.FAILED, message="not in a kiosk"), True),
    ],
)
def test_enter_counts_again_where_there_is_something_new_to_count(
    study: SeedStudy | None, again: bool
) -> None:
    assert may_count_again(study) is again
    made = panel(changed(lake(), study=study))
    made.picture(made.snapshot, 58, 20)
    assert ("enter" in made.footing) is again
    assert made.footing.endswith("M: close")


# Lanes


def test_lanes_are_compared_seed_by_seed() -> None:
    text = said(lanes(cliff_study()))
    assert "2 is better: higher by 22.5 ± .6 (21.3 to 23.7), in 64 of 64 seeds" in text
    assert "1 is better: higher by 4.00 ± .06 (3.88 to 4.12), in 61 of 64 seeds, equal in 3" in text
    assert "in 4 of 64 seeds lane 1's greedy policy never ends" in text
    rows = [line.split() for line in drawn(lanes(cliff_study())).splitlines()]
    assert ["1", "α", "0.1", "−43.0", "−47.1", "±", ".5"] in rows
    assert ["▸2", "α", "0.5", "−22.0", "−24.6", "±", ".4"] in rows


def test_of_regret_less_is_better() -> None:
    text = said(changed(bandit(1_000), study=bandit_study()))
    assert "1 is better: lower by 99 ± 11 (77 to 121), in 60 of 64 seeds, equal in 1" in text
    assert "1 is better: higher by 99 ± 11 (77 to 121), in 58 of 64 seeds" in text


def test_no_lane_is_called_better_before_that_is_seen() -> None:
    text = said(changed(bandit(1_000), study=bandit_study()))
    assert "no difference seen yet: 1 less 2 is .03 ± .03 (−.03 to .09); 1 is better in 34 of 64" in text


@pytest.mark.parametrize(
    ("mean", "stderr", "shown_is_better"),
    [(2.1, 1.0, True), (-2.1, 1.0, False), (1.9, 1.0, None), (-1.9, 1.0, None), (0.0, 0.0, None)],
)
def test_two_standard_errors_decide(mean: float, stderr: float, shown_is_better: bool | None) -> None:
    found = verdict_of(LAST_100, difference(mean, stderr, 40))
    assert found is not None
    assert found.is_shown_better is shown_is_better
    turned = verdict_of(REGRET, difference(mean, stderr, 40, 4))
    assert turned is not None
    assert turned.is_shown_better is (None if shown_is_better is None else not shown_is_better)
    if turned.is_shown_better:
        assert turned.better_in == 20


def test_one_seed_has_no_verdict() -> None:
    alone = replace(difference(1.0, 0.0, 1), mean=Estimate(1.0, None, 1))
    assert verdict_of(LAST_100, alone) is None


# Secrets


def test_a_bandit_keeps_its_secrets_until_they_are_out() -> None:
    snapshot = changed(bandit(400), study=bandit_study())
    hidden = said(snapshot)
    for secret in ("regret 1", "best arm 6", "greedy", "146", ".79", "1.51"):
        assert secret not in hidden
    assert "h shows regret and best arm" in hidden
    assert "winnings" in hidden
    revealed = said(snapshot, revealed=True)
    for secret in ("146 ± 2", ".79 ± .02", "1.51 ± .03"):
        assert secret in revealed


def test_a_mean_of_100_above_the_best_arm_is_explained() -> None:
    lucky = changed(bandit(1_000), return_last_100=1.56, study=bandit_study())
    assert "last 100, 1.56, is above the best arm's mean, 1.50: a mean of 100 noisy rewards" in said(lucky)
    assert "is above the best arm" not in said(changed(lucky, return_last_100=1.4))
    secret = said(changed(bandit(400), return_last_100=1.56, study=bandit_study()))
    assert "1.50" not in secret
    assert "it can be above the best arm's mean" in secret


# Sizes and characters


@pytest.mark.parametrize(("width", "height"), SIZES)
def test_it_fits_any_size(width: int, height: int) -> None:
    one, two = changed(lake(), study=lake_study()), lanes(cliff_study())
    nothing = changed(lake(), study=SeedStudy(StudyState.STARTING, most=256))
    failed = changed(lake(), study=SeedStudy(StudyState.FAILED, message="not in a kiosk"))
    arms = changed(bandit(400), study=bandit_study())
    for snapshot in (None, lake(), nothing, failed, one, two, arms):
        for revealed in (False, True):
            drawn(snapshot, width, height, revealed=revealed)
            text = drawn(snapshot, width, height, revealed=revealed, ascii=True)
            assert text.isascii()


@pytest.mark.parametrize("width", [58, 36, 35, 26, 25, 16, 15])
def test_no_number_is_cut_off(width: int) -> None:
    for study in (cliff_study(), replace(cliff_study(), lanes=cliff_study().lanes[:1], shown=0)):
        snapshot = lanes(study) if len(study.lanes) == 2 else changed(lake(), study=study)
        for ascii in (False, True):  # noqa: A001
            if ascii and width < 20:
                continue
            text = said(snapshot, width, ascii=ascii)
            minus, error = ("-", "+/-") if ascii else ("−", "±")
            assert f"{minus}47.1 {error} .5" in text
            assert f"{minus}43.0" in text


# Numbers


@pytest.mark.parametrize(
    ("mean", "stderr", "text"),
    [
        (-47.13, 0.52, "−47.1 ± .5"),
        (0.7092, 0.0071, ".709 ± .007"),
        (0.7092, 0.0124, ".709 ± .012"),
        (1213.4, 11.2, "1,213 ± 11"),
        (-13.0, 0.0, "−13 ± 0"),
        (0.824, 0.0, ".824 ± 0"),
        (146.0, 2.1, "146 ± 2"),
        (0.0, 0.3, ".0 ± .3"),
        (2.5, None, "2.5"),
    ],
)
def test_decimals_go_by_the_error(mean: float, stderr: float | None, text: str) -> None:
    estimate = Estimate(mean, stderr, 64)
    assert estimate_text(estimate, decimals_of([estimate]), UNICODE) == text


def test_what_is_not_known_is_a_dash() -> None:
    assert figure_text(None, 2, UNICODE) == "–"
    assert figure_text(float("nan"), 2, UNICODE) == "–"
    assert estimate_text(None, 2, UNICODE) == "–"
    assert len(figure_text(-1.23456e30, 2, UNICODE)) <= 7


def test_figures_are_those_of_train() -> None:
    from rl_tui.lab.experiments.seeded_runs import FIGURES as OF_RUNS
    from rl_tui.lab.run.figures import BANDIT_FIGURES

    assert {figure.id for figure in FIGURES} <= {*OF_RUNS, *BANDIT_FIGURES}
    assert [figure.id for figure in shown_figures(bandit_study(), secret=True)] == ["winnings", LAST_100.id]
