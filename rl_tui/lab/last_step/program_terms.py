"""The update of a program in the symbols of the book, as far as it is that of an algorithm of ours."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from rl_tui.agents.last_step import LastStep
from rl_tui.agents.update_terms import Lookup, UpdateTerms
from rl_tui.lab.detective.verdict import UpdateFound, UpdateTarget
from rl_tui.lab.live.program_view import ProgramView

NO_CHANGE: Final = "your program changed nothing"
NO_TABLE: Final = "no table was found, so no change is seen"
_OF_THE_BOOK: Final = {
    Lookup.BEST: UpdateTarget.BEST,
    Lookup.NEXT: UpdateTarget.NEXT_ACTION,
    Lookup.MEAN: UpdateTarget.EXPECTED,
}
_OTHERWISE: Final = {
    UpdateTarget.COLUMN: "max Q(·,a)",
    UpdateTarget.SAME_ACTION: "Q({next},a)",
    UpdateTarget.OWN_STATE: "max Q(s,·)",
    UpdateTarget.INDEX: "argmax Q({next},·)",
}


def program_terms(terms: UpdateTerms, program: ProgramView) -> UpdateTerms:
    """Return ``terms``, those of the algorithm meant, with what ``program`` puts in their place."""
    update = program.verdict.update
    gathered = "r before" if update.uses_reward_before else "own r" if update.reward == "own" else "r"
    return replace(
        terms,
        gathered=gathered if terms.gathered == "r" else terms.gathered,
        bootstrap=_OTHERWISE.get(update.target, terms.bootstrap),
        waiting=NO_TABLE if program.table is None else NO_CHANGE,
    )


def reads_by_the_book(terms: UpdateTerms, update: UpdateFound, last: LastStep) -> bool:
    """Return whether the program's target looks up what ``terms`` say, in a way that is known.

    A mean over actions is known where it is that of one ε, which the step names.
    """
    if _OF_THE_BOOK.get(terms.lookup) is not update.target:
        return False
    return terms.lookup is not Lookup.MEAN or update.epsilon == last.epsilon
