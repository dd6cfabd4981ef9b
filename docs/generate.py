"""Writes what the documentation takes from the program: ``make docs``.

A page holds ``<!-- made by make docs: NAME -->`` and ``<!-- end -->``. Between them goes the Markdown that
the function NAME returns. The pictures are drawn by the program too. A test compares both.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from contextlib import redirect_stdout
from inspect import cleandoc
from io import BytesIO, TextIOWrapper
from pathlib import Path
from tempfile import TemporaryDirectory
from textwrap import fill
from typing import NamedTuple

import click
from python_reference import python_api

from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID, Algorithm, Policy
from rl_tui.agents.hyperparameters import PARAMETERS, Hyperparameters, Parameter
from rl_tui.commands.main import program
from rl_tui.commands.options.display import DISPLAY_OPTIONS
from rl_tui.commands.options.run import OPTIONS, SOME, TITLES, section_of
from rl_tui.lessons.catalogue import shipped_lessons
from rl_tui.lessons.figures.figures import FUNCTIONS
from rl_tui.lessons.judging.measures import MEASURES as LESSON_MEASURES
from rl_tui.lessons.judging.measures import MeasureKind
from rl_tui.runs.library import listing
from rl_tui.runs.measures import MEASURES
from rl_tui.screen.glossary.glossary import glossary as terms
from rl_tui.screen.keys.action import Action, Place
from rl_tui.screen.keys.registry import ACTIONS
from rl_tui.screen.playground.modes.drawing import POLICY_ACTIONS
from rl_tui.screen.playground.modes.editing import ALWAYS, TOOLBOXES
from rl_tui.studies.sweeps.cell import MEASURES as SWEEP_MEASURES
from rl_tui.studies.sweeps.schema import SCHEMA
from rl_tui.worlds.drawing import Arms, Graph, Grid
from rl_tui.worlds.files.catalogue import scenarios as read_scenarios
from rl_tui.worlds.files.catalogue import shipped_folder

FOLDER = Path(__file__).parent
SETTING_HEADS = ("option", "symbol", "values", "default", "meaning")
BLOCK = re.compile(r"(<!-- made by make docs: (\w+) -->\n).*?(<!-- end -->)", re.DOTALL)
LISTS = {Place.CATALOGUE: "Start screen", Place.LESSONS: "List of lessons"}
PLACES = {Place.LESSONS | Place.PLAYGROUND: "(list of lessons too)", Place.EVERY: "(everywhere)"}
ALGORITHMS = f"one of {', '.join(BY_ID)}"
SWEEPS_ONLY = ("area", "arrival")
_LAKE = "frozenlake-slippery"
_LESSON_KEYS = "pagedown,pagedown,pagedown,pagedown,y,1,pagedown,enter,-,2,enter,1"
PICTURES = {
    "playground.svg": ("screenshot", _LAKE, "--keys", "wait:20000"),
    "microscope.svg": ("screenshot", _LAKE, "--keys", "wait:60000,d"),
    "lesson.svg": ("screenshot", "--lesson", "q-by-hand", "--keys", _LESSON_KEYS),
    "drawing.svg": ("screenshot", "maze", "--keys", "wait:3000,w,d,right,right,H,s,down,number_sign"),
    "figure-8.2.svg": ("figure", "8.2"),
    "own-code.svg": ("screenshot", "--watch", str(FOLDER / "lake.py"), "--keys", "wait:12000,a,f"),
    "recordings/watch-it-learn.cast": ("record", "--size", "80x24", "--keys", "3s,2,17s,space,2s"),
    "recordings/watch-a-script.cast": (
        *("record", "--watch", str(FOLDER / "lake.py"), "--size", "100x30"),
        *("--keys", "1s,s,1s,s,1s,space,4s,+,1s,+,1s,+,1s,+,3s,space,1s,a,f,4s"),
    ),
    "recordings/draw-a-wall.cast": (
        *("record", "maze", "--size", "80x24"),
        *("--keys", "0s,wait:3000,1s,+,0s,space,2s,w,d,1s,right,right,#,1s,down,#,1s,esc,+,8s"),
    ),
}


class Option(NamedTuple):
    """An option by its name, as it is typed, and its meaning."""

    name: str
    written: str
    meaning: str


def main() -> None:
    """Write what the program would now write otherwise, and print its path; pictures and recordings are for
    looking at.
    """
    for name in PICTURES:
        if _write(FOLDER / name, drawn(name)):
            print(f"{FOLDER / name}: the picture changed; look at it before you keep it")
    for path in sorted(FOLDER.rglob("*.md")):
        if _write(path, renewed(path.read_text(encoding="utf-8"))):
            print(path)


def _write(path: Path, text: str) -> bool:
    """Write ``text`` unless the file has it already; return whether it was written."""
    if path.exists() and path.read_text(encoding="utf-8") == text:
        return False
    path.parent.mkdir(exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return True


def renewed(text: str) -> str:
    """Return ``text`` with every block as the program is now."""
    return BLOCK.sub(lambda block: f"{block[1]}\n{BLOCKS[block[2]]()}\n\n{block[3]}", text)


def drawn(picture: str) -> str:
    """Return that one of ``PICTURES`` as SVG, or as a recording."""
    return picture_of(*PICTURES[picture], name=Path(picture).name)


def picture_of(*command: str, name: str = "picture.svg") -> str:
    """Return the SVG or recording that a command of rl-tui writes to the file `name`."""
    with TemporaryDirectory() as folder:
        path = Path(folder, name)
        printed(*command, "--out", str(path))
        return path.read_text(encoding="utf-8")


def printed(*command: str) -> str:
    """Return what a command of rl-tui prints."""
    text = BytesIO()
    stdout = TextIOWrapper(text, encoding="utf-8")  # arrows need an encoding that has them
    with redirect_stdout(stdout) as output:
        program([*command], standalone_mode=False)
        output.flush()
        return text.getvalue().decode()


def keys() -> str:
    """Return the keys in one table, each menu and each group of other keys below its name."""
    rows: list[tuple[str, ...]] = []
    for group in dict.fromkeys(_group(action) for action in ACTIONS):
        rows += [(f"**{group}**", "", ""), *(_key_row(each) for each in ACTIONS if _group(each) == group)]
    return table(("key", "name", "what it does"), rows)


def cheat_sheet() -> str:
    """Return every key with its name only, short enough for one sheet of paper."""
    parts = []
    for group in dict.fromkeys(_group(action) for action in ACTIONS):
        named = [f"* `{each.shown}` {each.label}" for each in ACTIONS if _group(each) == group]
        parts.append("\n".join([f"**{group}**", "", *named]))
    return "\n\n".join(parts)


def drawing_keys() -> str:
    """Return what draws a policy, and each kind of world, with its keys."""
    kinds = {"A map": Grid, "A graph": Graph, "A bandit": Arms}
    tools = {"A policy": POLICY_ACTIONS, **{title: TOOLBOXES[kind].tools for title, kind in kinds.items()}}
    rows = []
    for title, each in {**tools, "Every world": ALWAYS}.items():
        rows += [
            (f"**{title}**", "", ""),
            *((f"`{tool.shown}`", tool.label, tool.help) for tool in each),
        ]
    return table(("key", "name", "what it does"), rows)


def _group(action: Action) -> str:
    return LISTS.get(action.place, action.heading)


def _key_row(action: Action) -> tuple[str, ...]:
    signs = PLACES.get(action.place, "") + "†" * action.for_the_owner
    return f"`{action.shown}`", action.label, f"{action.help} {signs}".strip()


def scenarios() -> str:
    """Return the shipped scenarios in the order of the catalogue, with the sizes of their worlds."""
    rows = []
    for scenario in read_scenarios():
        if scenario.source.parent == shipped_folder():
            world = listing(scenario)
            limit = str(world["time_limit"] or "none")
            sizes = str(world["states"]), str(world["actions"]), limit
            rows.append((f"`{scenario.id}`", scenario.title, *sizes, scenario.summary))
    return table(("id", "title", "states", "actions", "limit", "what it is"), rows)


def lessons() -> str:
    """Return the shipped lessons in their order."""
    rows = [
        (
            f"`{each.id}`",
            each.title,
            "✓" * each.is_core,
            str(each.minutes),
            str(len(each.tasks)),
            each.summary,
        )
        for each in shipped_lessons()
    ]
    return table(("id", "title", "core", "minutes", "tasks", "what it is about"), rows)


def measures() -> str:
    """Return what can be measured of a run, a table for each kind; settings are named by their options."""
    parts = []
    for kind in MeasureKind:
        parts.append(f"**{capital(kind)}**")
        if kind is MeasureKind.SETTING:
            parts.append(
                "`algorithm`, and every setting by its name in JSON: [settings](agents.md#settings)."
            )
            continue
        rows = [
            (f"`{each.name}`", ", ".join(f"`{key}`" for key in each.needs), each.help.replace("|", "\\|"))
            for each in LESSON_MEASURES.values()
            if each.kind is kind
        ]
        if any(needs for _, needs, _ in rows):
            parts.append(table(("measure", "keys", "meaning"), rows))
        else:
            parts.append(table(("measure", "meaning"), [(name, meaning) for name, _, meaning in rows]))
    return "\n\n".join(parts)


def figure_functions() -> str:
    """Return the functions by which figures are worked out."""
    rows = [(f"`{name}{each.signature}`", each.meaning) for name, each in FUNCTIONS.items()]
    lines = (_wrapped(f"* {call}: {meaning}", indent="  ") for call, meaning in rows)
    return "\n".join(lines).replace("``", "`")


def algorithms() -> str:
    """Return what each algorithm is, how it updates and which settings it alone or with few others has."""
    return "\n\n".join(
        _described(algorithm, [name for name in algorithm.parameters if section_of(name) == SOME])
        for algorithm in BY_ID.values()
    )


def policies() -> str:
    """Return what each policy is, how it chooses and its settings."""
    return "\n\n".join(
        _described(policy, [name for name in policy.parameters if not PARAMETERS[name].schedule])
        for policy in POLICY_BY_ID.values()
    )


def _described(each: Algorithm | Policy, settings: Iterable[str]) -> str:
    facts = [f"`{each.id}`", each.source, *(f"`{option_name(name)}`" for name in settings)]
    if isinstance(each, Policy) and each.bandits_only:
        facts.append("for bandits only")
    return f"### {each.name}\n\n{sentence(each.summary)}\n\n    {each.equation}\n\n{' · '.join(facts)}"


def glossary() -> str:
    """Return every word with its meaning and, if it is from a book or paper, its equation and source."""
    parts = []
    for term in terms().values():
        parts += [f"### {term.word}", _wrapped(term.text)]
        source = _source(term.book)
        if source:
            parts += [f"    {term.equation}", source]
    return "\n\n".join(parts)


def _source(book: str) -> str:
    """Return the sections and equations of a word, or its paper; nothing if neither has it."""
    if book.startswith(("a word of ", "not ")):
        paper = re.search(r"\((.*, \d{4})\)", book)
        return paper[1] if paper else ""
    place, _, _ = book.partition(" (")
    place = re.sub(r"sections? (?=\d)", "§", place)
    return capital(re.sub(r"equations? ([\d.]+\d(?: and [\d.]+\d)?)", r"(\1)", place))


def settings() -> str:
    """Return every hyperparameter with what it may be, in the sections of the help of a command."""
    parts = []
    for title in TITLES:
        rows = [setting_row(each) for each in PARAMETERS.values() if section_of(each.name) == title]
        if rows:
            parts += [f"### {title}", table(SETTING_HEADS, rows)]
    return "\n\n".join(parts)


def setting_row(parameter: Parameter) -> tuple[str, ...]:
    """Return the row of a hyperparameter, as ``SETTING_HEADS`` names its cells."""
    symbol = "" if parameter.symbol == parameter.name else parameter.symbol
    default = f"{Hyperparameters().value(parameter.name)}"
    values = parameter.expected.replace(" or ", ", ")
    return f"`{option_name(parameter.name)}`", symbol, values, default, parameter.help


def commands() -> str:
    """Return every command with its own options, and those of several commands once."""
    root = click.Context(program, info_name="rl-tui")
    contexts = [root]
    for name in program.list_commands(root):
        command = program.get_command(root, name)
        if command is not None:
            contexts.append(click.Context(command, info_name=name, parent=root))
    count = Counter(record for context in contexts for record in _records(context))
    common = {record for record in count if count[record] > 1}
    parts = [_command(context, common) for context in contexts]
    for title, is_display in (("Options of several commands", False), ("Display options", True)):
        those = (each for each in count if each in common)
        items = [_item(each) for each in those if (each.name in DISPLAY_OPTIONS) is is_display]
        parts += [f"### {title}", "\n".join(items)]
    return "\n\n".join(parts)


def _command(context: click.Context, common: set[Option]) -> str:
    pieces = [each for each in context.command.collect_usage_pieces(context) if each != "[OPTIONS]"]
    usage = " ".join([context.command_path, *pieces])
    paragraphs = cleandoc(context.command.help or "").split("\n\n")
    records = list(_records(context))
    own = [_item(record) for record in records if record not in common]
    shared = [record for record in records if record in common]
    also = [f"`{each.written.split()[0]}`" for each in shared if each.name not in DISPLAY_OPTIONS]
    if any(each.name in DISPLAY_OPTIONS for each in shared):
        also.append("[display](#display-options)")
    if "algorithm" in (option.name for option in context.command.params):
        also.append("[settings](agents.md#settings)")
    parts = [f"### `{usage}`"]
    for paragraph in paragraphs:
        is_example = paragraph.startswith("rl-tui ")
        parts.append(f"    {paragraph}" if is_example else _wrapped(paragraph))
    if own:
        parts.append("\n".join(own))
    if also:
        parts.append(_wrapped(f"Also: {', '.join(also)}."))
    return "\n\n".join(parts)


def _records(context: click.Context) -> Iterator[Option]:
    """Yield the options of a command, except the settings of a run and the help."""
    options = [each for each in context.command.params if isinstance(each, click.Option)]
    takes_a_run = any(option.name == "algorithm" for option in options)
    for option in options:
        record = option.get_help_record(context)
        if record is not None and not (takes_a_run and section_of(option.name or "") != OPTIONS):
            yield Option(option.name or "", *record)


def _item(option: Option) -> str:
    meaning = option.meaning.replace(ALGORITHMS, "[an algorithm](agents.md#algorithms)")
    return _wrapped(f"* `{option.written}`: {meaning}", indent="  ")


def _wrapped(text: str, indent: str = "") -> str:
    return fill(" ".join(text.split()), 110, subsequent_indent=indent, break_on_hyphens=False)


def run_measures() -> str:
    """Return the measures of a run that ``train --json`` prints."""
    return _measures(each for each in MEASURES if each not in SWEEPS_ONLY)


def sweep_measures() -> str:
    """Return the measures of a sweep: in full those that a run does not have."""
    shared = ", ".join(f"`{each}`" for each in SWEEP_MEASURES if each not in SWEEPS_ONLY)
    others = _wrapped(f"The other metrics are those of [a run](commands.md#train): {shared}.")
    return f"{_measures(SWEEPS_ONLY)}\n\n{others}"


def _measures(names: Iterable[str]) -> str:
    """Return a table of the measures of these ``names``, with their formulas."""
    better = {True: "more", False: "less", None: ""}
    rows = [
        (f"`{each.id}`", each.unit, better[each.larger_is_better], each.formula.replace("|", "\\|"))
        for each in (MEASURES[name] for name in names)
    ]
    return table(("id", "in", "better is", "what it is"), rows)


def sweep_schema() -> str:
    """Return the tables of a store, as they stand in it."""
    return f"```sql\n{SCHEMA.strip()}\n```"


def option_name(name: str) -> str:
    """Return the option of a hyperparameter, as it is typed."""
    return f"--{name.replace('_', '-')}"


def sentence(text: str) -> str:
    """Return ``text`` with a capital letter and a full stop."""
    return f"{capital(text)}."


def capital(text: str) -> str:
    """Return ``text`` with a capital letter."""
    return f"{text[0].upper()}{text[1:]}"


def table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a Markdown table whose columns, but for the last, are as wide as their widest cell."""
    widths = [max(map(len, column)) for column in zip(heads, *rows, strict=True)][:-1]
    ruler = [*("-" * width for width in widths), "---"]
    return "\n".join(
        f"| {' | '.join([*(cell.ljust(width) for cell, width in zip(row, widths, strict=False)), row[-1]])} |"
        for row in (heads, ruler, *rows)
    )


BLOCKS = {
    made.__name__: made
    for made in (
        *(keys, cheat_sheet, drawing_keys, glossary, scenarios, lessons, measures, figure_functions),
        *(algorithms, policies, settings, commands, run_measures, sweep_measures, sweep_schema, python_api),
    )
}

if __name__ == "__main__":
    main()
