"""The last backup as a tree (Sutton & Barto, 2nd ed., Fig. 3.4), above its targets."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import Final

import numpy as np

from rl_tui.agents.catalogue import Lookup
from rl_tui.live.last_step.backup import Backup, Leaf
from rl_tui.live.last_step.step_report import StepStory
from rl_tui.screen.draw import names, numbers
from rl_tui.screen.draw.action_order import shown_place
from rl_tui.screen.draw.canvas import Piece
from rl_tui.screen.draw.precision import agrees, column_figure, fewest_decimals, leading_zeros, parsed
from rl_tui.screen.kit.blocks import BLANK, Block, Column, Columns, Flow, Labelled, Row, Section, Table, Text
from rl_tui.screen.panels.last_step.words import StepWords
from rl_tui.screen.panels.model import HIDDEN
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.mdp.tabular_mdp import UNKNOWN_ACTION, TabularMDP
from rl_tui.worlds.world import World

BACKUP_HEADING: Final = "The backup"
AFTER_END: Final = "the episode has ended: there is no next state to look up"
NOT_KNOWN: Final = "the estimates that your program looked up are not known"
MOST_LEAVES: Final = 8
TARGET_ROWS: Final = 4
_HEAD_ROWS: Final = 3
_VALUE: Final = "V(s′)"
_VALUE_HEADS: Final = {Lookup.BEST: "max Q(s′,·)", Lookup.NEXT: "Σ π Q(s′,·)", Lookup.MEAN: "Σ π Q(s′,·)"}
_DECIMALS: Final = 3
_MORE: Final = 5  # decimals beyond the fewest


def backup_section(words: StepWords, look: Look, *, secret: Sequence[str]) -> Section:
    """Return the tree above the targets. ``secret``: a text in place of true rewards, if hidden."""
    world, backup = words.story.world, words.story.backup
    if backup is None:
        why = [Text(_why_none(words), look.palette.dim)] if words.estimate else ()
        return Section(BACKUP_HEADING, why, 1, () if words.estimate else ("none",))
    blocks = [
        *_tree(world, backup, look, secret=bool(secret)),
        *target_blocks(words, backup, look, secret=secret),
    ]
    remarks = () if backup.is_current else ("estimates as they are now", "as they are now")
    if world.mdp is None:
        remarks = ("one sample: other outcomes are unknown", "one sample")
    return Section(BACKUP_HEADING, blocks, backup_rows(world) if backup.sampled is not None else 0, remarks)


def _why_none(words: StepWords) -> str:
    story = words.story
    if story.last.terminated and not story.bootstraps:
        return AFTER_END
    if story.has_equation and words.bootstrap:
        return f"your program looked up {words.bootstrap}: the book has no such backup"
    return NOT_KNOWN  # the update explains why


def backup_rows(world: World) -> int:
    """Return the most rows of tree and targets."""
    return _HEAD_ROWS + _leaf_rows(world) + TARGET_ROWS


@lru_cache(maxsize=1)  # only one world is on screen: keep no other alive
def _most_outcomes(mdp: TabularMDP) -> int:
    return int(np.diff(mdp.first_outcome).max())


def _leaf_rows(world: World) -> int:
    return 1 if world.mdp is None else min(_most_outcomes(world.mdp), MOST_LEAVES)


def _tree(world: World, backup: Backup, look: Look, *, secret: bool) -> Iterator[Block]:
    palette, glyphs = look.palette, look.glyphs
    leaves = sorted(backup.leaves, key=lambda leaf: shown_place(world, leaf.action))
    shown, left_out = _chosen(leaves)
    state = names.state_name(world, backup.state, glyphs)
    action = names.action_name(world, int(world.space.pair_action[backup.pair]), glyphs)
    yield Row([Piece(f" {glyphs.state_node} ", palette.strong), Piece(state, palette.text)])
    yield Row(
        [
            Piece(f" {glyphs.axis_corner}", palette.dim),
            Piece(f"{glyphs.action_node} ", palette.strong),
            Piece(action, palette.text),
        ]
    )
    yield outcome_table(world, backup, shown, look, is_whole=not left_out, secret=secret)
    if left_out:
        chance = names.chance(sum(leaf.probability or 0.0 for leaf in left_out), glyphs)
        more = Piece(f"{len(left_out):,} more, together p {chance}", palette.dim)
        yield Row([Piece(f"  {glyphs.axis_corner}{glyphs.ellipsis} ", palette.dim), more])
    yield from [BLANK] * (_leaf_rows(world) - len(shown) - bool(left_out))


def _chosen(leaves: Sequence[Leaf]) -> tuple[list[Leaf], list[Leaf]]:
    if len(leaves) <= MOST_LEAVES:
        return list(leaves), []
    ranked = sorted(enumerate(leaves), key=lambda each: (not each[1].happened, -(each[1].probability or 0.0)))
    kept, left_out = ranked[: MOST_LEAVES - 1], ranked[MOST_LEAVES - 1 :]
    return [leaf for _, leaf in sorted(kept, key=lambda each: each[0])], [leaf for _, leaf in left_out]


def outcome_table(
    world: World, backup: Backup, leaves: Sequence[Leaf], look: Look, *, is_whole: bool, secret: bool
) -> Table:
    """Lay out a row for each of ``leaves`` at its branch.

    ``is_whole``: the last branch ends the tree. Dropped first: contributions, then the long head, then
    remarks.
    """
    glyphs, palette = look.glyphs, look.palette
    decimals = _decimals_that_agree(backup, leaves, look)

    def column(head: str, texts: Sequence[str], *, right: bool = True, gap: int = 2) -> Column:
        styles = (palette.strong if leaf.happened else palette.text for leaf in leaves)
        return Column(head, [*map(Piece, texts, styles)], palette.text, right, gap)

    def figures(values: Sequence[float | None]) -> list[str]:
        return ["?" if each is None else column_figure(each, decimals, glyphs) for each in values]

    def landing(*, remarks: bool) -> Column:
        return column("s′", [_landing(world, leaf, look, remarks=remarks) for leaf in leaves], right=False)

    branches = [glyphs.fork] * len(leaves)
    if is_whole:
        branches[-1:] = [glyphs.axis_corner]
    marks = [Piece(f" {glyphs.cursor if leaf.happened else ' '}", palette.strong) for leaf in leaves]
    nodes = [
        Piece(f"{glyphs.state_node} ", palette.strong if leaf.happened else palette.dim) for leaf in leaves
    ]
    tree = (
        Column("", marks, palette.dim, right=False, gap=0),
        Column(glyphs.thin_vertical, branches, palette.dim, right=False, gap=0),
        Column("", nodes, palette.dim, right=False, gap=0),
    )
    chances = ["?" if leaf.probability is None else names.chance(leaf.probability, glyphs) for leaf in leaves]
    went = _went(world, backup, leaves, look)
    always = (
        *tree,
        *([column("went", went, right=False, gap=0)] if went else []),
        column("p", chances, gap=2 if went else 0),
        column("r", [_reward(leaf, look, secret=secret) for leaf in leaves]),
    )
    if world.is_bandit:
        return Table([always])
    values = [leaf.value for leaf in leaves]
    shares = [_share(backup, leaf, leaf.value) for leaf in leaves]
    long, short = (
        column(head, figures(values)) for head in (_VALUE_HEADS.get(backup.lookup, _VALUE), _VALUE)
    )
    forms: list[Columns] = [
        (*always, landing(remarks=True), long),
        (*always, landing(remarks=True), short),
        (*always, landing(remarks=False), short),
    ]
    if None not in shares:
        forms.insert(0, (*forms[0], column("p·(r + γV)", figures(shares))))
    return Table(forms)


def _went(world: World, backup: Backup, leaves: Sequence[Leaf], look: Look) -> list[str]:
    meant = int(world.space.pair_action[backup.pair])
    if all(leaf.action in (UNKNOWN_ACTION, meant) for leaf in backup.leaves):
        return []
    return [
        "?" if leaf.action == UNKNOWN_ACTION else names.action_name(world, leaf.action, look.glyphs)
        for leaf in leaves
    ]


def _reward(leaf: Leaf, look: Look, *, secret: bool) -> str:
    if secret:
        return HIDDEN
    noise = f"±{numbers.brief(leaf.noise, look.glyphs, decimals=2)}" if leaf.noise else ""
    return numbers.brief(leaf.reward, look.glyphs, decimals=4) + noise


def _landing(world: World, leaf: Leaf, look: Look, *, remarks: bool) -> str:
    name = names.state_name(world, leaf.next_state, look.glyphs)
    remark = names.landmark(world, leaf.next_state) or ("ends" if leaf.terminated else "")
    return f"{name}: {remark}" if remark and remarks else name


def _share(backup: Backup, leaf: Leaf, value: float | None) -> float | None:
    if leaf.probability is None or value is None:
        return None
    return leaf.probability * (leaf.reward + backup.gamma * value)


def _decimals_that_agree(backup: Backup, leaves: Sequence[Leaf], look: Look) -> int:
    def agree(decimals: int) -> bool:
        for leaf in leaves:
            share = _share(backup, leaf, leaf.value)
            if share is None or leaf.value is None:
                return True
            printed = parsed(column_figure(leaf.value, decimals, look.glyphs), look.glyphs)
            worked_out = _share(backup, leaf, printed)
            assert worked_out is not None
            if not agrees(worked_out, column_figure(share, decimals, look.glyphs), look.glyphs, decimals):
                return False
        return True

    known = [leaf.value for leaf in leaves if leaf.value and abs(leaf.value) >= numbers.NEGLIGIBLE]
    fewest = _DECIMALS + max(0, leading_zeros(*known) - 1)
    return fewest_decimals(fewest, fewest + _MORE, agree)


# The sampled and the expected target


_LABEL: Final = 12
_FEWEST: Final = 2
_MORE_OF_TARGETS: Final = 6


def target_blocks(words: StepWords, backup: Backup, look: Look, *, secret: Sequence[str]) -> Iterator[Block]:
    """Yield sampled target, expected target and difference. ``secret``: a text in place of the expected one,
    if hidden.
    """
    dim, planned = look.palette.dim, words.story.last.planned
    if backup.sampled is None:
        if words.estimate:
            yield Text("the target spans several steps, so one step has no expected target", dim)
        return
    decimals = _decimals(backup.sampled, backup.expected, look)
    terms = words.story.terms
    looked_up = f" + {terms.discount}·{words.bootstrap}" if words.bootstrap else ""
    symbols = f"{terms.gathered}{looked_up}"
    yield _target("target" if planned else "sampled", symbols, backup.sampled, decimals, look)
    if secret:
        yield Labelled("expected", dim, _LABEL, Row(*([Piece(each, dim)] for each in secret)))
    elif backup.expected is None:
        yield Text(_not_known(words.story), dim)
    elif planned:
        yield Text("a planner uses the expected target, without luck", dim)
    else:
        symbols = "mean reward" if words.story.world.is_bandit else "Σ p (r + γ V(s′))"
        yield _target("expected", symbols, backup.expected, decimals, look)
        difference = backup.sampled - backup.expected
        reason = _reason(words.story, backup, difference)
        yield _difference(difference, reason, decimals, look)


def _target(label: str, symbols: str, target: float, decimals: int, look: Look) -> Block:
    number = Piece(column_figure(target, decimals, look.glyphs), look.palette.strong)
    row = Row([Piece(f"{symbols} = ", look.palette.text), number], [number])
    return Labelled(label, look.palette.dim, _LABEL, row)


def _difference(difference: float, reason: str, decimals: int, look: Look) -> Block:
    palette = look.palette
    if abs(difference) < numbers.NEGLIGIBLE:
        shown, style = "0", palette.text
    else:
        shown = column_figure(difference, decimals, look.glyphs)
        shown, style = (shown, palette.bad) if difference < 0.0 else (f"+{shown}", palette.good)
    head = [Piece(f" {'difference':<{_LABEL - 1}}", palette.dim), Piece(shown, style)]
    first, *rest = reason.split(" ")
    words = (f"   {first}", *(f" {word}" for word in rest))
    return Flow([head, *([Piece(word, palette.dim)] for word in words)], _LABEL)


def _reason(story: StepStory, backup: Backup, difference: float) -> str:
    mdp = story.world.mdp
    if mdp is not None and mdp.drift_std:  # measured after the pull
        return "luck, and how far the mean drifted since"
    if story.last.terminated and story.bootstraps:
        return "it bootstraps after the end"
    if not backup.is_current:
        return "luck, and what else this step updated"
    if backup.is_certain:
        return "which action came next" if backup.lookup is Lookup.NEXT else "only one possible outcome"
    if abs(difference) < numbers.NEGLIGIBLE:
        targets = {leaf.reward + backup.gamma * (leaf.value or 0.0) for leaf in backup.leaves}
        return "all outcomes have equal value so far" if len(targets) == 1 else "just what was expected"
    return "luck of this sample and of A′" if backup.lookup is Lookup.NEXT else "luck of this sample"


def _not_known(story: StepStory) -> str:
    if story.world.prospects:
        return "no expected target: the outcome depends on the path to this state"
    if story.world.mdp is None:
        return "no expected target: the world has no transition table"
    return "no expected target: some estimates are not known"


def _decimals(sampled: float, expected: float | None, look: Look) -> int:
    known = [sampled] if expected is None else [sampled, expected]
    is_large = max(map(abs, known)) >= 1.0
    fewest = _FEWEST if is_large else _FEWEST + max(1, leading_zeros(*known))
    if expected is None or abs(sampled - expected) < numbers.NEGLIGIBLE:
        return fewest

    def agree(decimals: int) -> bool:
        texts = (column_figure(x, decimals, look.glyphs) for x in (sampled, expected, difference))
        first, second, printed = texts
        between = parsed(first, look.glyphs) - parsed(second, look.glyphs)
        is_seen = bool(round(difference, decimals))
        return is_seen and agrees(between, printed, look.glyphs, decimals, digits=0.5)

    difference = sampled - expected
    return fewest_decimals(fewest, fewest + _MORE_OF_TARGETS, agree)
