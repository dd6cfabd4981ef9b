"""Labels and bodies around a map."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import pytest
from drawn_grids import style_at
from samples import look
from snapshots import changed, snapshot_of
from textual.geometry import Size
from textual.strip import Strip

from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.library import recipe_for
from rl_tui.runs.run import Run
from rl_tui.screen.frame.arrange import arrange
from rl_tui.screen.frame.shape import Shape, map_size
from rl_tui.screen.kit.row import WORLD
from rl_tui.screen.panels.bodies import UNSEEN, Pose, body_strips
from rl_tui.screen.panels.grid.grid import GridView
from rl_tui.screen.panels.grid.map import GridMap
from rl_tui.screen.panels.margins import ALL_SEEN, BINS, NO_MARGINS, Margins, margins_in, wanted_margins
from rl_tui.worlds.drawing import Axes, Body, BodyKind, CellKind, Grid
from rl_tui.worlds.files.catalogue import find

SIZES = [(60, 18), (80, 24), (100, 30), (120, 40), (200, 60)]
NAN = math.nan


def table(rows: int, columns: int, *, body: bool = False) -> Grid:
    axes = Axes(
        tuple(str(10 * row) for row in range(rows)),
        tuple(str(column) for column in range(columns)),
        names=("angle", "speed"),
    )
    return Grid(
        rows,
        columns,
        (CellKind.FLOOR,) * (rows * columns),
        tuple(range(rows * columns)),
        (None, None),
        "rows down, columns across",
        axes=axes,
        body=Body(BodyKind.CART_POLE, ((NAN,),) * 4) if body else None,
    )


def blackjack() -> Snapshot:
    run = Run(recipe_for(find("blackjack-table"), {}, 0), evaluate=False)
    run.advance(200)
    return snapshot_of(run)


def drawn(snapshot: Snapshot, size: tuple[int, int], *, plain: bool = False) -> tuple[GridView, list[str]]:
    place = arrange(Size(*size), Shape(snapshot.world.drawing, 290, 2))
    view = GridView(snapshot.world, look(plain))
    view.snapshot, view.cell = snapshot, place.cell
    region = place.regions[WORLD]
    return view, [strip.text for strip in view.picture(snapshot, region.width - 1, region.height)]


# Available space


def test_a_third_of_the_height_shows_the_body_with_its_heading_at_most_nine_rows() -> None:
    grid = table(6, 12, body=True)
    assert [wanted_margins(grid, height).body for height in (8, 9, 12, 15, 24, 60)] == [0, 4, 4, 5, 8, 8]
    assert wanted_margins(table(6, 12), 24).body == 0


def test_a_map_that_fits_without_labels_only_goes_without() -> None:
    grid = table(9, 12)
    assert map_size(grid, 12, 9) == (Size(1, 1), Size(12, 9))
    assert map_size(grid, 15, 10) == (Size(1, 1), Size(15, 10))


def test_a_map_that_scrolls_is_not_made_narrower_by_labels() -> None:
    assert map_size(table(30, 12), 25, 9).cell == Size(2, 1)
    assert map_size(table(30, 12), 28, 9).cell == Size(2, 1)


def test_margins_are_what_the_map_leaves_free() -> None:
    grid = table(6, 12, body=True)
    assert margins_in(grid, (3, 1), 39, 13) == Margins(3, 5, 2)
    assert margins_in(grid, (3, 1), 38, 8) == Margins(0, 0, 1)
    assert margins_in(grid, (3, 1), 36, 6) == NO_MARGINS


def test_a_map_that_scrolls_gives_way_to_labels_and_every_map_to_its_body() -> None:
    assert margins_in(table(18, 12, body=True), (3, 1), 40, 22) == Margins(4, 7, 2)
    assert margins_in(table(40, 12, body=True), (3, 1), 40, 15) == Margins(4, 5, 2)
    assert margins_in(table(40, 12), (3, 1), 40, 15) == Margins(4, 0, 1)


# Labels


@pytest.mark.parametrize("size", SIZES)
def test_cards_are_named_over_their_columns_and_sums_beside_their_rows(size: tuple[int, int]) -> None:
    view, rows = drawn(blackjack(), size)
    head = next(row for row in rows if row.split()[:1] == ["A"])
    assert view.place_at(head.index("A"), rows.index(head) + 1) is not None
    sums = ["nat", *map(str, range(21, 3, -1))]
    seen = [label for row in rows for label in row.split()[:1] if label in sums]
    assert "\n".join(seen) in "\n".join(sums)
    assert len(seen) >= 9
    twenty = next(y for y, row in enumerate(rows) if row.split()[:1] == ["20"])
    place = view.place_at(head.index("A"), twenty)
    assert place is not None
    assert view.name_at(place) == "state 20, 1, no"


def test_both_halves_of_blackjack_are_named() -> None:
    _, rows = drawn(blackjack(), (120, 40))
    left, right = rows[0].split("no usable ace")
    assert not left.strip()
    assert "usable ace" in right


@pytest.mark.parametrize("size", SIZES)
def test_labels_of_columns_are_over_their_columns_and_keep_apart(size: tuple[int, int]) -> None:
    view, rows = drawn(blackjack(), size)
    y = next(y for y, row in enumerate(rows) if row.split()[:1] == ["A"])
    names = {"A": "1", "T": "10"}
    for x, label in ((x, each) for x, each in enumerate(rows[y]) if each != " "):
        place = view.place_at(x, y + 2)
        assert place is not None
        state = view.name_at(place)
        assert not state or state.split(", ")[1] == names.get(label, label)
        assert view.cell == (1, 1) or not state or any(row[x] in "·hs" for row in rows[y + 1 : -1])
    assert set(rows[y].split()) <= {"A", "T", *"23456789"}


def test_the_caption_names_the_rows_in_view() -> None:
    view, _ = drawn(blackjack(), (60, 18))
    assert view.footing.startswith("rows ")
    assert view.footing.endswith("of 19")


def test_ascii_has_all_of_it() -> None:
    _, rows = drawn(blackjack(), (120, 40), plain=True)
    assert "".join(rows).isascii()


# Bodies


def picture(pose: Pose, width: int = 60, height: int = 8, *, plain: bool = False) -> list[str]:
    strips = body_strips(pose, width, height, look(plain))
    assert [strip.cell_length for strip in strips] == [width] * height
    return [strip.text for strip in strips]


def cart(angle: float, action: str = "", position: float = NAN) -> Pose:
    return Pose(BodyKind.CART_POLE, (position, NAN, angle, 0.5), action)


def car(position: float, action: str = "") -> Pose:
    return Pose(BodyKind.MOUNTAIN_CAR, (position, 0.01), action)


def top_of_pole(rows: list[str]) -> int:
    return min(x for x, sign in enumerate(rows[0]) if sign in "▐█▌▛▜▀▄▟▙▗▖▝▘")


def test_the_pole_leans_as_its_bin_does() -> None:
    left, upright, right = (top_of_pole(picture(cart(angle), height=9)) for angle in (-0.2, 0.0, 0.2))
    assert left < upright < right


def test_the_picture_says_what_it_shows() -> None:
    rows = picture(cart(math.radians(6.3)), 70, 9)
    assert rows[0].startswith("angle +0.11 = +6.3°")
    assert "turning +0.50 = +29°/s" in rows[1]
    assert UNSEEN in rows[2]
    assert UNSEEN not in "".join(picture(cart(0.1, position=0.5), 70, 9))
    assert "position −0.45" in picture(car(-0.45))[0]


@pytest.mark.parametrize(("width", "height"), [(30, 4), (36, 4), (42, 5), (70, 9)])
def test_where_there_is_little_room_it_still_says_the_numbers(width: int, height: int) -> None:
    assert "angle −5.7°" in "".join(picture(cart(-0.1), width, height)).replace("−0.10 = ", "")
    assert "position −0.45" in "".join(picture(car(-0.45), width, height))


def test_a_pole_leans_between_the_angles_at_which_it_falls() -> None:
    for angle in (-0.17, 0.0, 0.17):
        row = picture(cart(angle), 70, 9)[0]
        first, last = row.index("·"), row.rindex("·")
        assert first < min(map(row.index, set(row) & set("▐█▌▛▜▀▄▟▙"))) < last
    assert "falls at 12°" in picture(cart(0.0), 70, 9)[0]


def test_coast_is_its_letter_in_the_map_and_pushes_are_arrows() -> None:
    world = Run(recipe_for(find("mountain-car"), {}, 0), evaluate=False).world
    assert isinstance(world.drawing, Grid)
    assert GridMap(world.space, world.drawing).signs == ((0, -1), "c", (0, 1))


@pytest.mark.parametrize("size", [(60, 18), (80, 24), (120, 40), (160, 50)])
def test_the_car_is_above_the_bin_of_its_position(size: tuple[int, int]) -> None:
    run = Run(recipe_for(find("mountain-car"), {}, 0), evaluate=False)
    for steps in (1, 60, 60):
        run.advance(steps)
        view, rows = drawn(snapshot_of(run), size)
        car = next(row for row in rows if "▟█▙" in row)
        agent = next(row for row in rows if "◉" in row)
        assert view.cell is not None
        assert len(set(map(len, rows))) == 1
        assert abs(car.index("▟█▙") + 1 - agent.index("◉")) <= max(1, view.cell.width)


def test_a_push_is_an_arrow_at_its_side() -> None:
    cart_row = -2  # above the wheels
    assert picture(cart(0.0, "right"))[cart_row].rstrip().endswith("━━▶")
    assert picture(cart(0.0, "left"))[cart_row].strip().startswith("◀━━")
    assert not {"▶", "◀"} & set("".join(picture(car(-0.5, "coast"))))


def test_a_cart_whose_place_is_seen_stands_there() -> None:
    rows = [picture(cart(0.0, position=position))[-2] for position in (-2.0, NAN, 2.0)]
    assert [row.index("█") for row in rows] == sorted(row.index("█") for row in rows)
    assert rows[1].index("█") == 30 - 4


def test_the_car_stands_on_the_hill_below_the_flag() -> None:
    valley, slope = picture(car(-0.52)), picture(car(0.3))
    car_row = [next(y for y, row in enumerate(rows) if "▟█▙" in row) for rows in (valley, slope)]
    assert car_row[0] > car_row[1]
    assert "".join(valley).count("★") == 1


@pytest.mark.parametrize(
    "pose", [cart(0.1, "left"), cart(NAN), car(-0.5, "right"), car(0.6), car(-1.2), car(NAN)]
)
def test_bodies_fill_every_size(pose: Pose) -> None:
    for size in ((12, 4), (30, 4), (42, 5), (140, 9)):
        picture(pose, *size, plain=False)
        assert "".join(picture(pose, *size, plain=True)).isascii(), size


def of_bins(width: int, height: int) -> list[Strip]:
    grid = table(6, 12)
    body = Body(BodyKind.CART_POLE, ((NAN,), (NAN,), tuple(0.1 * x - 0.25 for x in range(6)), (0.0,) * 12))
    assert body.pose(0)[2] == pytest.approx(-0.25)
    assert body.pose(71)[2] == pytest.approx(0.25)
    snapshot = blackjack()
    space = snapshot.world.space
    world = replace(snapshot.world, drawing=replace(grid, body=body, cell_of_state=(66,) * space.states))
    view = GridView(world, look())
    shown = changed(snapshot, world=world, state=70, last_step=None, trail=())
    view.snapshot, view.cell = shown, Size(3, 1)
    return view.picture(shown, width, height)


def test_the_body_of_a_bin_is_above_the_bins_under_a_heading() -> None:
    strips = of_bins(39, 14)
    rows = [strip.text for strip in strips]
    assert "angle +14.3°" in rows[0]
    assert style_at(strips[0], 0) == look().palette.text
    assert rows[5].startswith(f"{BINS}  angle ↓  speed → ─")
    assert "".join(rows[6].split()).startswith("01234")
    assert f"{BINS}  {ALL_SEEN} · angle ↓  speed → ─" in of_bins(50, 14)[5].text


def test_row_and_column_of_the_agent_stand_out() -> None:
    strips, palette = of_bins(39, 14), look().palette
    labels = {row: style_at(strips[7 + row], 0 if row else 1) for row in range(6)}
    assert labels == {row: palette.strong if row == 5 else palette.dim for row in range(6)}
    head = strips[6].text
    assert style_at(strips[6], head.index("6")) == palette.strong
    assert style_at(strips[6], head.index("5")) == palette.dim


def test_parts_between_walls_have_their_titles_there() -> None:
    run = Run(recipe_for(find("taxi"), {}, 0), evaluate=False)
    run.advance(50)
    snapshot = snapshot_of(run)
    view, rows = drawn(snapshot, (200, 60))
    heads = "at R", "at G", "at Y", "at B", "in taxi"
    titles = [re.split("  +", row.strip()) for row in rows if ", to R" in row]
    assert titles == [[f"{head}, to {place}" for place in "RGYB"] for head in heads]
    ride = snapshot.world.space.state_names[snapshot.counters.state].split()[1]
    name = f"at {ride[0]}, to {ride[2]}"
    y = next(y for y, row in enumerate(rows) if name in row)
    strip = view.picture(snapshot, len(rows[0]), len(rows))[y]
    assert style_at(strip, rows[y].index(name)) == look().palette.strong
    assert sum(look().palette.strong == segment.style for segment in strip) == 1


@pytest.mark.parametrize("size", [(60, 18), (80, 24)])
def test_the_first_row_in_view_has_the_titles_of_its_own_part(size: tuple[int, int]) -> None:
    run = Run(recipe_for(find("taxi"), {}, 0), evaluate=False)
    run.advance(50)
    snapshot = snapshot_of(run)
    view, rows = drawn(snapshot, size)
    width, height, seen = len(rows[0]), len(rows), set()
    view.pan(-100, 0)
    for row in range(34):
        if row == 17:  # and the parts that are not in view at the left
            view.pan(-100, 100)
        head = view.picture(snapshot, width, height)[0].text
        titles = re.split("  +", head.strip()) if head.strip() else []
        places = [view.place_at(x, 1) for x in range(width)]
        names = " ".join(view.name_at(place) for place in places if place is not None)
        rides = dict.fromkeys(re.findall("(?:in|[RGYB])→[RGYB]", names))
        full = [f"{'in taxi' if ride[0] == 'i' else f'at {ride[0]}'}, to {ride[-1]}" for ride in rides]
        assert any(set(titles) <= set(each) and len(titles) >= len(rides) - 1 for each in (full, list(rides)))
        seen.update(rides)
        view.pan(1, 0)
    assert {"R→B", "G→B"} <= seen
