"""README and docs describe the program."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path

import generate
import pytest
from called import printed

from rl_tui.commands.main import RlTui

ROOT = Path(__file__).parents[2]
DOCS = sorted((ROOT / "docs").rglob("*.md"))
PAGES = [*sorted(ROOT.glob("*.md")), *DOCS]
FOLDERS = ("tutorial", "how-to", "explanation", "reference")
GUIDES = [path for path in DOCS if path.parent.name in FOLDERS[:3]]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def named(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def anchors_of(path: Path) -> set[str]:
    headings = re.findall(r"^#+ (.*)$", path.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("path", DOCS, ids=named)
def test_what_comes_from_the_program_is_up_to_date(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert generate.renewed(text) == text, "run make docs"


def test_all_that_is_generated_stands_somewhere_once() -> None:
    texts = "".join(path.read_text(encoding="utf-8") for path in DOCS)
    assert sorted(block[2] for block in generate.BLOCK.finditer(texts)) == sorted(generate.BLOCKS)


@pytest.mark.exhaustive(
    "measures a figure of the book, or plays for long",
    but=[each for each in generate.PICTURES if "figure" not in each and not each.endswith(".cast")],
)
@pytest.mark.screen
@pytest.mark.parametrize("picture", generate.PICTURES)
def test_a_picture_is_what_the_program_draws(picture: str) -> None:
    assert generate.drawn(picture) == (ROOT / "docs" / picture).read_text(encoding="utf-8"), "run make docs"


def test_make_docs_writes_and_names_only_what_changed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(generate, "FOLDER", tmp_path)
    monkeypatch.setattr(generate, "drawn", "drawn {}".format)
    for name in ("reference/keys.md", "reference/agents.md"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes((ROOT / "docs" / name).read_bytes())
    generate.main()
    written = [Path(line.split(": ")[0]) for line in capsys.readouterr().out.splitlines()]
    assert [path.relative_to(tmp_path).as_posix() for path in written] == list(generate.PICTURES)
    (tmp_path / "playground.svg").write_text("another", encoding="utf-8")
    generate.main()
    assert capsys.readouterr().out.startswith(f"{tmp_path / 'playground.svg'}: ")
    assert (tmp_path / "playground.svg").read_text(encoding="utf-8") == "drawn playground.svg"


def test_links_lead_to_what_is_there() -> None:
    for path in PAGES:
        for target in re.findall(r"\]\(([^)\s]+)\)", path.read_text(encoding="utf-8")):
            if not target.startswith(("http://", "https://")):
                file, _, anchor = target.partition("#")
                there = path.parent / file if file else path
                assert there.exists(), (named(path), target)
                assert not anchor or anchor in anchors_of(there), (named(path), target)


def links_of(path: Path) -> Iterator[Path]:
    for target in re.findall(r"\]\(([^)\s#]+\.md)", path.read_text(encoding="utf-8")):
        page = (path.parent / target).resolve()
        if "://" not in target and page.exists():
            yield page


def test_the_readme_is_one_page_and_every_page_is_reached_from_it() -> None:
    assert len(README.splitlines()) <= 150
    reached, waiting = set[Path](), [ROOT / "README.md"]
    while waiting:
        page = waiting.pop()
        if page not in reached:
            reached.add(page)
            waiting += links_of(page)
    assert [named(path) for path in DOCS if path not in reached] == []


def test_the_page_for_contributors_is_short() -> None:
    assert len((ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8").splitlines()) <= 150


@pytest.mark.parametrize("path", sorted({*DOCS} - {*GUIDES}), ids=named)
def test_a_page_begins_with_one_heading_and_what_it_offers(path: Path) -> None:
    heading, empty, first, *_ = path.read_text(encoding="utf-8").splitlines()
    assert heading.startswith("# ")
    assert not empty
    assert re.match(r"[\w`*]", first)


@pytest.mark.parametrize("path", GUIDES, ids=named)
def test_a_guide_has_a_result_short_paragraphs_and_limits(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    heading, empty, first, *_ = text.splitlines()
    assert (heading[:2], empty, first.startswith("After this page you ")) == ("# ", "", True)
    last = "Next" if path.parent.name == "tutorial" else "Limits"
    assert re.findall(r"^## (.*)$", text, re.MULTILINE)[-1] == last
    prose = re.sub(r"^```.*?^```$", "", text, flags=re.MULTILINE | re.DOTALL)
    lines = [line for line in prose.splitlines() if not line.startswith(("|", "!["))]
    assert [line for line in lines if len(line) > 120] == []
    paragraphs = re.findall(r"(?:^[^\s|#*>\d!-].*\n)+", prose, re.MULTILINE)
    assert [each for each in paragraphs if each.count("\n") > 5] == []


def test_the_python_of_a_guide_runs(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)  # one block writes a picture
    blocks = re.findall(
        r"^```python\n(.*?)^```$", "".join(path.read_text(encoding="utf-8") for path in GUIDES), re.M | re.S
    )
    names: dict[str, object] = {}
    for block in blocks:
        exec(block.replace("runs=50", "runs=2, episodes=50"), names)
    assert len(blocks) == 5
    shown = capsys.readouterr().out
    assert "frozenlake-slippery: sarsa, seeds 0 to 1" in shown
    assert "alpha is 7" in shown


@pytest.mark.parametrize(
    "command",
    [
        "python3 -m venv .venv && .venv/bin/pip install -e . && .venv/bin/rl-tui",
        'python3 -m venv .venv && .venv/bin/pip install -e ".[test]" && .venv/bin/python -m pytest',
    ],
)
def test_the_two_commands_for_a_fresh_machine_stand_there(command: str) -> None:
    assert README.count(f"\n    {command}\n") == 1


def test_the_tables_of_fields_have_all_fields_of_the_documents() -> None:
    commands = (ROOT / "docs/reference/commands.md").read_text(encoding="utf-8")

    def fields(command: str) -> set[str]:
        section = re.search(rf"^### {re.escape(command)}\n(.*?)^##", commands, re.MULTILINE | re.DOTALL)
        assert section
        table = re.search(r"^\| field .*?\n\n", section[1], re.MULTILINE | re.DOTALL)
        assert table
        cells = re.findall(r"^\| (`.*?) \|", table[0], re.MULTILINE)
        return {name for cell in cells for name in re.findall(r"`([^`]+)`", cell)}

    def found(*args: str) -> set[str]:
        return set(json.loads(printed(*args, "--json")))

    metrics = set(re.findall(r"^\| `(\w+)` ", generate.BLOCKS["run_measures"](), re.MULTILINE))
    assert found("train", "bandit", "--episodes", "9", "--change", "5:epsilon=0") == fields("train") | metrics
    assert found("train", "student", "--episodes", "9", "--runs", "2") == fields("train --runs")
    assert found("solve", "student", "--flips") == fields("solve")
    assert found("evaluate", "student", "--policy", "uniform") == fields("evaluate")
    assert found("why", "student") == fields("why")
    assert found("check", "random-walk", "--deep") == fields("check --deep")
    assert found("sweep", "student", "--vary", "alpha=.1,.2", "--runs", "2", "--episodes", "9") == fields(
        "sweep"
    )


def test_every_option_they_name_exists() -> None:
    guides = "".join(path.read_text(encoding="utf-8") for path in DOCS if path.parent.name in FOLDERS)
    option = re.compile(r"(?<![\w-])--[a-z][a-z-]+")
    commands = [(), *((name,) for name in RlTui.modules), ("agent", "new")]
    helps = "".join(printed(*names, "--help") for names in commands)
    others = re.compile(r"^ *(#SBATCH|(srun )?dask) .*$", re.MULTILINE)  # lines for other programs
    assert set(option.findall(others.sub("", README + guides))) - set(option.findall(helps)) == set()
