"""The inputs of the fuzzer."""

from __future__ import annotations

import json
import random
import tomllib
from typing import Any, Final

from fuzz_documents import BLOCK, block
from fuzz_mutations import as_toml, mutated_bytes, mutated_document
from fuzz_seeds import lesson_seeds, scenario_seeds, session_seeds, signed

SCENARIO: Final = "scenario"
SESSION: Final = "session"
LESSON: Final = "lesson"


def input_of(kind: str, seed: int, number: int) -> bytes:
    chance = random.Random(f"{kind} {seed} {number}")
    if kind == SCENARIO:
        return _scenario(chance, seed, number)
    if kind == LESSON:
        return _lesson(chance, number)
    return _session(chance, seed, number)


def _scenario(chance: random.Random, seed: int, number: int) -> bytes:
    seeds = scenario_seeds()
    match number % 3:
        case 0:
            return mutated_bytes(chance.choice(seeds), chance.choice(seeds), chance)
        case 1:
            return _bytes(as_toml(mutated_document(tomllib.loads(chance.choice(seeds)), chance)))
        case _:
            place = number // 3
            documents = block(seed * 1_000_000 + place // BLOCK)
            return _bytes(as_toml(documents[place % BLOCK % len(documents)]))


def _lesson(chance: random.Random, number: int) -> bytes:
    seeds = lesson_seeds()
    if number % 2:
        document = mutated_document(tomllib.loads(chance.choice(seeds)), chance)
        pages = document.get("pages")
        if not isinstance(pages, list) or not all(isinstance(page, dict) for page in pages):
            return _bytes(as_toml(document))
        del document["pages"]  # tables with a header distinguish a lesson from a scenario
        return _bytes(as_toml(document) + "".join(f"[[pages]]\n{as_toml(page)}" for page in pages))
    return mutated_bytes(chance.choice(seeds), chance.choice(seeds), chance)


def _session(chance: random.Random, seed: int, number: int) -> bytes:
    text = chance.choice(session_seeds())
    match number % 5:
        case 0:
            return mutated_bytes(text, chance.choice(session_seeds()), chance)
        case 1:  # an error in the text, with a valid checksum
            faulty = mutated_bytes(text, chance.choice(session_seeds()), chance)
            try:
                fields = json.loads(faulty)
                return _bytes(signed(fields)) if isinstance(fields, dict) else faulty
            except (ValueError, RecursionError):
                return faulty
        case 2:  # another scenario in it
            fields = json.loads(text)
            scenario = _scenario(chance, seed, number).decode("utf-8", "replace")
            fields["scenario"] = {**fields["scenario"], "kind": "file", "text": scenario}
            return _bytes(signed(fields))
        case _:
            return _bytes(signed(_plain(mutated_document(json.loads(text), chance))))


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(each) for key, each in value.items()}
    if isinstance(value, list):
        return [_plain(each) for each in value]
    if isinstance(value, int) and value.bit_length() > 10_000:
        return 10**4000
    return value if value is None or isinstance(value, (bool, int, float, str)) else str(value)


def _bytes(text: str) -> bytes:
    return text.encode("utf-8", "surrogatepass")
