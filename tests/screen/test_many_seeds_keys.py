"""Many seeds on the real screen."""

from __future__ import annotations

from dataclasses import replace

import pytest
from conftest import MakeApp
from lane_samples import lane_views, side_by_side
from samples import answered, bandit, lake, look
from seams import on_screen, playground, screen_text, show
from snapshots import changed
from study_samples import bandit_study, cliff_study, lake_study
from textual.pilot import Pilot
from textual.widgets import OptionList, Static

from rl_tui.common.errors import UserError
from rl_tui.live.commands import Command, EndStudy, StudySeeds
from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.kit.row import CURVE, MANY_SEEDS, MICROSCOPE, TABLE
from rl_tui.screen.panels.curve.curve import ReturnCurve
from rl_tui.screen.panels.curve.data import curve_data
from rl_tui.screen.theme.glyphs import UNICODE
from rl_tui.screen.theme.look import Look, palette_for
from rl_tui.studies.many_seeds.figures import SeedStudy, StudyState


def recorded(pilot: Pilot[UserError], monkeypatch: pytest.MonkeyPatch) -> list[Command]:
    sent = list[Command]()
    monkeypatch.setattr(playground(pilot).link, "send", sent.append)
    return sent


async def fed(pilot: Pilot[UserError], study: SeedStudy | None) -> str:
    screen = playground(pilot)
    assert screen.snapshot is not None
    show(screen, replace(screen.snapshot, study=study))
    await pilot.pause()
    return screen_text(pilot.app)


@pytest.mark.exhaustive("plays at other sizes", but=["size1"])
@pytest.mark.parametrize("size", [(60, 18), (80, 24), (120, 40), (200, 60)])
async def test_a_key_opens_it_beside_the_curve_and_closes_it_as_escape_does(
    make_app: MakeApp, monkeypatch: pytest.MonkeyPatch, size: tuple[int, int]
) -> None:
    async with on_screen(make_app("frozenlake-slippery"), size) as pilot:
        board, sent = playground(pilot).board, recorded(pilot, monkeypatch)
        await pilot.press("t", "m")
        await pilot.pause()
        assert sent == [StudySeeds()]
        assert board.panel(MANY_SEEDS).has_focus
        assert board.shows(CURVE) is (size == (80, 24)), "else it covers that"
        assert board.shows(TABLE) is (size[1] >= 40), "it lies below"
        await fed(pilot, lake_study(state=StudyState.STARTING, seeds=0, lanes=()))
        assert "8 of 256" in await fed(pilot, lake_study(seeds=8))
        assert "64 of 256" in await fed(pilot, lake_study())
        assert sent == [StudySeeds()]
        await pilot.press("enter")
        assert sent == [StudySeeds()]
        await fed(pilot, lake_study(state=StudyState.DONE, seeds=256))
        await pilot.press("enter")
        assert sent == [StudySeeds(), StudySeeds()]
        await pilot.press("t", "m")
        await pilot.pause()
        assert sent[2:] == [EndStudy()]
        assert board.shows(TABLE)
        assert not board.panel(MANY_SEEDS).has_focus
        await pilot.press("t", "m", "d")
        await pilot.pause()
        assert board.opened == MICROSCOPE
        await pilot.press("t", "m", "escape")
        await pilot.pause()
        assert board.opened is None
        orders = [each for each in sent[3:] if each in (StudySeeds(), EndStudy())]
        assert orders == [StudySeeds(), EndStudy()] * 2


async def test_keys_scroll_a_small_one(make_app: MakeApp, monkeypatch: pytest.MonkeyPatch) -> None:
    async with on_screen(make_app("frozenlake-slippery"), (60, 18)) as pilot:
        recorded(pilot, monkeypatch)
        await pilot.press("t", "m")
        assert "64 of 256" in await fed(pilot, cliff_study())
        await pilot.press("end")
        await pilot.pause()
        assert "64 of 256" not in screen_text(pilot.app)
        await pilot.press("home")
        await pilot.pause()
        assert "64 of 256" in screen_text(pilot.app)
        assert "not in a kiosk" in await fed(pilot, SeedStudy(StudyState.FAILED, message="not in a kiosk"))


# The curve


def chart(snapshot: Snapshot, shown_with: Look | None = None) -> ReturnCurve:
    made = ReturnCurve(shown_with or look())
    made.snapshot = snapshot
    return made


def pieces(made: ReturnCurve, width: int = 100, height: int = 14) -> list[tuple[str, object]]:
    rows = made.picture(made.snapshot, width, height)
    assert [row.cell_length for row in rows] == [width] * height
    return [(piece.text, piece.style) for row in rows for piece in row]


def test_the_band_of_many_seeds_lies_behind_the_curve() -> None:
    snapshot = changed(lake(), study=lake_study())
    made = chart(snapshot)
    dim = made.look.palette.dim
    drawn = pieces(made)
    assert any(style == dim and any(0x2800 < ord(c) <= 0x28FF for c in text) for text, style in drawn)
    assert any("64 seeds" in text and style == dim for text, style in drawn)
    assert any(style == made.look.palette.episodes for _, style in drawn)
    assert "64 seeds: mean ± 2 errors" in made.heading


@pytest.mark.parametrize(
    "study", [None, lake_study(is_outdated=True), lake_study(seeds=1), lake_study(lanes=()), cliff_study()]
)
def test_there_is_no_band_without_a_study_of_these_runs(study: SeedStudy | None) -> None:
    snapshot = changed(lake(), study=study)
    assert not curve_data(answered(snapshot)).seeds
    assert pieces(chart(snapshot)) == pieces(chart(lake()))


def test_the_band_ends_where_the_run_is_and_is_as_wide_as_told() -> None:
    snapshot = changed(lake(), episodes=1_000, study=lake_study())
    (found,) = curve_data(answered(snapshot)).seeds
    assert found.band.end[-1] == 1_000
    assert found.band.high - found.band.low == pytest.approx(0.08)


@pytest.mark.parametrize("depth", ["truecolor", "256", "16", "none"])
@pytest.mark.parametrize("ascii", [False, True])
def test_each_lane_has_its_band(depth: str, ascii: bool) -> None:  # noqa: A002
    shown_with = look(ascii, depth)
    snapshot = side_by_side(2, 1, study=cliff_study())
    made = chart(snapshot, shown_with)
    drawn = "".join(text for text, _ in pieces(made, 140))
    assert len(curve_data(answered(snapshot)).seeds) == 2
    if ascii:
        assert "=" in drawn
    error = "+/-" if ascii else "±"
    assert f"{error} .5, 2) " in made.look.glyphs.spelled(made.heading)


def test_the_axis_has_room_for_the_mean_of_seeds() -> None:
    made = chart(changed(lake(), study=lake_study()))
    pieces(made)
    before = made.scale
    unlucky = chart(changed(lake(), return_last_100=0.0, greedy_return=0.0, study=cliff_one_lane()))
    pieces(unlucky)
    assert before is not None
    assert unlucky.scale.low <= -24.0 < before.low


def cliff_one_lane() -> SeedStudy:
    return cliff_study(lanes=cliff_study().lanes[1:], shown=0)


# The dialog


def rows(pilot: Pilot[UserError]) -> list[str]:
    choices = pilot.app.screen.query_one(OptionList)
    prompts = (choices.get_option_at_index(place).prompt for place in range(choices.option_count))
    return [line for prompt in prompts for line in str(prompt).splitlines()]


async def compared(pilot: Pilot[UserError], snapshot: Snapshot, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    recorded(pilot, monkeypatch)
    show(playground(pilot), snapshot)
    await pilot.press("c", "c")
    await pilot.pause()
    return rows(pilot)


@pytest.mark.exhaustive("plays at another size", but=["size0"])
@pytest.mark.parametrize("size", [(60, 18), (80, 24), (120, 40)])
async def test_the_dialog_has_means_and_errors_below_each_lane(
    make_app: MakeApp, monkeypatch: pytest.MonkeyPatch, size: tuple[int, int]
) -> None:
    async with on_screen(make_app("frozenlake-slippery"), size) as pilot:
        listed = await compared(pilot, side_by_side(2, 1, study=cliff_study()), monkeypatch)
        first, second = (listed[place].replace(" to 500", "").split() for place in (2, 4))
        assert first == ["64", "seeds", "−47.1", "±", ".5", "−13.00", "±", "0"]
        assert second == ["64", "seeds", "−24.6", "±", ".4", "−17.00", "±", ".06"]
        assert " to 500" in listed[2]
        width = pilot.app.screen.query_one(OptionList).scrollable_content_region.width
        assert max(map(len, listed[:5])) <= width


@pytest.mark.exhaustive("plays at another size", but=["size0"])
@pytest.mark.parametrize("size", [(60, 18), (80, 24)])
async def test_of_a_bandit_it_has_winnings_and_once_revealed_regret(
    make_app: MakeApp, monkeypatch: pytest.MonkeyPatch, size: tuple[int, int]
) -> None:
    async with on_screen(make_app("bandit"), size) as pilot:
        arms = bandit(400, study=bandit_study())
        lanes = tuple(
            replace(lane, q=arms.agent.q, results=replace(lane.results, bandit=arms.results.bandit))
            for lane in lane_views(2)
        )
        listed = await compared(pilot, changed(arms, lanes=lanes), monkeypatch)
        assert "winnings" in listed[0]
        assert "485" in listed[1]
        assert "1,402 ± 9" in listed[2]
        assert not any("146" in row for row in listed)
        await pilot.press("escape")
        show(playground(pilot), changed(arms, lanes=lanes, is_hidden=False))
        await pilot.press("c", "c")
        await pilot.pause()
        listed = rows(pilot)
        assert "146 ± 2" in listed[2]
        width = pilot.app.screen.query_one(OptionList).scrollable_content_region.width
        assert max(map(len, listed[:5])) <= width


async def test_the_dialog_without_a_study(make_app: MakeApp, monkeypatch: pytest.MonkeyPatch) -> None:
    async with on_screen(make_app("frozenlake-slippery")) as pilot:
        one, two = lane_views(2)
        one = replace(one, episodes=27, results=replace(one.results, greedy_return=None, greedy_ends=0.0))
        snapshot = changed(side_by_side(2), lanes=(one, replace(two, episodes=35)))
        listed = await compared(pilot, snapshot, monkeypatch)
        assert "last 27–35" in listed[0]
        assert listed[1].removesuffix("control").rstrip().endswith("no end")
        await pilot.press("escape")
        listed = await compared(pilot, side_by_side(2, 1, study=cliff_study(is_outdated=True)), monkeypatch)
        about = str(pilot.app.screen.query_one("#about", Static).render())
        assert about.endswith("One seed proves nothing: t m runs many.")
        assert not any("±" in row for row in listed)


def test_the_look_of_no_colour_tells_the_band_from_the_line() -> None:
    none = Look(UNICODE, palette_for("none", True))
    drawn = pieces(chart(changed(lake(), study=lake_study()), none))
    assert any(style == none.palette.dim for _, style in drawn)
