"""The panel of many seeds claims no more than is known."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from lane_samples import side_by_side
from samples import answered, bandit, lake, look
from snapshots import changed
from study_samples import bandit_study, cliff_study, difference, lake_study

from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.panels.many_seeds import ABOVE_BEST, BRACKETS, ManySeeds
from rl_tui.screen.panels.seed_figures import (
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
from rl_tui.screen.theme.glyphs import UNICODE
from rl_tui.studies.many_seeds.figures import Estimate, LaneStudy, SeedStudy, StudyState


def panel(snapshot: Snapshot | None, *, revealed: bool = False, ascii: bool = False) -> ManySeeds:  # noqa: A002
    made = ManySeeds(look(ascii))
    made.snapshot = answered(snapshot, revealed)
    return made


def drawn(snapshot: Snapshot | None, width: int = 58, height: int = 60, **how: Any) -> str:
    made = panel(snapshot, **how)
    rows = made.picture(made.snapshot, width, height)
    assert [row.cell_length for row in rows] == [width] * height
    return "\n".join(row.text.rstrip() for row in rows)


def said(snapshot: Snapshot | None, width: int = 58, **how: Any) -> str:
    return " ".join(drawn(snapshot, width, **how).split())


def lanes(study: SeedStudy, **changes: Any) -> Snapshot:
    return side_by_side(2, 1, study=study, **changes)


# Texts for one run


def test_each_figure_stands_beside_its_mean_and_error() -> None:
    lines = [line.split() for line in drawn(changed(lake(), study=lake_study())).splitlines()]
    assert ["return", "of", "the", "last", "100", ".410", ".402", "±", ".010"] in lines
    assert ["greedy,", "exact", ".730", ".710", "±", ".006"] in lines


def test_each_seed_is_a_mark_where_there_is_room() -> None:
    study = lake_study()
    seeds = {name: np.array([0.3, 0.41, 0.5]) for name in study.lanes[0].estimates}
    shown = changed(lake(), study=lake_study(lanes=(replace(study.lanes[0], seeds=seeds),)))
    counts = [drawn(shown, 58, height).count("●") for height in (15, 10, 8)]
    assert counts == [3, 2, 0]  # all figures and the legend, the first figure and the legend, none


def test_it_tells_how_far_it_has_come_and_of_which_seeds() -> None:
    text = said(changed(lake(), study=lake_study()))
    assert text.startswith("64 of 256 seeds · episodes 1–500 · low priority ━")
    assert "seeds 0–63" in text
    assert "about 40 s left" in said(changed(lake(), study=lake_study(how_long="about 40 s left")))
    done = said(changed(lake(), study=lake_study(state=StudyState.DONE, seeds=256)))
    assert done.startswith("256 seeds · episodes 1–500 return of the last 100: this seed")
    by_steps = said(changed(lake(), study=lake_study(episodes=None, steps=2_000_000)))
    assert "seeds · steps 1–2,000,000" in by_steps
    assert "seeds · pulls 1–1,000" in said(changed(bandit(400), study=bandit_study()))


@pytest.mark.parametrize("width", [58, 36, 26])
def test_where_seeds_end_is_always_said(width: int) -> None:
    for snapshot in (changed(lake(), study=lake_study()), lanes(cliff_study())):
        first = drawn(snapshot, width, 13).splitlines()[0]
        assert first.endswith("1–500") or "1–500 " in first
        assert "to 500" in said(snapshot, width)  # the run continued: this seed's numbers are outdated


def test_figures_of_just_the_episodes_that_were_run_need_no_such_word() -> None:
    snapshot = changed(lake(), study=lake_study(), episodes=500)
    assert "to 500" not in said(snapshot)


def test_the_mean_of_fewer_than_100_episodes_is_named_by_their_number() -> None:
    (lane,) = lake_study().lanes
    lane = replace(
        lane,
        estimates={**lane.estimates, "return_mean": Estimate(0.402, 0.0104, 64)},
        this_seed={**lane.this_seed, "return_mean": 0.41},
    )
    text = said(changed(lake(), study=lake_study(lanes=(lane,), episodes=48), episodes=48))
    assert "last 48 .410" in text
    assert "last 48: this seed is typical" in text
    assert "last 100" not in text
    assert "mean return" not in text  # the same figure
    assert "mean return .410" in said(changed(lake(), study=lake_study(lanes=(lane,))))


@pytest.mark.parametrize(
    ("own", "words"),
    [
        (0.41, "this seed is typical, within 1 standard deviation (.083) of the mean"),
        (0.60, "return of the last 100: this seed is 2.4 standard deviations of .083 above the mean"),
        (0.20, "return of the last 100: this seed is 2.4 standard deviations of .083 below the mean"),
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
    assert "CPU-time limit" in out_of_time
    assert "low priority" not in out_of_time
    outdated = changed(lake(), study=lake_study(is_outdated=True))
    assert "enter repeats the study" in said(outdated)
    assert "seeds 0–63" not in said(outdated)
    assert "of the mean" not in said(outdated)


@pytest.mark.parametrize(
    ("study", "again"),
    [
        (None, False),
        (SeedStudy(StudyState.STARTING, most=256), False),
        (lake_study(), False),
        (lake_study(is_outdated=True), True),
        (lake_study(state=StudyState.DONE), True),
        (lake_study(state=StudyState.OUT_OF_TIME), True),
        (SeedStudy(StudyState.FAILED, message="its process ended"), True),
        (SeedStudy(StudyState.REFUSED, message="not in a kiosk"), False),
        (SeedStudy(StudyState.REFUSED, message="not in a kiosk", is_outdated=True), True),
    ],
)
def test_enter_counts_again_where_there_is_something_new_to_count(
    study: SeedStudy | None, again: bool
) -> None:
    assert may_count_again(study) is again
    made = panel(changed(lake(), study=study))
    made.has_focus = True
    made.picture(made.snapshot, 58, 20)
    assert ("enter" in made.footing) is again
    assert made.footing.endswith("esc: close")


# Lanes


def test_lanes_are_compared_seed_by_seed() -> None:
    text = said(lanes(cliff_study()))
    assert "2 is better: higher by 22.5 ± .6 (20.7 to 24.3), in 64 of 64 seeds" in text
    assert "1 is better: higher by 4.00 ± .06 (3.82 to 4.18), in 61 of 64 seeds, equal in 3" in text
    assert "left out: 4 of 64 seeds, where run 1's greedy policy may never end" in text
    rows = [line.split() for line in drawn(lanes(cliff_study())).splitlines()]
    assert ["1", "α", "0.1", "−43.0", "−47.1", "±", ".5"] in rows
    assert ["▸2", "α", "0.5", "−22.0", "−24.6", "±", ".4"] in rows


@pytest.mark.parametrize("width", [36, 58])
def test_brackets_are_explained_once_right_below_the_first(width: int) -> None:
    text = said(lanes(cliff_study()), width)
    assert text.count(BRACKETS) == 1
    assert f"in 64 of 64 seeds {BRACKETS}" in text
    assert BRACKETS not in said(changed(lake(), study=lake_study()), width)


def test_of_regret_less_is_better() -> None:
    text = said(changed(bandit(1_000), study=bandit_study()))
    assert "1 is better: lower by 99 ± 11 (66 to 132), in 60 of 64 seeds, equal in 1" in text
    assert "1 is better: higher by 99 ± 11 (66 to 132), in 58 of 64 seeds" in text


def test_no_lane_is_called_better_before_that_is_seen() -> None:
    text = said(changed(bandit(1_000), study=bandit_study()))
    assert "so far 1 is higher by .03 ± .03 (−.06 to .12), in 34 of 64" in text


@pytest.mark.parametrize(
    ("mean", "stderr", "count", "seen"),
    [
        (3.1, 1.0, 64, True),
        (-3.1, 1.0, 64, True),
        (2.9, 1.0, 64, False),
        (-2.9, 1.0, 64, False),
        (9.9, 1.0, 16, False),
        (0.0, 0.0, 64, False),
    ],
)
def test_three_standard_errors_decide_from_32_seeds_on(
    mean: float, stderr: float, count: int, seen: bool
) -> None:
    found = verdict_of(LAST_100, difference(mean, stderr, 10, count=count))
    assert (found.is_shown_better, found.is_seen) == (mean >= 0.0, seen)
    assert found.better_in == (10 if mean >= 0.0 else count - 10)
    turned = verdict_of(REGRET, difference(mean, stderr, 6, 4, count))
    assert (turned.is_shown_better, turned.is_seen) == (mean <= 0.0, seen)
    assert turned.better_in == (count - 10 if mean <= 0.0 else 6)


def test_equal_lanes_are_seldom_told_apart_at_any_look() -> None:
    trials = 4_000
    seeds = np.random.default_rng(0).standard_normal((trials, 256))
    claimed = np.zeros(trials, dtype=bool)
    for count in (8, 16, 32, 64, 128, 256):
        means = seeds[:, :count].mean(axis=1)
        errors = seeds[:, :count].std(axis=1, ddof=1) / np.sqrt(count)
        found = (
            verdict_of(LAST_100, difference(mean, error, 0, count=count))
            for mean, error in zip(means.tolist(), errors.tolist(), strict=True)
        )
        claimed |= [verdict is not None and verdict.is_seen for verdict in found]
    assert 0.005 < claimed.mean() < 0.02  # some 1.3 %


def test_the_lane_on_screen_is_marked_and_the_verdict_stays() -> None:
    study = cliff_study()
    first, second = (said(side_by_side(2, shown, study=study)) for shown in (0, 1))
    assert "▸1" in first
    assert "▸2" not in first
    assert "▸2" in second
    for text in (first, second):
        assert "2 is better: higher by 22.5" in text


def test_what_is_printed_adds_up() -> None:
    one, two = cliff_study().lanes
    name = LAST_100.id
    one = replace(
        one, estimates={name: Estimate(-49.04, 2.46, 64)}, differences={name: difference(25.08, 2.44, 64)}
    )
    two = replace(two, estimates={name: Estimate(-23.96, 0.76, 64)})
    text = said(lanes(cliff_study(lanes=(one, two))))
    assert "−49.0 ± 2.5" in text
    assert "−24.0 ± .8" in text
    assert "higher by 25.0 ± 2.4 (17.8 to 32.2)" in text


def test_one_seed_has_no_verdict() -> None:
    alone = replace(difference(1.0, 0.0, 1), mean=Estimate(1.0, None, 1))
    assert verdict_of(LAST_100, alone) is None


# Secrets


def test_a_bandit_keeps_its_secrets_until_they_are_out() -> None:
    snapshot = changed(bandit(400), study=bandit_study())
    hidden = said(snapshot)
    for secret in ("regret 1", "best arm 6", "greedy", "146", ".79", "1.51"):
        assert secret not in hidden
    assert "w h shows regret and best arm" in hidden
    assert "winnings" in hidden
    revealed = said(snapshot, revealed=True)
    for secret in ("146 ± 2", "79 ± 2", "1.51 ± .03"):
        assert secret in revealed


def test_a_mean_of_100_above_the_best_arm_is_explained() -> None:
    lucky = changed(bandit(1_000), return_last_100=1.56, study=bandit_study())
    assert f"last 100, 1.56, {ABOVE_BEST}, 1.50: a mean of 100 noisy rewards" in said(lucky)
    assert ABOVE_BEST not in said(changed(lucky, return_last_100=1.4))
    secret = said(changed(bandit(400), return_last_100=1.56, study=bandit_study()))
    assert "1.50" not in secret
    assert "it can be above the best arm's mean" in secret


# Sizes and characters


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
    from rl_tui.runs.measures import BANDIT_FIGURES
    from rl_tui.runs.measures import FIGURES as OF_RUNS

    assert {figure.id for figure in FIGURES} <= {*OF_RUNS, *BANDIT_FIGURES}
    assert [figure.id for figure in shown_figures(bandit_study(), secret=True)] == ["winnings", LAST_100.id]
