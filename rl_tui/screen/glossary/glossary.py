"""The glossary's terms, and their search."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from functools import cache
from pathlib import Path
from typing import Any, Final, NamedTuple

from rl_tui.common.words import counted
from rl_tui.screen.theme.glyphs import ASCII, Glyphs

# Terms and search


BOOK: Final = "Sutton & Barto, 2nd ed."
_ELSEWHERE: Final = ("not ", "a word of this program")
_NO_LINE_BEFORE: Final = "(?<!─)"
_NO_LINE_AFTER: Final = "(?!─)"
_TINY: Final = re.compile(r"(?<!\S)[<>][−-]?\.?\d+")
_LAST: Final = re.compile(r"\b(?:mean of the )?last \d+")
_FILE: Final = Path(__file__).with_name("glossary.toml")


class FigureKind(StrEnum):
    """A metric's origin."""

    EXACT = "exact"
    SAMPLED = "sampled"
    LEARNED = "learned"
    COUNTED = "counted"


class FigureLimit(StrEnum):
    """A metric's scope."""

    EPISODE = "episode"  # an episode, up to the time limit
    NONE = "none"
    STEP = "step"
    RUN = "run"  # all of the run so far
    MOMENT = "moment"  # the last moments of real time


@dataclass(frozen=True, slots=True)
class FigureFacts:
    """Facts for comparing metrics, None if inapplicable."""

    kind: FigureKind
    discounted: bool | None
    limit: FigureLimit
    episodes: int | None = None
    over_seeds: bool = False


@dataclass(frozen=True, slots=True)
class GlossaryTerm:
    """A ``word`` with other forms. ``figure``: set if it names a metric."""

    id: str
    word: str
    also: tuple[str, ...]
    text: str
    equation: str
    book: str
    figure: FigureFacts | None = None

    @property
    def is_elsewhere(self) -> bool:
        """True if it is not from Sutton & Barto."""
        return self.book.startswith(_ELSEWHERE)

    @property
    def names(self) -> tuple[str, ...]:
        """The word and all other forms."""
        return (self.word, *self.also)


@cache
def glossary() -> Mapping[str, GlossaryTerm]:
    """Return all terms, each after those it builds on."""
    rows = tomllib.loads(_FILE.read_text(encoding="utf-8"))["term"]
    terms = (
        GlossaryTerm(
            id=row["id"],
            word=row.get("word", ""),
            also=tuple(row.get("also", ())),
            text=" ".join(row.get("text", "").split()),
            equation=row.get("equation", ""),
            book=row.get("book", ""),
            figure=_figure(row),
        )
        for row in rows
    )
    return {term.id: term for term in terms}


def _figure(row: Mapping[str, Any]) -> FigureFacts | None:
    if "kind" not in row:
        return None
    kind, limit = FigureKind(row["kind"]), FigureLimit(row["limit"])
    return FigureFacts(kind, row.get("discounted"), limit, row.get("episodes"), row.get("over_seeds", False))


def terms_called(names: Iterable[str]) -> tuple[str, ...]:
    """Return the terms with one of ``names``."""
    ids = {name: term.id for term in glossary().values() for name in term.names}
    return tuple(dict.fromkeys(ids[name] for name in names if name in ids))


def term_at(text: str, column: int, glyphs: Glyphs, about: Collection[str] | None = None) -> str | None:
    """Return the longest term at ``column``.

    Panels use symbols differently, so a symbol counts only if its id is in ``about`` (None allows all).
    """
    pattern, ids, signs = _written(glyphs is ASCII)
    for match in _TINY.finditer(text):
        if match.start() <= column < match.end():
            return "tiny-number"
    for match in _LAST.finditer(text):
        if match.start() <= column < match.end():
            return "last-100"
    for match in pattern.finditer(text):
        if match.start() <= column < match.end():
            id_ = ids[_key(match[0])]
            return None if match[0] in signs and about is not None and id_ not in about else id_
    return None


@cache
def _written(in_ascii: bool) -> tuple[re.Pattern[str], Mapping[str, str], frozenset[str]]:
    """Return a pattern for names, the terms' ids, and the symbols."""
    ids: dict[str, str] = {}
    signs = set[str]()
    for term in glossary().values():
        for name in term.names:
            written = ASCII.spelled(name) if in_ascii else name
            ids.setdefault(_key(written), term.id)
            if len(name) == 1 and not name.isalnum():
                signs.add(written)
    longest_first = sorted(ids, key=len, reverse=True)
    return re.compile("|".join(map(_pattern, longest_first))), ids, frozenset(signs)


def _key(name: str) -> str:
    return name if len(name) == 1 else name.casefold()


def _pattern(name: str) -> str:
    """Return a pattern that matches no part of a word or line."""
    before = r"(?<!\w)" if name[0].isalnum() else _NO_LINE_BEFORE
    after = r"(?!\w)" if name[-1].isalnum() else _NO_LINE_AFTER
    if len(name) == 1 and name.isascii() and name.islower():
        after = "(?= =)"
    return f"{before}{re.escape(name) if len(name) == 1 else f'(?i:{re.escape(name)})'}{after}"


def search(query: str) -> tuple[str, ...]:
    """Return the matching ids, best first."""
    wanted = query.strip().lstrip("/").casefold()
    ranked = ((rank, term.id) for term in glossary().values() if (rank := _rank(term, wanted)) is not None)
    return tuple(id_ for _, id_ in sorted(ranked, key=lambda each: each[0]))


def _rank(term: GlossaryTerm, wanted: str) -> int | None:
    names = [form.casefold() for name in term.names for form in (name, ASCII.spelled(name))]
    if any(name.startswith(wanted) for name in names):
        return 0
    if any(wanted in name for name in names):
        return 1
    return 2 if wanted in term.text.casefold() else None


# The explanation of a number


_KINDS: Final = {
    FigureKind.EXACT: "exact: computed from the transition table, not played",
    FigureKind.SAMPLED: "sampled: from this one run, luck included",
    FigureKind.LEARNED: "learned: the agent's estimate so far",
    FigureKind.COUNTED: "counted",
}
_OF_SEEDS: Final = "sampled: over many seeds"
_LIMITS: Final = {
    FigureLimit.EPISODE: "within the time limit of an episode, if it has one",
    FigureLimit.NONE: "ignoring any time limit",
    FigureLimit.STEP: "of one step",
    FigureLimit.RUN: "over the whole run so far",
    FigureLimit.MOMENT: "over the last moments",
}


class FigureSetting(NamedTuple):
    """A metric's current settings."""

    gamma: str  # γ as the screen writes it
    time_limit: int  # steps until an episode is truncated; 0: none
    steps: int
    episodes: int
    is_bandit: bool = False  # True if each pull is an episode
    budget: int | None = None  # most pulls of a bandit


def figure_text(facts: FigureFacts, now: FigureSetting | None = None) -> str:
    """Describe a metric, with numbers if known."""
    kind = _OF_SEEDS if facts.over_seeds else _KINDS[facts.kind]
    parts = [kind, _discounted(facts, now), _limit(facts.limit, now), _mean(facts, now)]
    return " · ".join(filter(None, parts))


def _discounted(facts: FigureFacts, now: FigureSetting | None) -> str:
    if facts.discounted is None:
        return ""
    if not facts.discounted:
        return "undiscounted"
    if now is not None and now.is_bandit:
        return "nothing follows a pull, so nothing is discounted"
    return f"discounted, γ {now.gamma}" if now is not None else "discounted"


def _limit(limit: FigureLimit, now: FigureSetting | None) -> str:
    if now is None:
        return _LIMITS[limit]
    if limit is FigureLimit.RUN:
        if now.budget is None:
            return f"over the {counted(now.steps, 'step')} so far"
        return f"over {now.steps:,} of the budget of {counted(now.budget, 'pull')}"
    if limit not in (FigureLimit.EPISODE, FigureLimit.NONE):
        return _LIMITS[limit]
    if now.is_bandit:
        return "of one pull, which is an episode"
    if not now.time_limit:
        return "this world has no time limit"
    steps = f"this world's time limit of {counted(now.time_limit, 'step')}"
    return f"within {steps}" if limit is FigureLimit.EPISODE else f"ignoring {steps}"


def _mean(facts: FigureFacts, now: FigureSetting | None) -> str:
    if facts.episodes is None:
        return ""
    last = facts.episodes if now is None else min(facts.episodes, now.episodes)
    noun = "pull" if now is not None and now.is_bandit else "episode"
    return f"mean of the last {counted(last, noun)}" if last else ""
