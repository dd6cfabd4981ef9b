"""The base of all tables in a scenario file: allowed values, and errors reported as findings.

Each kind of world is one subclass of `WorldSection`, and one row in `files/scenario.py`. Complaints of
pydantic become findings: what was found, what was expected, and where.
"""

from __future__ import annotations

import typing
from abc import abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from html import unescape
from typing import TYPE_CHECKING, Annotated, Any, Final, TypeVar

from pydantic import BaseModel, ConfigDict, GetCoreSchemaHandler, ValidationError, model_validator
from pydantic_core import CoreSchema, ErrorDetails, PydanticCustomError, core_schema

from rl_tui.common.findings import Finding, Location, control_character, is_plain, near, shown
from rl_tui.common.limits import LARGEST_NUMBER, LONGEST_NAME, MOST_FINDINGS, MOST_KEYS
from rl_tui.worlds.drawing import Drawing
from rl_tui.worlds.world import World

if TYPE_CHECKING:
    from numpy.random import Generator


# Values and findings


_IN_LINES: Final = "\n\t"


class FileSection(BaseModel):
    """A table of a scenario file. Keys it does not know are faults."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    @model_validator(mode="before")
    @classmethod
    def _has_few_keys(cls, value: object) -> object:
        """Refuse a table of very many keys at once: to complain of each takes a kilobyte."""
        if isinstance(value, dict) and len(value) > MOST_KEYS:
            raise refused(shown(value), f"a table of at most {MOST_KEYS:,} keys")
        return value


AnySection = TypeVar("AnySection", bound=FileSection)


@dataclass(frozen=True, slots=True)
class Expect:
    """Put into Annotated: refuses a raw value that fails ``test``, in the words of ``expected``.

    ``found`` says what such a value is.
    """

    expected: str
    test: Callable[[Any], bool]
    found: Callable[[Any], str] = shown

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Test the raw value before pydantic converts it."""
        return core_schema.no_info_before_validator_function(self._tested, handler(source))

    def _tested(self, value: object) -> object:
        if not self.test(value):
            raise refused(self.found(value), self.expected)
        return value


def refused(found: str, expected: str) -> PydanticCustomError:
    """Return the error by which a validator says what it found and what it expected."""
    return PydanticCustomError("refused", "{found}", {"found": found, "expected": expected})


def is_number(value: object) -> bool:
    """Return whether a value is a number: no truth value, date or NaN."""
    return isinstance(value, (int, float)) and not isinstance(value, bool) and value == value


def number(low: float = -LARGEST_NUMBER, high: float = LARGEST_NUMBER) -> Expect:
    """Expect a finite number within ``low`` .. ``high``."""
    return Expect(
        f"a finite number from {low:g} to {high:g}", lambda value: is_number(value) and low <= value <= high
    )


def whole_number(low: int, high: int) -> Expect:
    """Expect an integer within ``low`` .. ``high``."""
    return Expect(
        f"a whole number from {low:,} to {high:,}",
        lambda value: is_number(value) and isinstance(value, int) and low <= value <= high,
    )


def with_control_character(value: object, also: str = "") -> str:
    """Return a value as :func:`shown` does, and before it the control character that is in it, if any."""
    named = control_character(value, also) if isinstance(value, str) else ""
    return f"{named} in {shown(value)}" if named else shown(value)


def text(longest: int) -> Expect:
    """Expect one line of at most ``longest`` characters."""
    return Expect(
        f"one line of text of at most {longest:,} characters, none of them a control character",
        lambda value: isinstance(value, str) and len(value) <= longest and is_plain(value),
        with_control_character,
    )


def markdown(longest: int) -> Expect:
    """Expect Markdown of at most ``longest`` characters, which spells no control character either."""

    def found(value: object) -> str:
        return with_control_character(unescape(value) if isinstance(value, str) else value, _IN_LINES)

    return Expect(
        f"a text of at most {longest:,} characters, none of them a control character",
        lambda value: (
            isinstance(value, str)
            and len(value) <= longest
            and is_plain(value, _IN_LINES)
            and is_plain(unescape(value), _IN_LINES)
        ),
        found,
    )


def is_name(value: object) -> bool:
    """Return whether a value can name a state or an action."""
    return isinstance(value, str) and 0 < len(value.strip()) <= len(value) <= LONGEST_NAME and is_plain(value)


def is_table(value: object) -> bool:
    """Return whether a value is a table."""
    return isinstance(value, dict)


def sized(kind: type[list[Any] | dict[Any, Any]], most: int, least: int = 0) -> Callable[[object], bool]:
    """Return the test whether a value is a list or a table of ``least`` to ``most`` entries."""
    return lambda value: isinstance(value, kind) and least <= len(value) <= most


def is_truth_value(value: object) -> bool:
    """Return whether a value is true or false."""
    return isinstance(value, bool)


TruthValue = Annotated[bool, Expect("true or false", is_truth_value)]
Number = Annotated[float, number()]
Probability = Annotated[float, number(0, 1)]
Name = Annotated[str, Expect(f"a name of 1 to {LONGEST_NAME} characters", is_name, with_control_character)]


def parsed(section: type[AnySection], raw: object) -> tuple[AnySection | None, list[Finding]]:
    """Return the section made of ``raw`` and no findings, or None and all that is wrong with its form."""
    try:
        return section.model_validate(raw), []
    except ValidationError as error:
        return None, [_finding(section, each) for each in error.errors(include_url=False)[:MOST_FINDINGS]]


def _finding(section: type[FileSection], error: ErrorDetails) -> Finding:
    location = tuple(step for step in error["loc"] if step != "[key]")
    if error["type"] == "refused":
        return Finding(location, error["ctx"]["found"], error["ctx"]["expected"])
    if error["type"] == "missing":
        return Finding(location, "nothing", _expected_of(_section_at(section, location), str(location[-1])))
    if error["type"] == "extra_forbidden":
        keys = list(_section_at(section, location).model_fields)
        return unknown_key(location, keys)
    if error["type"] == "model_type":
        return Finding(location, shown(error["input"]), "a table")
    return Finding(location, shown(error["input"]), error["msg"])


def unknown_key(location: tuple[str | int, ...], keys: Iterable[str]) -> Finding:
    """Return the finding for a key that its table does not know."""
    keys = list(keys)
    return Finding(location, "an unknown key", f"one of {', '.join(keys)}{near(str(location[-1]), keys)}")


def _section_at(section: type[FileSection], location: tuple[str | int, ...]) -> type[FileSection]:
    """Return the section whose key the last step of ``location`` is."""
    for step in location[:-1]:
        field = section.model_fields.get(str(step))
        section = next(_sections_in(field.annotation), section) if field else section
    return section


def _sections_in(annotation: object) -> Iterator[type[FileSection]]:
    if isinstance(annotation, type) and issubclass(annotation, FileSection):
        yield annotation
    for inner in typing.get_args(annotation):
        yield from _sections_in(inner)


def _expected_of(section: type[FileSection], key: str) -> str:
    metadata = section.model_fields[key].metadata
    return next(each.expected for each in metadata if isinstance(each, Expect))


# The table of a world


class WorldSection(FileSection):
    """The table of one kind of world. Findings are located inside it."""

    @classmethod
    def connection_findings(cls, raw: Mapping[str, Any]) -> Iterator[Finding]:
        """Yield faults between the entries of the raw table, whether or not the form of each is sound."""
        return iter(())

    def environment_findings(self) -> Iterator[Finding]:
        """Yield faults that only show once the world outside the file is looked at; may be slow."""
        return iter(())

    @property
    def drawn_from_seed(self) -> bool:
        """Whether another seed makes another world."""
        return False

    def sketch(self) -> Drawing | None:
        """Return how the world will be drawn, without building it; None if the table does not tell.

        A map has its size and wind only, a graph no states.
        """
        return None

    @abstractmethod
    def build(self, generator: Generator) -> World:
        """Return the world; what is random about the world itself is drawn from ``generator``."""


class WorldRefusedError(Exception):
    """The world cannot be built; ``finding`` says why, located inside its table."""

    def __init__(self, location: Location, found: str, expected: str) -> None:
        super().__init__(found)
        self.finding = Finding(location, found, expected)
