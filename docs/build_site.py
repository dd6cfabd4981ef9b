"""Builds the site: ``make site``.

It gathers the pages of ``docs/``, CONTRIBUTING, CHANGELOG and ``site_pages`` in ``build/docs``. Zensical
makes ``site/`` of them, as ``mkdocs.yml`` says. Nothing is fetched from elsewhere.
"""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
from importlib.resources import files
from pathlib import Path

import site_pages as pages

DOCS = Path(__file__).parent
ROOT = DOCS.parent
RECORDINGS = DOCS / "recordings"
SETTINGS = "mkdocs.yml"
ROOT_PAGES = ("CONTRIBUTING.md", "CHANGELOG.md")
FIRST_RECORDING = "watch-it-learn"
PLAYING = ("recordings.js", "play-recordings.js")
PLAYER = ("asciinema-player.min.js", "asciinema-player.css")
_LANDING_PICTURE = re.compile(r"^!\[.*\]\(playground\.svg\)$", re.MULTILINE)
_LIST_SIGN = re.compile(r"(?:[*-]|\d+\.) +")
_NOTE = re.compile(r"<!--.*?-->\n", re.DOTALL)


def build(folder: Path) -> Path:
    """Gather the pages below ``folder``, build the site there, and return its first page."""
    gather(folder / "build" / "docs")
    if folder != ROOT:
        shutil.copy(ROOT / SETTINGS, folder)
    shutil.rmtree(folder / "site", ignore_errors=True)
    command = [sys.executable, "-m", "zensical", "build", "--clean", "--strict", "--config-file", SETTINGS]
    subprocess.run(command, cwd=folder, check=True)
    return folder / "site" / "index.html"


def gather(target: Path) -> None:
    """Write all pages, pictures and other files of the site into the folder ``target``."""
    shutil.rmtree(target, ignore_errors=True)
    for source in (*DOCS.rglob("*.md"), *DOCS.glob("*.svg"), *DOCS.glob("assets/*"), DOCS / "lake.py"):
        _copy(source, target / source.relative_to(DOCS))
    for name in ROOT_PAGES:
        _copy(ROOT / name, target / name)
    _add_player(target)
    for name, text in made_pages().items():
        _write(target / name, text)
    for scenario in pages.SHIPPED:
        _write(target / "scenarios" / f"{scenario.id}.svg", pages.scenario_picture(scenario))


def made_pages() -> dict[str, str]:
    """Return the pages that are generated as a whole, by their paths."""
    scenarios = {f"scenarios/{each.id}.md": pages.scenario_page(each) for each in pages.SHIPPED}
    algorithms = {f"algorithms/{name}.md": pages.algorithm_page(row) for name, row in pages.ROWS.items()}
    lists = {"scenarios/index.md": pages.scenario_list(), "algorithms/index.md": pages.algorithm_list()}
    contents = {"scenarios/SUMMARY.md": _contents(scenarios), "algorithms/SUMMARY.md": _contents(algorithms)}
    return lists | scenarios | algorithms | contents


def _contents(made: dict[str, str]) -> str:
    """Return the list of pages by which Zensical orders those of a folder."""
    lines = (
        f"* [{text.splitlines()[0].removeprefix('# ')}]({Path(path).name})" for path, text in made.items()
    )
    return "\n".join(["* [Overview](index.md)", *lines, ""])


def _copy(source: Path, target: Path) -> None:
    """Copy a file. In a page, links lead to where the other pages are gathered."""
    if source.suffix == ".md":
        text = source.read_text(encoding="utf-8")
        _write(target, _NOTE.sub("", text.replace("](docs/", "](").replace("](../../", "](../")))
    else:
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(source, target)


def _write(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(with_wide_lists(text) if path.suffix == ".md" else text, encoding="utf-8")


def with_wide_lists(text: str) -> str:
    """Return Markdown with lists as Python-Markdown needs them: indented by four, after an empty line."""
    lines: list[str] = []
    indents: list[int] = []  # of the text of each list that is open
    is_code = has_paragraphs = False  # the second is about the item
    for line in text.splitlines():
        indent = len(line) - len(line.lstrip())
        is_new = not indents or has_paragraphs
        while line and indents and indent < indents[-1] and not is_code:
            indents.pop()
        rest = line[indents[-1] if indents else 0 :]
        sign = None if is_code else _LIST_SIGN.match(rest)
        if sign and is_new and lines and lines[-1]:
            lines.append("")
        has_paragraphs = bool(indents) and not sign and (has_paragraphs or not line)
        lines.append(f"{'    ' * len(indents)}{rest}" if line else "")
        is_code ^= rest.startswith("```")
        if sign:
            indents.append((indents[-1] if indents else 0) + sign.end())
    return "\n".join([*lines, ""])


def _add_player(target: Path) -> None:
    """Replace the picture of the first page by a recording. Add the others, and what plays them."""
    casts = sorted(RECORDINGS.glob("*.cast"), key=lambda cast: (cast.stem != FIRST_RECORDING, cast.stem))
    if not casts:
        return
    texts = {each.stem: each.read_text(encoding="utf-8") for each in casts}
    _write(target / "assets" / "recordings.js", f"const RECORDINGS = {json.dumps(texts)};\n")
    for name in PLAYER:
        content = files("mkdocs_asciinema_player").joinpath("assets", name).read_bytes()
        (target / "assets" / name).write_bytes(content)
    first, *others = (f'<div class="recording" data-name="{name}"></div>' for name in texts)
    titles = [name.replace("-", " ").capitalize() for name in texts][1:]
    more = [f"### {title}\n\n{box}" for title, box in zip(titles, others, strict=True)]
    scripts = [f'<script src="assets/{name}"></script>' for name in (PLAYER[0], *PLAYING)]
    style = f'<link rel="stylesheet" href="assets/{PLAYER[1]}">'
    page = target / "index.md"
    text = _LANDING_PICTURE.sub(first, page.read_text(encoding="utf-8"))
    _write(page, "\n\n".join([text, *(["## More recordings"] if more else []), *more, style, *scripts]))


if __name__ == "__main__":
    print(build(ROOT))
