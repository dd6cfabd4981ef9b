"""Texts about a watched program."""

from __future__ import annotations

import os.path
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from rl_tui.common.findings import one_line
from rl_tui.live.program_view import ProgramView
from rl_tui.programs.evidence.verdict import (
    CodeFault,
    CodeFinding,
    ExplorationFound,
    MovedCell,
    Rule,
    UpdateFound,
    UpdateTarget,
    step_number,
)
from rl_tui.programs.watched.program_log import FoundTable
from rl_tui.screen.draw import numbers
from rl_tui.screen.theme.glyphs import Glyphs

LONGEST_NAME: Final = 40
LONGEST_SENTENCE: Final = 600
IN_SHORT: Final = {
    CodeFault.BOOTSTRAPS_AFTER_END: "bootstraps after the end",
    CodeFault.NO_BOOTSTRAP_AFTER_TRUNCATION: "no bootstrap at the time limit",
    CodeFault.WRONG_AXIS: "maximum along the wrong axis",
    CodeFault.UPDATES_AFTER_MOVING: "updates the state it moved to",
    CodeFault.SHIFTED_REWARD: "uses the previous reward",
    CodeFault.ROUNDING_TABLE: "the table holds integers",
    CodeFault.SHARED_TABLE: "rows share one object",
    CodeFault.GAMMA_TWICE: "discounts twice",
    CodeFault.WRONG_FORMULA: "a wrong sign or factor",
    CodeFault.STEP_SIZE_OUT_OF_RANGE: "step size out of range",
    CodeFault.WRONG_CELL: "updates another cell",
    CodeFault.LOSES_UPDATE: "loses its updates",
    CodeFault.STEPS_AFTER_END: "continues after the end",
    CodeFault.WRONG_TABLE: "reads one of two tables only",
    CodeFault.FIRST_OF_TIES: "takes the first of ties",
    CodeFault.NEVER_EXPLORES: "never explores",
}

_RULES: Final = {
    Rule.Q_LEARNING: "Q-learning",
    Rule.SARSA: "SARSA",
    Rule.EXPECTED_SARSA: "Expected SARSA",
    Rule.DOUBLE_Q: "Double Q-learning",
    Rule.MONTE_CARLO: "Monte Carlo",
}
_BOOTSTRAPS: Final = {
    UpdateTarget.BEST: "max Q(s′,·)",
    UpdateTarget.NEXT_ACTION: "Q(s′,a′)",
    UpdateTarget.EXPECTED: "Σ π Q(s′,·)",
    UpdateTarget.COLUMN: "max Q(·,a)",
    UpdateTarget.SAME_ACTION: "Q(s′,a)",
    UpdateTarget.OWN_STATE: "max Q(s,·)",
    UpdateTarget.INDEX: "argmax Q(s′,·)",
    UpdateTarget.ALLOWED: "max Q(s′, allowed)",
    UpdateTarget.DRAWN: "Q(s′,b)",
    UpdateTarget.BEST_BY_OTHER: "Q₂(s′,argmax Q₁(s′,·))",
    UpdateTarget.OTHER_BEST: "max Q₂(s′,·)",
    UpdateTarget.OTHERS_CHOICE: "Q₁(s′,argmax Q₂(s′,·))",
    UpdateTarget.NOTHING: "",
}
_CELLS: Final = {MovedCell.TAKEN: "Q(s,a)", MovedCell.MOVED: "Q(s′,a)", MovedCell.ONE_LATE: "Q(s,a)"}
_FORMS: Final = {
    "array": "array",
    "dict-of-arrays": "dict of arrays",
    "dict-of-pairs": "dict of (state, action)",
    "lists": "list of lists",
}


def name_of(program: ProgramView) -> str:
    """Return the program's short, printable name."""
    return one_line(program.title or Path(program.path).name, LONGEST_NAME)


def table_texts(table: FoundTable) -> tuple[str, ...]:
    """Return forms of ``table q: array 16×4, float64``. A dictionary grows, so it has no shape."""
    name = one_line(", ".join(filter(None, (table.name, table.other))), LONGEST_NAME)
    form = form_text(table.form)
    grows = table.form.startswith("dict")
    shape = "" if grows else " " + "×".join(map(str, table.shape[:4]))
    dtype = f", {one_line(table.dtype, LONGEST_NAME)}" if table.dtype else ""
    return f"table {name}: {form}{shape}{dtype}", f"table {name}: {form}{shape}", f"table {name}{shape}"


def form_text(form: str) -> str:
    """Write the ``form``: ``list of lists``."""
    return _FORMS.get(form, one_line(form, LONGEST_NAME))


def update_texts(update: UpdateFound, glyphs: Glyphs) -> tuple[str, ...]:
    """Return the update, with letters for unknown α or γ."""
    if update.rule is Rule.UNKNOWN:
        return ()
    alpha = "1/N" if update.alpha_schedule == "1/N" else "α"
    alpha = alpha if update.alpha is None else number_text(update.alpha, glyphs)
    alpha = f"({alpha})" if alpha.startswith(glyphs.minus) else alpha
    cell, rule, bootstrap = _CELLS[update.place], _RULES[update.rule], _BOOTSTRAPS[update.target]
    if update.rule is Rule.DOUBLE_Q:  # Q₁ is the table that changes
        cell, bootstrap = cell.replace("Q(", "Q₁("), bootstrap.replace("Q(", "Q₁(")
    if update.rule is Rule.MONTE_CARLO:
        gain = "G"
    else:
        reward = "previous r" if update.uses_reward_before else "own r" if update.reward == "own" else "r"
        gamma = "γ" if update.gamma is None else number_text(update.gamma, glyphs)
        gain = f"{reward} + {gamma}·{bootstrap}" if bootstrap else reward
    step = f"{alpha}·({gain} − {cell})"
    equation = f"{cell} ← {cell} + {step}"
    return f"{rule}:  {equation}", equation, f"{cell} += {step}", rule


def clause(sentence: str) -> str:
    """Turn ``sentence`` into a clause."""
    text = one_line(sentence, LONGEST_SENTENCE).removesuffix(".")
    is_word = text[:1].isupper() and (text[1:2].islower() or text[1:2] == " ")
    return text[:1].lower() + text[1:] if is_word else text


def in_brief(reason: str) -> str:
    """Drop the details after the last colon, if any."""
    brief, _, details = reason.rpartition(": ")
    return brief or details


def sentence(text: str) -> str:
    """Add a full stop. The first letter may belong to a name."""
    line = one_line(text, LONGEST_SENTENCE)
    return line if line.endswith((".", "…")) else f"{line}."


def notes_of(program: ProgramView) -> list[str]:
    """Describe each unknown fact and workaround."""
    update = program.verdict.update
    notes, known = [*program.verdict.notes, *program.notes], update.reason.removesuffix(".")
    return [
        one_line(note, LONGEST_SENTENCE)
        for note in dict.fromkeys(notes)
        if not known or not note.startswith(known)
    ]


def fitting_numbers(update: UpdateFound, glyphs: Glyphs) -> str:
    """Write known α and γ: ``α .1, γ .99``."""
    known = (("α", update.alpha), ("γ", update.gamma))
    return ", ".join(f"{sign} {number_text(x, glyphs)}" for sign, x in known if x is not None)


def is_early(update: UpdateFound) -> bool:
    """Return whether an update cannot be judged yet."""
    reason = update.reason.removesuffix(".")
    is_open = update.rule is Rule.UNKNOWN and update.alpha is None and update.gamma is None
    return is_open and (not reason or reason.endswith(" yet"))


def open_text(update: UpdateFound, glyphs: Glyphs) -> str:
    """Name what the equation omits."""
    parts = []
    if update.alpha is None and update.alpha_schedule == "by-episode":
        parts.append("α varies by episode")
    elif update.alpha is None and update.alpha_schedule is None:
        parts.append("α open")
    if update.gamma is None and update.rule is not Rule.MONTE_CARLO:
        parts.append("γ open")
    if update.epsilon is not None:
        parts.append(f"ε {number_text(update.epsilon, glyphs)}")
    return " · ".join(parts)


def exploration_texts(exploration: ExplorationFound | None, glyphs: Glyphs) -> tuple[str, ...]:
    """Return ε as used beside ε as written, none without both."""
    if exploration is None or exploration.written is None:
        return ()
    used, low, high = (
        numbers.brief(x, glyphs, decimals=2) for x in (exploration.epsilon, exploration.low, exploration.high)
    )
    name, code = one_line(exploration.name, LONGEST_NAME), number_text(exploration.written, glyphs)
    ends = f"({low} to {high})"
    whole = (
        f"ε used {used} {ends} in the last {exploration.choices:,} choices · {name} in your code is {code}"
    )
    return whole, f"ε used {used} {ends} · {name} {code}", f"ε used {used} · {name} {code}"


def number_text(x: float, glyphs: Glyphs) -> str:
    """Write up to four decimals."""
    if abs(x) >= 1e-3 or not x:
        return numbers.brief(x, glyphs, decimals=4)
    return numbers.scientific(x, 2, glyphs)


def fit_texts(update: UpdateFound) -> tuple[str, ...]:
    """Describe how well the update fits."""
    if update.fits is None:
        return ()
    fits = f"fits {share_text(update.fits)} of steps"
    ruled = f"{_RULES[update.rule]} {fits}" if update.rule in _RULES else fits
    telling = f"{update.informative:,} {'reveals' if update.informative == 1 else 'reveal'} γ"
    departs = [] if update.departs_at is None else [f"departs at step {step_number(update.departs_at):,}"]
    forms = ([ruled, telling, *departs], [ruled, *departs], [fits, *departs], [fits])
    return tuple(" · ".join(form) for form in forms)


def share_text(share: float) -> str:
    """Write percent, 100 only if complete."""
    if share >= 1.0:
        return "100 %"
    return f"{min(99.99, share * 100):.2f}".rstrip("0").rstrip(".") + " %"


def ranked(findings: Sequence[CodeFinding]) -> list[CodeFinding]:
    """Sort ``findings``, worst first."""
    return sorted(findings, key=lambda each: (each.kind == "risk", each.certainty == "declared", each.step))


def counted(findings: Sequence[CodeFinding]) -> str:
    """Write the counts: ``1 bug, 2 risks``."""
    faults = sum(each.kind == "fault" for each in findings)
    counts = ((faults, "bug"), (len(findings) - faults, "risk"))
    return ", ".join(f"{count} {noun}{'' if count == 1 else 's'}" for count, noun in counts if count)


def is_own(file: str, program: ProgramView) -> bool:
    """Return whether ``file`` belongs to ``program``."""
    given = [part for part in Path(os.path.normpath(program.path)).parts if part != ".."]
    return not file or list(Path(file).parts[-len(given) :]) == given


def place_text(file: str, line: int | None, program: ProgramView) -> str:
    """Return ``line 12``, or ``cell 5, line 3``, with a foreign file's name."""
    if line is not None and program.notebook is not None and is_own(file, program):
        return program.notebook.place_in_words(line)
    name = "" if is_own(file, program) else f"{one_line(Path(file).name, LONGEST_NAME)}, "
    return f"{name}line {line:,}" if line is not None else name.removesuffix(", ")


def code_around(file: str, line: int | None, program: ProgramView) -> tuple[Sequence[str], int]:
    """Return the lines of the file or notebook cell, and where ``line`` is there.

    Only the program's own source is known: elsewhere there are no lines.
    """
    if line is None or not is_own(file, program):
        return (), 0
    if program.notebook is None:
        return program.source, line
    cell, within = program.notebook.place(line)
    return cell.code, within
