"""The base of all world tables: accepted values, and pydantic's errors as findings.

Each kind of world is one subclass of `WorldSection`, and one row in `files/scenario.py`.
"""

from __future__ import annotations

import typing
from abc import abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
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
    """A table of a scenario file. Unknown keys are errors."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    @model_validator(mode="before")
    @classmethod
    def _has_few_keys(cls, value: object) -> object:
        # Each error takes a kilobyte
        if isinstance(value, dict) and len(value) > MOST_KEYS:
            raise refused(shown(value), f"a table of at most {MOST_KEYS:,} keys")
        return value


AnySection = TypeVar("AnySection", bound=FileSection)


@dataclass(frozen=True, slots=True)
class Expect:
    """An annotation that refuses raw values which fail `test`.

    `expected` is the text of the error, and `found` describes the value.
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
    """Return the error of a validator, with found and expected value."""
    return PydanticCustomError("refused", "{found}", {"found": found, "expected": expected})


def is_number(value: object) -> bool:
    """Return True for a number, but not for booleans, dates and NaN."""
    return isinstance(value, (int, float)) and not isinstance(value, bool) and value == value


def number(low: float = -LARGEST_NUMBER, high: float = LARGEST_NUMBER) -> Expect:
    """Expect a finite number from `low` to `high`."""
    return Expect(
        f"a finite number from {low:g} to {high:g}", lambda value: is_number(value) and low <= value <= high
    )


def whole_number(low: int, high: int) -> Expect:
    """Expect an integer from `low` to `high`."""
    return Expect(
        f"a whole number from {low:,} to {high:,}",
        lambda value: is_number(value) and isinstance(value, int) and low <= value <= high,
    )


def one_of(values: Sequence[str]) -> Expect:
    """Expect one of a few texts."""
    return Expect(" or ".join(map(shown, values)), lambda value: value in values)


def with_control_character(value: object, also: str = "") -> str:
    """Return :func:`shown` of `value`, after its first control character, if any.

    Those in `also` are allowed.
    """
    named = control_character(value, also) if isinstance(value, str) else ""
    return f"{named} in {shown(value)}" if named else shown(value)


def text(longest: int) -> Expect:
    """Expect one line of at most `longest` characters."""
    return Expect(
        f"one line of at most {longest:,} characters, without control characters",
        lambda value: isinstance(value, str) and len(value) <= longest and is_plain(value),
        with_control_character,
    )


def markdown(longest: int) -> Expect:
    """Expect Markdown of at most `longest` characters, without escaped control characters."""

    def found(value: object) -> str:
        return with_control_character(unescape(value) if isinstance(value, str) else value, _IN_LINES)

    return Expect(
        f"a text of at most {longest:,} characters, without control characters",
        lambda value: (
            isinstance(value, str)
            and len(value) <= longest
            and is_plain(value, _IN_LINES)
            and is_plain(unescape(value), _IN_LINES)
        ),
        found,
    )


def is_name(value: object) -> bool:
    """Return True if `value` can name a state or an action."""
    return isinstance(value, str) and 0 < len(value.strip()) <= len(value) <= LONGEST_NAME and is_plain(value)


def is_table(value: object) -> bool:
    """Return True if `value` is a table."""
    return isinstance(value, dict)


def sized(kind: type[list[Any] | dict[Any, Any]], most: int, least: int = 0) -> Callable[[object], bool]:
    """Return a test for a list or table of this size."""
    return lambda value: isinstance(value, kind) and least <= len(value) <= most


def is_truth_value(value: object) -> bool:
    """Return True if `value` is true or false."""
    return isinstance(value, bool)


TruthValue = Annotated[bool, Expect("true or false", is_truth_value)]
Number = Annotated[float, number()]
Probability = Annotated[float, number(0, 1)]
Name = Annotated[str, Expect(f"a name of 1 to {LONGEST_NAME} characters", is_name, with_control_character)]


def parsed(section: type[AnySection], raw: object) -> tuple[AnySection | None, list[Finding]]:
    """Parse `raw`, or return None and the formal errors."""
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
    """Return the finding for an unknown key of a table."""
    keys = list(keys)
    return Finding(location, f"unknown key; use one of {', '.join(keys)}{near(str(location[-1]), keys)}")


def _section_at(section: type[FileSection], location: tuple[str | int, ...]) -> type[FileSection]:
    # The section with the last key of `location`
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
        """Yield contradictions in the raw table, even if some entries are invalid."""
        return iter(())

    def environment_findings(self) -> Iterator[Finding]:
        """Yield errors outside the file, such as a missing environment, perhaps slowly."""
        return iter(())

    @property
    def drawn_from_seed(self) -> bool:
        """True if the world depends on the seed."""
        return False

    def sketch(self) -> Drawing | None:
        """Return the drawing without building the world, or None if unknown.

        A map has only size and wind, and a graph has no states.
        """
        return None

    @abstractmethod
    def build(self, generator: Generator) -> World:
        """Build the world. Its random parts are drawn from `generator`."""


class WorldRefusedError(Exception):
    """Why the world cannot be built, located inside its table."""

    def __init__(self, location: Location, found: str, expected: str = "") -> None:
        super().__init__(found)
        self.finding = Finding(location, found, expected)
