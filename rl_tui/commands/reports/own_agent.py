"""What is said of a program that somebody wrote, for people."""

from __future__ import annotations

from rl_tui.commands.line.output import number
from rl_tui.common.findings import printable
from rl_tui.programs.evidence.verdict import ProgramVerdict, Rule


def update_in_words(verdict: ProgramVerdict) -> str:
    """Return which update was found, and what is wrong with it, a line each."""
    update = verdict.update
    known = [
        f"{symbol} {number(value, '.6g')}"
        for symbol, value in (("α", update.alpha), ("γ", update.gamma))
        if value is not None
    ]
    is_known = update.rule != Rule.UNKNOWN
    what = f"its update is {update.rule.value}" if is_known else "which update it makes is not known"
    settings = f"{' with' if is_known else ';'} {', '.join(known)}" if known else ""
    faults = (f"{each.kind}: {each.fault.value}: {each.text}" for each in verdict.findings)
    return "\n".join((f"{what}{settings}", *map(printable, faults)))
