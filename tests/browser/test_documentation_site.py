"""The site of the documentation."""

from __future__ import annotations

import base64
import re
import shlex
from collections.abc import AsyncIterator, Callable, Iterator
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import build_site
import click
import pytest
import pytest_asyncio
import site_pages
from click.testing import CliRunner
from export_samples import ran

from rl_tui.commands.main import program
from rl_tui.common.kiosk import VARIABLE as KIOSK

pytest.importorskip("aiohttp", reason='needs aiohttp: pip install "rl-tui[serve]"')
from chromium import Chromium, chromium

ROOT = Path(__file__).parents[2]
builds = pytest.mark.exhaustive("builds the site")

SEARCH = (
    "[...document.querySelectorAll('*')].find((each) => each.shadowRoot?.querySelector('dialog'))?.shadowRoot"
)
RECORDING = '{"version": 2, "width": 80, "height": 24}\n[0.5, "o", "an agent learns"]\n'


def in_a_browser(test: Callable[..., object]) -> object:
    without = pytest.mark.skipif(chromium() is None, reason="needs Chromium: apt-get install chromium")
    return without(pytest.mark.asyncio(loop_scope="module")(test))


class Links(HTMLParser):
    """What a page asks for (``loaded``), where it leads (``targets``), and its anchors."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.loaded: list[str] = []
        self.targets: list[str] = []
        self.anchors: set[str] = {""}
        self.feed(text)

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        given = {name: value or "" for name, value in attributes}
        self.anchors.update(given[name] for name in ("id", "name") if name in given)
        if "href" in given:
            (self.targets if tag == "a" else self.loaded).append(given["href"])
        self.loaded += [given["src"]] if "src" in given else []


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    pytest.importorskip("zensical", reason='needs Zensical: pip install "rl-tui[site]"')
    pytest.importorskip("mkdocs_asciinema_player", reason='needs the player: pip install "rl-tui[site]"')
    folder = tmp_path_factory.mktemp("documentation")
    (folder / "learning.cast").write_text(RECORDING, encoding="utf-8")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(build_site, "RECORDINGS", folder)
        yield build_site.build(folder).parent


@pytest_asyncio.fixture(scope="module", loop_scope="module")
async def browser(tmp_path_factory: pytest.TempPathFactory) -> AsyncIterator[Chromium]:
    async with Chromium(tmp_path_factory.mktemp("browser") / "profile") as started:
        yield started


def pages_of(site: Path) -> dict[Path, Links]:
    return {path: Links(path.read_text(encoding="utf-8")) for path in site.rglob("*.html")}


def is_elsewhere(address: str) -> bool:
    return urlsplit(address).scheme in ("http", "https") or address.startswith("//")


def test_every_page_is_in_the_navigation_once() -> None:
    listed = re.findall(
        r"^ +- (?:.*: )?(\S+\.md)$", (ROOT / "mkdocs.yml").read_text(encoding="utf-8"), re.MULTILINE
    )
    docs = [path.relative_to(ROOT / "docs").as_posix() for path in (ROOT / "docs").rglob("*.md")]
    assert sorted(listed) == sorted([*docs, *build_site.ROOT_PAGES])


def test_lists_are_written_as_the_generator_of_the_site_needs_them() -> None:
    text = "Do:\n1. Type\n\n       rl-tui\n\n   now.\n2. Wait\n   for it.\n\nLast\n* a\n* b\n"
    assert build_site.with_wide_lists(text) == (
        "Do:\n\n1. Type\n\n        rl-tui\n\n    now.\n\n2. Wait\n    for it.\n\nLast\n\n* a\n* b\n"
    )


@builds
def test_each_scenario_algorithm_and_policy_has_a_page(site: Path) -> None:
    for scenario in site_pages.SHIPPED:
        text = (site / "scenarios" / f"{scenario.id}.html").read_text(encoding="utf-8")
        assert f'src="{scenario.id}.svg"' in text
        assert ("value at the start  " in text) == (f"rl-tui solve {scenario.id}" in text)
    for name, row in site_pages.ROWS.items():
        text = (site / "algorithms" / f"{name}.html").read_text(encoding="utf-8")
        assert row.equation.split(" ")[0] in text
        assert "import gymnasium" in re.sub(r"<[^>]+>", "", text)


@builds
def test_links_and_anchors_lead_to_what_is_there(site: Path) -> None:
    pages = pages_of(site)
    for path, links in pages.items():
        for address in (*links.targets, *links.loaded):
            place = urlsplit(address)
            if place.scheme or path.name == "404.html":
                continue
            there = (path.parent / unquote(place.path)).resolve() if place.path else path
            assert there.is_file(), f"{path.name}: {address}"
            if there in pages:
                assert unquote(place.fragment) in pages[there].anchors, f"{path.name}: {address}"


@builds
def test_lists_and_commands_of_a_page_are_not_taken_for_prose(site: Path) -> None:
    for path in site.rglob("*.html"):
        for paragraph in re.findall(r"<p>(.*?)</p>", path.read_text(encoding="utf-8"), re.DOTALL):
            is_list = re.search(r"^\s*(?:\d+\.|[*-]|\$|rl-tui) ", paragraph, re.MULTILINE)
            assert not is_list, f"{path.name}: {paragraph}"


@builds
def test_no_page_needs_a_file_from_elsewhere(site: Path) -> None:
    assert {
        address for links in pages_of(site).values() for address in links.loaded if is_elsewhere(address)
    } == set()


@builds
def test_a_newcomer_finds_three_answers_on_the_first_page(site: Path) -> None:
    targets = Links((site / "index.html").read_text(encoding="utf-8")).targets
    assert {
        "how-to/watch-a-script.html",
        "explanation/exact-answers.html#optimal-on-the-curve",
        "tutorial/teach-a-class.html",
    } <= set(targets)


@builds
@in_a_browser
@pytest.mark.parametrize(
    "page",
    ["index.html", "scenarios/cliff.html", "algorithms/sarsa.html", "reference/cheat-sheet.html"],
)
async def test_a_page_asks_for_nothing_from_elsewhere(site: Path, browser: Chromium, page: str) -> None:
    tab = await browser.open((site / page).as_uri(), (1280, 900))
    await tab.shows("document.readyState === 'complete'")
    assert [each for each in tab.asked_for if urlsplit(each).scheme not in ("file", "data", "blob")] == []
    assert tab.faults == []
    await tab.close()


@builds
@in_a_browser
async def test_the_recording_plays(site: Path, browser: Chromium) -> None:
    tab = await browser.open((site / "index.html").as_uri(), (1280, 900))
    await tab.shows("document.querySelector('.recording .ap-player') !== null")
    await tab.evaluate("document.querySelector('.recording .ap-overlay-start').click()")
    await tab.shows("document.querySelector('.recording').innerText.includes('an agent learns')")
    await tab.close()


@builds
@in_a_browser
async def test_search_works_without_a_server(site: Path, browser: Chromium) -> None:
    tab = await browser.open((site / "index.html").as_uri(), (1280, 900))
    await tab.shows("document.readyState === 'complete'")
    await tab.evaluate("document.querySelector('.md-search__button').click()")
    await tab.shows(f"{SEARCH}?.querySelector('input') !== null")
    await tab.press("eligibility")
    await tab.shows(f"{SEARCH}.querySelector('[role=listbox]').textContent.includes('SARSA(λ)')")
    await tab.close()


@builds
@in_a_browser
async def test_the_cheat_sheet_fits_one_sheet_of_paper(site: Path, browser: Chromium) -> None:
    tab = await browser.open((site / "reference" / "cheat-sheet.html").as_uri(), (1280, 900))
    await tab.shows("document.readyState === 'complete'")
    for width, height in ((8.27, 11.69), (8.5, 11)):  # A4 and letter, in inches
        document = await tab.send("Page.printToPDF", paperWidth=width, paperHeight=height)
        assert len(re.findall(rb"/Type\s*/Page\b", base64.b64decode(document["data"]))) == 1
    await tab.close()


@pytest.mark.exhaustive("computes the exact values of all scenarios")
def test_a_command_on_a_generated_page_is_one_that_the_program_takes(monkeypatch: pytest.MonkeyPatch) -> None:
    texts = build_site.made_pages().values()
    commands = {
        line
        for text in texts
        for line in re.findall(r"(?:^    |`)rl-tui ([^`\s]+ [^`\n]+)", text, re.MULTILINE)
    }
    assert len(commands) > 50
    monkeypatch.setattr(click.Command, "invoke", lambda self, context: None)
    monkeypatch.setenv(KIOSK, "")
    for line in sorted(commands):
        result = CliRunner().invoke(program, shlex.split(line))
        assert (result.exit_code, result.output) == (0, ""), line


@pytest.mark.exhaustive("trains for some seconds")
@pytest.mark.parametrize("name", site_pages.ROWS)
def test_the_plain_script_of_a_page_runs(name: str) -> None:
    text = site_pages.example_script(site_pages.ROWS[name])
    assert "Q" in ran(re.sub(r"^EPISODES = [\d_]+", "EPISODES = 20", text, flags=re.MULTILINE))
