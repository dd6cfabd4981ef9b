"""Ways to break a file."""

# ruff: noqa: E501

from __future__ import annotations

import copy
import datetime
import json
import math
import random
import sys
from collections.abc import Callable
from typing import Any

Chance = random.Random

INSERTED = (
    b"\x00", b"\x1b[2J", b"\x07", b"\xff\xfe", b"\xc3\x28", b"\xef\xbb\xbf", b"\xed\xa0\x80", b"\r", b"\x7f",
    "\u202e".encode(), "\u2028".encode(), "é".encode(), "漢字".encode(), "👩‍👩‍👧".encode(), "e\u0301".encode(), "שלום".encode(),
    b"nan", b"-inf", b"1e999", b"1e308", b"-0.0", b"0x7fffffffffffffff", b"9223372036854775808", b"1" + b"0" * 30,
    b"9" * 5_000, b"1_000_000_000", b"[[", b"]]", b"[", b"]", b"{", b"}", b'"', b"'''", b'"""', b"\\", b"\\ud800",
    b"=", b".", b",", b"#", b"\n", b"\n\n[grid]\n", b"\n[mdp]\n", b"true", b"null", b"1979-05-27T07:32:00Z",
    b"[" * 2_000, b"{a=" * 500, b"a." * 300, b"a = 1\n" * 3, b"x" * 20_000, b"[red]", b"$(id)", b"%n%s",
)  # fmt: skip
VALUES: tuple[Any, ...] = (
    0, 1, -1, 2, 7, 0.5, -0.0, 1e-320, 1e308, -1e308, math.inf, -math.inf, math.nan, 2**31, 2**63 - 1, 2**63, -(2**63), 2**64,
    10**9, 10**12, 10**15, 10**30, 10**4000, 999_999, 1_000_000, "", " ", "x", "0", "S", "a" * 60, "a" * 61, "a" * 10_000,
    "[red]bold[/red]", "漢字", "👩‍👩‍👧", "e\u0301", "שלום\u202e", "a\nb", "\x1b[31m", "\x00", "\ud800", "q-learning", "sarsa",
    "sample-average", "softmax", "ucb", "first", [], {}, [[]], [[[[[[]]]]]], [0], [1, 2], [1.5, -1], ["a"], [math.nan], [None],
    {"a": 1}, {"": ""}, {"p": 0.5, "reward": 1}, {"kind": "wall"}, True, False, None,
    datetime.date(1979, 5, 27), datetime.datetime(1979, 5, 27, 7, 32), datetime.time(7, 32),
)  # fmt: skip
HUGE: tuple[Callable[[], Any], ...] = (
    lambda: "y" * 300_000,
    lambda: list(range(3_000)),
    lambda: {f"k{number}": number for number in range(2_000)},
    lambda: ["z" * 1_000] * 100,
    lambda: [[1, 2]] * 2_000,
    lambda: ("S" + "." * 400 + "\n") * 400,
    lambda: nested(400),
)


def nested(levels: int) -> list[Any]:
    value: list[Any] = []
    for _ in range(levels):
        value = [value]
    return value


def mutated_bytes(text: str, other: str, chance: Chance) -> bytes:
    content = bytearray(text.encode("utf-8", "surrogatepass"))
    for _ in range(chance.choice((1, 1, 1, 2, 4))):
        at = chance.randrange(len(content) + 1)
        until = min(len(content), at + chance.choice((1, 1, 4, 20, 200)))
        match chance.randrange(9):
            case 0 if content:
                content[min(at, len(content) - 1)] ^= 1 << chance.randrange(8)
            case 1:
                del content[at:until]
            case 2:
                del content[at:]
            case 3 | 4:
                content[at:at] = chance.choice(INSERTED)
            case 5:
                content[at:until] = chance.choice(INSERTED)
            case 6:
                material = other.encode()
                begin = chance.randrange(len(material))
                content[at:until] = material[begin : begin + chance.randrange(1, 300)]
            case 7:
                lines = bytes(content).split(b"\n")
                line = chance.choice(lines)
                lines[chance.randrange(len(lines)) : 0] = [line] * chance.choice((1, 2, 50))
                content = bytearray(b"\n".join(lines))
            case _:
                content[at:at] = chance.randbytes(chance.randrange(1, 9))
    return bytes(content)


def mutated_document(document: dict[str, Any], chance: Chance) -> dict[str, Any]:
    document = copy.deepcopy(document)
    for _ in range(chance.choice((1, 1, 1, 2, 4))):
        places = list(_places(document))
        if not places:
            break
        holder, key = chance.choice(places)
        if isinstance(holder, dict):
            _mutate_table(holder, key, chance)
        else:
            _mutate_list(holder, key, chance)
    return document


def _places(value: Any) -> list[tuple[Any, Any]]:
    places: list[tuple[Any, Any]] = []
    to_visit = [value]
    while to_visit:
        holder = to_visit.pop()
        entries = holder.items() if isinstance(holder, dict) else enumerate(holder)
        for key, inner in entries:
            places.append((holder, key))
            if isinstance(inner, (dict, list)):
                to_visit.append(inner)
    return places


def _mutate_table(holder: dict[str, Any], key: str, chance: Chance) -> None:
    match chance.randrange(8):
        case 0:
            del holder[key]
        case 1:
            holder[_other_key(key, chance)] = holder.pop(key)
        case 2:
            holder[_other_key(key, chance)] = copy.deepcopy(holder[key])
        case 3:
            other = chance.choice(list(holder))
            holder[key], holder[other] = holder[other], holder[key]
        case _:
            holder[key] = _other_value(holder[key], chance)


def _mutate_list(holder: list[Any], place: int, chance: Chance) -> None:
    match chance.randrange(6):
        case 0:
            del holder[place]
        case 1:
            holder.insert(place, copy.deepcopy(holder[place]))
        case 2:
            holder[:] = holder * chance.choice((0, 2, 30))
        case 3:
            chance.shuffle(holder)
        case _:
            holder[place] = _other_value(holder[place], chance)


def _other_key(key: str, chance: Chance) -> str:
    odd = (
        "",
        "a" * 5_000,
        "a.b",
        "é",
        "\x1b",
        "👩‍👩‍👧",
        "a\nb",
        "reward",
        "map",
        "arms",
        "id",
        "means",
        "parent",
        "\ud800",
    )
    return chance.choice((key.upper(), key + "x", key[:-1], chance.choice(odd)))


def _other_value(value: Any, chance: Chance) -> Any:
    if isinstance(value, (int, float)) and chance.random() < 0.4:
        if abs(value) > sys.float_info.max:  # of which there is no third
            return -value
        return chance.choice(
            (value + 1, value - 1, -value, value * 1000, value / 3, float(value), str(value))
        )
    if isinstance(value, str) and value and chance.random() < 0.4:
        at = chance.randrange(len(value))
        letter = chance.choice("SGH#.<>v^ \n\tXé漢\x00\u0301👩")
        return chance.choice(
            (value[:at] + letter + value[at + 1 :], value[:at], value + letter, value * 3, [value])
        )
    if chance.random() < 0.03:
        return chance.choice(HUGE)()
    return copy.deepcopy(chance.choice(VALUES))


def as_toml(document: dict[str, Any]) -> str:
    return "".join(f"{_toml_text(key)} = {_toml_value(value)}\n" for key, value in document.items())


def _toml_value(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return _toml_text(value)
    if isinstance(value, int):
        return hex(value) if value >= 10**4000 else str(value)
    if isinstance(value, float):
        return repr(value)
    if isinstance(value, dict):
        return (
            "{ " + ", ".join(f"{_toml_text(key)} = {_toml_value(each)}" for key, each in value.items()) + " }"
        )
    if isinstance(value, list):
        return "[" + ", ".join(map(_toml_value, value)) + "]"
    return "none" if value is None else value.isoformat()


def _toml_text(text: str) -> str:
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
