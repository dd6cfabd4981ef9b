"""What README and docs say of the program is what it is, and their links lead somewhere."""

from __future__ import annotations

import re
import runpy
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DOCS = sorted((ROOT / "docs").rglob("*.md"))
PAGES = [*sorted(ROOT.glob("*.md")), *DOCS]
INTERNALS = ROOT / "docs" / "internals"
GENERATOR = runpy.run_path(str(ROOT / "docs" / "generate.py"))


def named(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def anchors_of(path: Path) -> set[str]:
    """Return what GitHub lets a link to a heading of ``path`` end in."""
    headings = re.findall(r"^#+ (.*)$", path.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("path", DOCS, ids=named)
def test_what_comes_from_the_program_is_up_to_date(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert GENERATOR["renewed"](text) == text, "run make docs"


def test_all_that_is_generated_stands_somewhere_once() -> None:
    texts = "".join(path.read_text(encoding="utf-8") for path in DOCS)
    assert sorted(block[2] for block in GENERATOR["BLOCK"].finditer(texts)) == sorted(GENERATOR["BLOCKS"])


@pytest.mark.exhaustive(
    "measures a figure of the book", but=[each for each in GENERATOR["PICTURES"] if "figure" not in each]
)
@pytest.mark.screen
@pytest.mark.parametrize("picture", GENERATOR["PICTURES"])
def test_a_picture_is_what_the_program_draws(picture: str) -> None:
    assert GENERATOR["drawn"](picture) == (ROOT / "docs" / picture).read_text(encoding="utf-8"), (
        "run make docs"
    )


def test_make_docs_writes_and_names_only_what_changed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    main = GENERATOR["main"]
    monkeypatch.setitem(main.__globals__, "FOLDER", tmp_path)
    monkeypatch.setitem(main.__globals__, "drawn", "drawn {}".format)
    for name in ("reference/keys.md", "reference/limits.md"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes((ROOT / "docs" / name).read_bytes())
    main()
    assert [Path(line.split(": ")[0]).name for line in capsys.readouterr().out.splitlines()] == list(
        GENERATOR["PICTURES"]
    )
    (tmp_path / "playground.svg").write_text("another", encoding="utf-8")
    main()
    assert capsys.readouterr().out.startswith(f"{tmp_path / 'playground.svg'}: ")
    assert (tmp_path / "playground.svg").read_text(encoding="utf-8") == "drawn playground.svg"


@pytest.mark.parametrize("path", PAGES, ids=named)
def test_links_lead_to_what_is_there(path: Path) -> None:
    for target in re.findall(r"\]\(([^)\s]+)\)", path.read_text(encoding="utf-8")):
        if not target.startswith(("http://", "https://")):
            file, _, anchor = target.partition("#")
            there = path.parent / file if file else path
            assert there.exists(), target
            assert not anchor or anchor in anchors_of(there), target


def test_the_readme_is_one_page_and_leads_to_all_pages_for_users() -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert len(readme.splitlines()) <= 150
    users = [path for path in DOCS if INTERNALS not in path.parents]
    assert [named(path) for path in users if f"]({named(path)})" not in readme] == []


def test_the_guide_for_contributors_is_short_and_leads_to_all_internals() -> None:
    guide = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    assert len(guide.splitlines()) <= 150
    assert [named(path) for path in INTERNALS.glob("*.md") if f"]({named(path)}" not in guide] == []


@pytest.mark.parametrize("path", DOCS, ids=named)
def test_a_page_begins_with_one_heading_and_what_it_offers(path: Path) -> None:
    heading, empty, first, *_ = path.read_text(encoding="utf-8").splitlines()
    assert heading.startswith("# ")
    assert not empty
    assert re.match(r"[\w`*]", first)
