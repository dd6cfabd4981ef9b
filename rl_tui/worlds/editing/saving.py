"""The text of a scenario file after its world was edited.

Comments, order and style stay; only lines with changed content differ. The new text describes the same world
as the draft, bit for bit.
"""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Iterator, Mapping, MutableMapping, Sequence
from difflib import SequenceMatcher
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, cast

from rl_tui.common.errors import UserError
from rl_tui.worlds.editing.drafts import first_draft
from rl_tui.worlds.files.scenario import WORLD_KINDS, scenario_of
from rl_tui.worlds.files.toml_file import tables_in
from rl_tui.worlds.grid.map import lines_of

# Values and tables as TOML


_THREE: Final = ("'''", '"""')
_LINE_ENDS: Final = re.compile(r"\A(\n*).*?(\n*)\Z", re.DOTALL)


def value_text(value: Any) -> str:
    """Return a value as TOML on one line."""
    import tomlkit

    if isinstance(value, Mapping):
        inside = ", ".join(f"{key_text(key)} = {value_text(each)}" for key, each in value.items())
        return f"{{ {inside} }}" if inside else "{}"
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(map(value_text, value))}]"
    return str(tomlkit.item(value).as_string())


def key_text(key: str) -> str:
    """Return a key as TOML, with quotes if needed."""
    import tomlkit

    return tomlkit.key(key).as_string()


def map_text(lines: Sequence[str], like: str = "") -> str:
    """Return a map as a TOML string, in the quotes of `like` if possible."""
    return next(each for each in _map_texts(lines, like) if _says(each, lines))


def _says(text: str, lines: Sequence[str]) -> bool:
    try:
        return lines_of(tomllib.loads(f"map = {text}")["map"]) == list(lines)
    except tomllib.TOMLDecodeError:
        return False


def _map_texts(lines: Sequence[str], like: str) -> Iterator[str]:
    quotes = like[:3]
    if quotes in _THREE:
        inside = like[3:-3]
        ends = _LINE_ENDS.match(inside)
        assert ends is not None  # matches any text
        yield quotes + ends[1] + "\n".join(lines) + ends[2] + quotes
    elif like:
        before = tomllib.loads(f"map = {like}")["map"]
        if len(lines_of(before)) == len(lines):
            text = before.replace(before.strip("\n"), "\n".join(lines))
            yield like[0] + text + like[0]
            yield value_text(text)
    block = "\n".join(lines)
    for three in _THREE:
        yield f"{three}\n{block}\n{three}"
    yield value_text(f"{block}\n")


def section_text(kind: str, table: Mapping[str, Any]) -> str:
    """Return the table `kind` as TOML, followed by its subtables."""
    tables = {key: value for key, value in table.items() if _is_table_of_its_own(value)}
    parts = [f"[{kind}]\n"]
    for key, value in table.items():
        if key not in tables:
            text = map_text(lines_of(value)) if key == "map" else value_text(value)
            parts.append(f"{key_text(key)} = {text}\n")
    for key, value in tables.items():
        name = f"{kind}.{key_text(key)}"
        if isinstance(value, Mapping):
            parts.append(f"\n[{name}]\n{_lines_text(value)}")
        else:
            parts.extend(f"\n[[{name}]]\n{_lines_text(each)}" for each in value)
    return "".join(parts)


def _is_table_of_its_own(value: Any) -> bool:
    inside = value.values() if isinstance(value, Mapping) else value
    wanted = (Mapping, list) if isinstance(value, Mapping) else Mapping
    is_nested = isinstance(value, (Mapping, list)) and len(value) > 0
    return is_nested and all(isinstance(each, wanted) for each in inside)


def _lines_text(table: Mapping[str, Any]) -> str:
    return "".join(f"{key_text(key)} = {value_text(value)}\n" for key, value in table.items())


# The changed file


if TYPE_CHECKING:
    from tomlkit import TOMLDocument
    from tomlkit.container import OutOfOrderTableProxy
    from tomlkit.items import AoT, Item, Table

    from rl_tui.worlds.editing.arms_draft import Draft

    MutableTable = Table | OutOfOrderTableProxy

_MAP, _MEANS, _OUTCOMES = "map", "means", "to"
_TABLES: Final = ("legend", "place")
"""Keys that become subtables."""
# A drawn map replaces the keys it was generated from
_DRAWN_FROM: Final = {_MAP: ("random",), _MEANS: ("arms", "mean")}
_COMMENTS: Final = re.compile(r"[ \t]*#.*", re.DOTALL)


def saved_text(text: str, draft: Draft) -> str:
    """Replace the world in the text of a scenario file by `draft`.

    Raises:
        UnfinishedError: The draft is not a valid MDP.
        UserError: No text describes the same world, bit for bit.
    """
    assert draft.section is not None
    wanted = _filled(draft.table)
    line_end = "\r\n" if text.count("\r\n") == text.count("\n") > 0 else "\n"
    for change in (_changed, _rewritten):
        new = change(text.replace(line_end, "\n"), draft.kind, wanted).replace("\n", line_end)
        if _is_faithful(new, draft.kind, wanted):
            return new
    raise UserError("this world cannot be written into its file: save it under another name")


def _is_faithful(text: str, kind: str, wanted: Mapping[str, Any]) -> bool:
    try:
        scenario = scenario_of(text, Path("drawn.toml"))
        return scenario.kind == kind and _same(first_draft(scenario, 0).table, wanted)
    except UserError:
        return False


def _same(one: object, other: object, key: str = "") -> bool:
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        if key == _OUTCOMES and list(one) != list(other):
            return False  # the order of mention numbers the states
        first, second = _filled(one), _filled(other)
        return first.keys() == second.keys() and all(
            _same(value, second[name], name) for name, value in first.items()
        )
    if isinstance(one, list) and isinstance(other, list):
        return len(one) == len(other) and all(_same(*pair) for pair in zip(one, other, strict=True))
    if key == _MAP and isinstance(one, str) and isinstance(other, str):
        return lines_of(one) == lines_of(other)
    if isinstance(one, bool) or isinstance(other, bool):
        return one is other
    if isinstance(one, (int, float)) and isinstance(other, (int, float)):
        return one == other and math.copysign(1, one) == math.copysign(1, other)
    return one == other


def _filled(table: Mapping[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in table.items() if value != {}}


def _changed(text: str, kind: str, wanted: Mapping[str, Any]) -> str:
    # As little as possible changes
    import tomlkit
    from tomlkit.container import OutOfOrderTableProxy
    from tomlkit.items import InlineTable, Table

    old = tables_in(text).get(kind)
    if not isinstance(old, dict):
        return _rewritten(text, kind, wanted)
    if _same(old, wanted):
        return text
    ended = text if text.endswith("\n") else f"{text}\n"
    document = tomlkit.parse(ended)
    table = document[kind]
    if isinstance(table, InlineTable) and list(old) == list(wanted):
        _change_value(document, kind, old, wanted)
        return _ended_as(text, tomlkit.dumps(document))
    missing = {key: value for key, value in wanted.items() if key not in old}
    drawn = next((key for key in missing if key in _DRAWN_FROM), None)
    if not isinstance(table, Table) and (drawn is not None or not isinstance(table, OutOfOrderTableProxy)):
        return _rewritten(text, kind, wanted)
    _change_values(table, old, {key: value for key, value in wanted.items() if key in old}, kept=drawn)
    for key, value in missing.items():
        if key != drawn:
            _add(document, kind, key, value)
    if drawn is not None and isinstance(table, Table):
        _put_in_place(table, drawn, wanted[drawn])
    return _ended_as(text, tomlkit.dumps(document))


def _change_values(
    table: MutableTable, old: Mapping[str, Any], wanted: Mapping[str, Any], kept: str | None = None
) -> None:
    # Keys that the new key `kept` replaces stay for now
    for key in [each for each in old if each not in wanted]:
        if key not in _DRAWN_FROM.get(kept or "", ()):
            del table[key]
    for key, value in wanted.items():
        if key not in old:
            table[key] = _item(value)
        elif not _same(old[key], value, key):
            _change_value(table, key, old[key], value)


def _change_value(table: MutableMapping[str, Any], key: str, old: Any, new: Any) -> None:
    import tomlkit
    from tomlkit.container import OutOfOrderTableProxy
    from tomlkit.items import AoT, Array, InlineTable, Table

    item = table[key]
    if key == _MAP and isinstance(new, str):
        table[key] = tomlkit.value(map_text(lines_of(new), item.as_string()))
    elif isinstance(item, AoT):
        _change_entries(item, old, new)
    elif isinstance(item, InlineTable) and isinstance(new, dict):
        if list(old) != list(new):
            table[key] = _item(new)
        else:
            for name in (name for name in new if not _same(old[name], new[name], name)):
                _change_value(item, name, old[name], new[name])
    elif isinstance(item, (Table, OutOfOrderTableProxy)) and isinstance(new, dict):
        _change_values(item, old, new)
    elif isinstance(item, Array) and isinstance(new, list) and len(old) == len(new):
        for index in (index for index, value in enumerate(new) if not _same(old[index], value)):
            item[index] = _item(new[index], old[index])
    else:
        table[key] = _item(new, old)


def _change_entries(entries: AoT, old: Sequence[Any], new: Sequence[Any]) -> None:
    # Tables are identified by state and action
    before, after = ([(each.get("state"), each.get("action")) for each in listed] for listed in (old, new))
    moved = 0
    for what, first, last, new_first, new_last in SequenceMatcher(
        None, before, after, autojunk=False
    ).get_opcodes():
        if what == "equal":
            for index in range(last - first):
                _change_values(entries[first + moved + index], old[first + index], new[new_first + index])
            continue
        for _ in range(last - first):
            _remove_entry(entries, first + moved)
        for index in range(new_last - new_first):
            _insert_entry(entries, first + moved + index, new[new_first + index])
        moved += (new_last - new_first) - (last - first)


def _remove_entry(entries: AoT, index: int) -> None:
    # The comments behind it describe what follows, so they stay
    import tomlkit

    entry = entries[index]
    behind = ""
    for key, item in entry.value.body:
        behind = "" if key is not None else behind + item.as_string()
    found = _COMMENTS.search(entry.trivia.indent + behind)
    comments = found[0] if found else ""
    del entries[index]
    if comments and index < len(entries):
        entries[index].trivia.indent = comments + entries[index].trivia.indent
    elif comments and index:
        for _, item in tomlkit.parse(comments).body:
            entries[index - 1].add(item)  # type: ignore[call-overload]


def _insert_entry(entries: AoT, index: int, entry: Mapping[str, Any]) -> None:
    import tomlkit

    table = tomlkit.table()
    for key, value in entry.items():
        table.append(key, _item(value))
    (table if index < len(entries) else entries[index - 1] if index else table).add(tomlkit.nl())
    entries.insert(index, table)


def _add(document: TOMLDocument, kind: str, key: str, value: Any) -> None:
    # In the style of the shipped files
    import tomlkit

    table = cast("MutableTable", document[kind])
    if key not in _TABLES:
        table[key] = _item(value)
        return
    new = tomlkit.table()
    for name, each in value.items():
        new.append(name, _item(each))
    if list(document)[-1] != kind:
        new.add(tomlkit.nl())
    table[key] = new


def _put_in_place(table: Table, key: str, value: Any) -> None:
    # It takes the place of the first key that it replaces
    import tomlkit

    body = table.value.body
    sources = [index for index, (name, _) in enumerate(body) if name and name.key in _DRAWN_FROM[key]]
    new = tomlkit.value(map_text(lines_of(value)) if key == _MAP else value_text(value))
    first, *others = sources
    _copy_surroundings(body[first][1], new)
    body[first] = (tomlkit.key(key), new)
    for index in reversed(others):
        del body[index]


def _rewritten(text: str, kind: str, wanted: Mapping[str, Any]) -> str:
    import tomlkit
    from tomlkit.items import Whitespace

    document = tomlkit.parse(text if not text or text.endswith("\n") else f"{text}\n")
    new = tomlkit.parse(section_text(kind, wanted))[kind]
    body = document.body
    places = [index for index, (key, _) in enumerate(body) if key is not None and key.key in WORLD_KINDS]
    if not places:
        gap = "" if not text or text.endswith("\n\n") else "\n"
        return f"{tomlkit.dumps(document)}{gap}{section_text(kind, wanted)}"
    if places[-1] < len(body) - 1:
        new.add(Whitespace("\n"))
    body[places[0]] = (tomlkit.key(kind), new)
    for index in reversed(places[1:]):
        del body[index]
    return _ended_as(text, tomlkit.dumps(document))


def _item(value: Any, old: Any = None) -> Item:
    # With a decimal point if the old number had one
    import tomlkit

    if isinstance(old, float) and type(value) is int and float(value) == value:
        value = float(value)
    return tomlkit.value(value_text(value))


def _copy_surroundings(old: Item, new: Item) -> None:
    for name in ("indent", "comment_ws", "comment", "trail"):
        setattr(new.trivia, name, getattr(old.trivia, name))


def _ended_as(text: str, new: str) -> str:
    body = text.rstrip("\r\n")
    return new.rstrip("\r\n") + (text[len(body) :] if body else "\n")
