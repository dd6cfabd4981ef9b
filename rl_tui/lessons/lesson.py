"""A well-formed lesson, read from a file."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from rl_tui.common.errors import Fault, ScenarioError
from rl_tui.common.findings import Finding, in_file_order, is_plain, near, place, shown
from rl_tui.common.limits import MOST_FAULTS
from rl_tui.common.text_file import UnreadableError, read_text
from rl_tui.lessons.figures.written import written_number
from rl_tui.lessons.file.schema import LONGEST_LESSON, LONGEST_SHORT_LINE, Figure, LessonFile, Page, Setup
from rl_tui.lessons.file.variants import readable, variant_text, variants_of
from rl_tui.lessons.judging.condition_faults import prediction_findings, setting_findings, task_findings
from rl_tui.worlds.files.shipped import shipped_folder
from rl_tui.worlds.files.toml_file import tables_in
from rl_tui.worlds.sections.schema import parsed

FOLDER: Final = "lessons"
_PLACEHOLDER: Final = re.compile(r"\{([a-z][a-z0-9_-]*)\}")
_LITERAL: Final = ("figures", "setups", "variants", "program", "skeleton")
"""Tables and keys in which braces are not figures."""


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Lesson:
    """A lesson with figures filled in.

    `id` is the stem of the file. `text` is the file with the chosen `variant` ("" without variants), as
    sessions store it.
    """

    id: str
    title: str
    summary: str
    order: int
    minutes: int
    goals: tuple[str, ...]
    figures: Mapping[str, Figure]
    setups: Mapping[str, Setup]
    pages: tuple[Page, ...]
    source: Path
    text: str
    variant: str = ""
    is_core: bool = False

    @property
    def tasks(self) -> tuple[Page, ...]:
        """Pages with a task."""
        return tuple(page for page in self.pages if page.task is not None)

    @property
    def counted_predictions(self) -> tuple[Page, ...]:
        """Pages with a prediction, without guesses."""
        return tuple(page for page in self.pages if page.prediction is not None and not page.guess)

    def page(self, page_id: str) -> Page:
        """Return a page. Raises KeyError if there is none."""
        for page in self.pages:
            if page.id == page_id:
                return page
        raise KeyError(page_id)

    def number_of(self, page_id: str) -> int:
        """Return the index of a page, or 0."""
        return next((number for number, page in enumerate(self.pages) if page.id == page_id), 0)

    def panels_of(self, page_id: str) -> frozenset[str] | None:
        """Return the visible panels, None for all."""
        before = self.pages[: self.number_of(page_id) + 1]
        named = next((page.panels for page in reversed(before) if page.panels is not None), None)
        return None if named is None else frozenset(named)

    def setup_of(self, page_id: str) -> str:
        """Return a page's setup: its own, or an earlier page's."""
        setup = next(iter(self.setups))
        for page in self.pages:
            setup = page.setup or setup
            if page.id == page_id:
                break
        return setup


def lesson_folder() -> Path:
    """Return the shipped lessons' folder, next to the scenarios."""
    return shipped_folder().parent / FOLDER


def read_lesson(path: str | Path, variant: str = "") -> Lesson:
    """Read a lesson file. Raises ScenarioError with all its errors."""
    path = Path(path)
    if not is_plain(str(path)):
        raise ScenarioError([Fault(shown(str(path)), "", "the path has control characters; rename the file")])
    try:
        text = read_text(path)
    except UnreadableError as reason:
        raise ScenarioError([Fault(str(path), reason.place, reason.found, reason.expected)]) from reason
    return lesson_of(text, path, variant)


def lesson_of(text: str, path: Path, variant: str = "") -> Lesson:
    """Parse a lesson. Raises ScenarioError.

    `variant` is one of `variants_of`, by default the first. `path` is not read.
    """
    try:
        if len(text) > LONGEST_LESSON:
            raise UnreadableError("", f"{len(text):,} characters", f"a lesson of at most {LONGEST_LESSON:,}")
        raw = tables_in(readable(text))
        names = variants_of(raw)
        chosen = variant or next(iter(names), "")
        if names:
            text = variant_text(text, raw, chosen)
        raw = tables_in(text)
    except UnreadableError as reason:
        raise ScenarioError([Fault(str(path), reason.place, reason.found, reason.expected)]) from reason
    filled, findings = _filled(raw)
    file, more = parsed(LessonFile, filled)
    findings += more
    if file is not None:
        findings += _reference_findings(file)
    if findings or file is None:
        faults = (
            Fault(str(path), place(each.location), each.found, each.expected)
            for each in in_file_order(findings, raw)
        )
        raise ScenarioError(faults, raw, text)
    return Lesson(
        id=path.stem,
        title=file.title,
        summary=file.summary,
        order=file.order,
        minutes=file.minutes,
        goals=file.goals,
        figures=file.figures,
        setups=file.setups,
        pages=file.pages,
        source=path,
        text=text,
        variant=chosen,
        is_core=file.core,
    )


def is_lesson_text(text: str) -> bool:
    """Return True for a lesson rather than a scenario."""
    return re.search(r"^\s*\[\[\s*pages\s*\]\]", text, re.MULTILINE) is not None


def _filled(raw: Mapping[str, Any]) -> tuple[dict[str, Any], list[Finding]]:
    """Return `raw` with figures filled in, and the names that are not figures."""
    figures = raw.get("figures")
    values: dict[str, str] = {
        name: figure["value"][: LONGEST_SHORT_LINE + 1]  # a longer value is refused later
        for name, figure in (figures.items() if isinstance(figures, dict) else ())
        if isinstance(figure, dict) and isinstance(figure.get("value"), str)
    }
    findings: list[Finding] = []

    def fill(value: Any, location: tuple[str | int, ...]) -> Any:
        if isinstance(value, dict):
            return {
                key: inner if key in _LITERAL else fill(inner, (*location, key))
                for key, inner in value.items()
            }
        if isinstance(value, list):
            return [fill(inner, (*location, number)) for number, inner in enumerate(value)]
        return _with_figures(value, location) if isinstance(value, str) else value

    def _with_figures(text: str, location: tuple[str | int, ...]) -> Any:
        def put_in(match: re.Match[str]) -> str:
            name = match[1]
            if name not in values and len(findings) > MOST_FAULTS:  # enough errors are reported
                return match[0]
            if name not in values:
                findings.append(Finding(location, f"{{{name}}}", f"the name of a figure{near(name, values)}"))
                return match[0]
            return values[name]

        filled = _PLACEHOLDER.sub(put_in, text)
        # a lone figure becomes a number: answer = "{v_class}"
        is_number = _PLACEHOLDER.fullmatch(text) is not None and location[-1] in ("answer", "tolerance")
        return number_in(filled) if is_number and number_in(filled) is not None else filled

    return fill(raw, ()), findings


def number_in(text: str) -> float | None:
    """Parse a number with commas, minus or percent sign."""
    number = written_number(text)
    return None if number is None else number.value


def _reference_findings(file: LessonFile) -> Iterator[Finding]:
    seen = set[str]()
    for number, page in enumerate(file.pages):
        where = ("pages", number)
        if page.id in seen:
            yield Finding((*where, "id"), shown(page.id), "a name that no other page has")
        seen.add(page.id)
        if page.setup is not None and page.setup not in file.setups:
            yield Finding((*where, "setup"), shown(page.setup), f"one of {', '.join(file.setups)}")
        if page.prediction is not None:
            yield from (each.inside(*where, "prediction") for each in prediction_findings(page.prediction))
        if page.task is not None:
            yield from (each.inside(*where, "task") for each in task_findings(page.task))
        proof = page.task.proof if page.task else None
        if page.task is not None and proof is not None:
            if proof.best not in file.figures:
                yield Finding((*where, "task", "proof", "best"), shown(proof.best), "the name of a figure")
            if proof.condition >= len(page.task.conditions):
                found = str(proof.condition)
                yield Finding(
                    (*where, "task", "proof", "condition"), found, "the number of a condition, from 0"
                )
    for name, setup in file.setups.items():
        yield from (each.inside("setups", name, "settings") for each in setting_findings(setup.settings))
    for name, figure in file.figures.items():
        if figure.setup is not None and figure.setup not in file.setups:
            expected = f"one of {', '.join(file.setups)}"
            yield Finding(("figures", name, "setup"), shown(figure.setup), expected)
