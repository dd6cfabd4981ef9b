"""The glossary as data."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path

import pytest

from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID
from rl_tui.agents.hyperparameters import PARAMETERS
from rl_tui.screen.glossary.glossary import glossary, search, term_at, terms_called
from rl_tui.screen.kit.row import CONTROLS, LAST_STEP, TABLE, TIMELINE, WORLD, PanelRow
from rl_tui.screen.panels.catalogue import PANELS
from rl_tui.screen.theme.glyphs import ASCII, UNICODE, Glyphs

AGENTS = (Path(__file__).parents[2] / "docs/reference/agents.md").read_text(encoding="utf-8")


def test_a_term_has_all_that_is_told_of_it() -> None:
    for term in glossary().values():
        lacks = [name for name in ("word", "text", "equation", "book") if not getattr(term, name)]
        assert not lacks, f"glossary.toml: the term {term.id} lacks {', '.join(lacks)}"
        assert term.text.endswith((".", ":")), term.id
        assert term.is_elsewhere or term.book.startswith(("section", "example")), term.id
        spelled = [ASCII.spelled(text) for text in (*term.names, term.text, term.equation, term.book)]
        assert not [text for text in spelled if "?" in text], "ASCII has no spelling for a character"


@pytest.mark.parametrize("row", PANELS, ids=lambda row: row.id)
def test_a_panel_names_terms_that_there_are(row: PanelRow) -> None:
    assert row.terms
    assert set(row.terms) <= glossary().keys()
    assert 3 <= len(row.caption.split()) <= 7


def test_a_name_means_one_thing() -> None:
    names = Counter(name for term in glossary().values() for name in term.names)
    assert [name for name, count in names.items() if count > 1] == []


@pytest.mark.parametrize("name", [name for name, each in PARAMETERS.items() if each.slide is not None])
def test_every_slider_can_be_asked_about(name: str) -> None:
    assert terms_called([PARAMETERS[name].symbol])


@pytest.mark.parametrize("name", [each.name for each in (*BY_ID.values(), *POLICY_BY_ID.values())])
def test_every_algorithm_and_policy_is_found(name: str) -> None:
    assert term_at(name, 0, UNICODE), f"glossary.toml: no term has the word {name}; add one"


def test_where_the_sample_average_counts_updates_is_said_of_those_and_no_others() -> None:
    for text in (glossary()["sample-average"].text, AGENTS):
        sentences = re.split(r"[.;] ", " ".join(text.split()))
        said = next(part for part in sentences if "Double Q-learning" in part and "updates" in part)
        for each in sorted(BY_ID.values(), key=lambda row: not row.counts_updates):
            assert (each.name in said) is each.counts_updates, each.name
            said = said.replace(each.name, "")


@pytest.mark.parametrize(
    ("line", "word", "term"),
    [
        ("World · V and greedy", "V", "value"),
        ("greedy, exact .73", "exact", "greedy"),
        ("Q*, exact · 11 states", "exact", "q-star"),
        ("v: Q  Q*  Q−Q*  visits", "Q−Q*", "error"),
        ("i Q₀ 0  n seed 0", "Q₀", "optimism"),
        ("i Q₀ 0  n seed 0", "n", None),
        ("state s = 6", "s =", "state"),
        ("optimal return 1.00", "return", "gamma-best"),
        ("γ ━━━━●─── 0.990", "γ", "gamma"),
        ("step 2,000", "step", "step"),
        ("  <.01  0.3", "<", "tiny-number"),
        (" >−1 ", "−", "tiny-number"),
        ("last 12 episodes", "last", "last-100"),
        ("mean return: each episode", "mean return", "last-100"),
        ("optimal  .74", "optimal", "gamma-best"),
        ("greedy: may never end", "never", "greedy"),
        ("ended the episode", "ended", None),
        ("Return per episode", "Return", "return"),
    ],
)
def test_the_longest_name_at_a_place_counts(line: str, word: str, term: str | None) -> None:
    assert term_at(line, line.index(word), UNICODE) == term


def test_words_are_found_as_ascii_spells_them() -> None:
    assert term_at("epsilon-greedy 1.00", 0, ASCII) == "epsilon"
    assert term_at("delta 0", 2, ASCII) == "td-error"


@pytest.mark.parametrize(
    ("line", "sign", "glyphs", "panel", "term"),
    [
        ("  ●   ", "●", UNICODE, WORLD, "terminal"),
        ("5   ──●──   ┊", "●", UNICODE, WORLD, None),
        ("▸ greedy · ┃ estimate", "┃", UNICODE, WORLD, "arm"),
        ("α ●──── 0.001", "●", UNICODE, CONTROLS, None),
        ("━━━● now", "●", UNICODE, TIMELINE, None),
        ("● now", "●", UNICODE, TIMELINE, None),
        ("━━◆━━", "◆", UNICODE, TIMELINE, "branch"),
        ("◉ 4", "◉", UNICODE, TABLE, "agent"),
        ("  G   ", "G", ASCII, WORLD, "terminal"),
        ("2,1 R>G", "G", ASCII, TABLE, None),
        ("r + gamma", "+", ASCII, LAST_STEP, None),
        ("=+=", "+", ASCII, TIMELINE, "branch"),
    ],
)
def test_a_sign_counts_only_where_it_has_its_meaning(
    line: str, sign: str, glyphs: Glyphs, panel: str, term: str | None
) -> None:
    (row,) = (row for row in PANELS if row.id == panel)
    assert term_at(line, line.index(sign), glyphs, row.terms) == term


def test_a_search_finds_words_before_texts() -> None:
    assert search("regr")[0] == "regret"
    assert search("gamma")[0] == "gamma"
    assert search("/return")[0] == "return"
    assert "bootstrap" in search("spread backwards")
    assert search("xyzzy") == ()
