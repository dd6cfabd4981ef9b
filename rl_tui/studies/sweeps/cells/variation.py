"""The text form of varied settings: `alpha=0.01:1:log:20`, `algorithm=q-learning,sarsa`.

`NAME=FROM:TO:COUNT` has equal distances and includes both ends, `NAME=FROM:TO:log:COUNT` equal ratios. A
value in double quotes is JSON, and may contain a comma. Random points need no count.
"""

from __future__ import annotations

import json
import math
import re
from dataclasses import dataclass
from decimal import Context, Decimal
from fractions import Fraction
from functools import cached_property, lru_cache
from typing import Final

from rl_tui.agents.catalogue import BY_ID
from rl_tui.agents.hyperparameters import PARAMETERS, Parameter
from rl_tui.common.findings import near, one_line, shown
from rl_tui.worlds.editing.edit import PREFIX

Value = bool | int | float | str
"""A value of a setting. A list or table of the world is JSON text."""

FORM: Final = "NAME=FROM:TO[:log]:COUNT or NAME=A,B,C"
ALGORITHM: Final = "algorithm"
SCENARIO: Final = "scenario"
LOG: Final = "log"
MOST_VALUES: Final = 1_000_000
_NAMES: Final = (ALGORITHM, SCENARIO, *PARAMETERS)
_NUMBER: Final = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,3})?", re.ASCII)
_COUNT: Final = re.compile(r"[1-9]\d{0,8}", re.ASCII)
_LONGEST_NUMBER: Final = 60
_LONGEST_SHOWN: Final = 80
# values inside a logarithmic range have this many digits, or more if they are closer
_DIGITS: Final = 6
_EXACT: Final = Context(prec=60)


@dataclass(frozen=True)
class Variation:
    """The values of one setting: a `spread`, or a list."""

    name: str
    listed: tuple[Value, ...] = ()
    spread: Spread | None = None

    @property
    def count(self) -> int:
        """Number of values, 0 for random points without a count."""
        return len(self.listed) if self.spread is None else self.spread.count

    def value(self, index: int) -> Value:
        """Return the value `index`, from 0."""
        return self.listed[index] if self.spread is None else _value_of(self.spread, index)

    def drawn(self, share: float) -> Value:
        """Return the value at a uniform `share` in [0, 1)."""
        if self.spread is not None:
            return self.spread.between(share)
        return self.listed[int(share * len(self.listed))]

    @property
    def text(self) -> str:
        """Text for `read_variation`."""
        values = self.spread.text if self.spread is not None else ",".join(map(_written, self.listed))
        return f"{self.name}={values}"


@dataclass(frozen=True)
class Spread:
    """`count` (0: any) numbers from `low` to `high`, as written."""

    low: str
    high: str
    count: int
    logarithmic: bool = False
    whole: bool = False

    @property
    def text(self) -> str:
        """The spread as text."""
        parts = [
            self.low,
            self.high,
            *([LOG] if self.logarithmic else []),
            *([str(self.count)] * bool(self.count)),
        ]
        return ":".join(parts)

    @property
    def ends(self) -> tuple[int | float, int | float]:
        """First and last number."""
        return plain(Fraction(self.low)), plain(Fraction(self.high))

    def value(self, index: int) -> int | float:
        """Return the number at `index`, correctly rounded, so equal on every machine."""
        if index in (0, self.count - 1):
            return self.ends[1 if index else 0]
        if self.logarithmic:
            return self._in_ratio(Fraction(index, self.count - 1))
        low, high = Fraction(self.low), Fraction(self.high)
        return self._plain(low + (high - low) * index / (self.count - 1))

    def between(self, share: float) -> int | float:
        """Return the number at `share`, in [0, 1)."""
        if self.logarithmic:
            return self._in_ratio(Fraction(share))
        low, high = Fraction(self.low), Fraction(self.high)
        if self.whole:  # each whole number has an equal share
            return int(low + math.floor(Fraction(share) * (high - low + 1)))
        return self._within(_rounded(Decimal(float(low + (high - low) * Fraction(share))), _DIGITS))

    def _in_ratio(self, share: Fraction) -> int | float:
        low, high = Decimal(self.low), Decimal(self.high)
        exponent = _EXACT.divide(Decimal(share.numerator), Decimal(share.denominator))
        ratio = _EXACT.power(_EXACT.divide(high, low), exponent)
        return self._within(_rounded(_EXACT.multiply(low, ratio), self._digits))

    def _within(self, number: Decimal) -> int | float:
        return self._plain(min(max(Fraction(number), Fraction(self.low)), Fraction(self.high)))

    @cached_property
    def _digits(self) -> int:
        if self.count < 2:
            return _DIGITS
        ratio = math.log(Fraction(self.high) / Fraction(self.low)) / (self.count - 1)
        return min(17, max(_DIGITS, math.ceil(-math.log10(ratio)) + 3))

    def _plain(self, number: Fraction) -> int | float:
        return round(number) if self.whole else plain(number)


@lru_cache(maxsize=16_384)  # a grid needs each value many times
def _value_of(spread: Spread, index: int) -> int | float:
    return spread.value(index)


def plain(number: Fraction) -> int | float:
    """Return `number` as an integer if possible, else as a float."""
    return int(number) if number.denominator == 1 and abs(number) < 10**15 else float(number)


def _rounded(number: Decimal, digits: int) -> Decimal:
    return Context(prec=digits).plus(number)


def read_variation(text: str) -> Variation:
    """Parse a variation. Raises ValueError, which says what was expected."""
    name, equals, values = text.partition("=")
    if name.strip().startswith(PREFIX):  # a place may contain = in quotes
        name, equals, values = _world_parts(text)
    name = name.strip() if name.strip().startswith(PREFIX) else name.strip().replace("-", "_")
    if not equals or not name:
        raise ValueError(f"{shown(text)} is not {FORM}, such as alpha=0.01:1:log:20")
    if name not in _NAMES and not name.startswith(PREFIX):
        raise ValueError(
            f"{shown(text)}: unknown name {shown(name)}; expected a setting, {ALGORITHM}, {SCENARIO}, or a "
            f"parameter of the world such as {PREFIX}noise{near(name, _NAMES)}"
        )
    try:
        return _read_values(name, values.strip())
    except ValueError as fault:
        raise ValueError(f"{one_line(text, _LONGEST_SHOWN)}: {fault}") from fault


def _world_parts(text: str) -> tuple[str, str, str]:
    """Split at the equals sign. A place may contain anything."""
    bracket, equals = text.find("["), text.find("=")
    if -1 < bracket < equals:
        closing = re.compile(r'(?:"(?:[^"\\]|\\.)*"|[^"\]])*\]').match(text, bracket)
        equals = -1 if closing is None else text.find("=", closing.end())
    return (text, "", "") if equals < 0 else (text[:equals], "=", text[equals + 1 :])


def _read_values(name: str, text: str) -> Variation:
    parameter = PARAMETERS.get(name)
    parts = text.split(":")
    if len(parts) in (2, 3, 4) and all(_NUMBER.fullmatch(part.strip()) for part in parts[:2]):
        if name in (ALGORITHM, SCENARIO) or (parameter is not None and parameter.range is None):
            raise ValueError(f"{name} has words as values; expected {name}=A,B,C")
        return _spread([part.strip() for part in parts], name, parameter)
    values = tuple(_read_value(each, name, parameter) for each in _split(text))
    for place, value in enumerate(values):
        if any(value == other and type(value) is type(other) for other in values[:place]):
            raise ValueError(f"{_written(value)} is listed twice; list each value once")
    return Variation(name, values)


def _spread(parts: list[str], name: str, parameter: Parameter | None) -> Variation:
    low, high, *rest = parts
    logarithmic = bool(rest) and rest[0] == LOG
    counts = rest[1:] if logarithmic else rest
    if len(counts) > 1 or not all(map(_COUNT.fullmatch, counts)):
        raise ValueError(f"expected {FORM}. COUNT is a whole number from 2 to {MOST_VALUES:,}")
    if max(len(low), len(high)) > _LONGEST_NUMBER:
        raise ValueError(f"a number has more than {_LONGEST_NUMBER} characters")
    count, first, last = int(counts[0]) if counts else 0, Fraction(low), Fraction(high)
    if not first < last:
        raise ValueError(f"{low} is not below {high}; expected FROM below TO")
    if count == 1 or count > MOST_VALUES:
        raise ValueError(f"COUNT is {count:,}; expected a whole number from 2 to {MOST_VALUES:,}")
    if logarithmic and first <= 0:
        raise ValueError(f"FROM is {low}; log needs FROM above 0")
    whole = parameter is not None and parameter.whole
    for end in (low, high) if parameter is not None else ():
        _check(plain(Fraction(end)), name, parameter)
    spread = Spread(low, high, count, logarithmic, whole)
    if whole and count:  # in a narrow range several values round to the same number
        if last - first + 1 < count:
            raise ValueError(
                f"COUNT is {count:,}, but there are only {last - first + 1} whole numbers from {low} to "
                f"{high}"
            )
        values = dict.fromkeys(spread.value(index) for index in range(count))
        if len(values) < count:
            listed = ",".join(str(each) for each in list(values)[:20])
            raise ValueError(
                "some values are equal after rounding to whole numbers; expected a list such as "
                f"{name}={listed}"
            )
    return Variation(name, spread=spread)


def _split(text: str) -> list[str]:
    """Split `text` at commas outside quotes and brackets."""
    parts, depth, quoted, start = [], 0, False, 0
    for place, letter in enumerate(text):
        if letter == '"' and (place == 0 or text[place - 1] != "\\"):
            quoted = not quoted
        elif not quoted and letter in "[{":
            depth += 1
        elif not quoted and letter in "]}":
            depth -= 1
        elif letter == "," and not quoted and depth == 0:
            parts.append(text[start:place])
            start = place + 1
    return [each.strip() for each in [*parts, text[start:]]]


def _read_value(text: str, name: str, parameter: Parameter | None) -> Value:
    if not text:
        raise ValueError(f"a value is missing; expected {FORM}")
    if text.startswith('"'):
        return _from_json(text, str)
    is_number = _NUMBER.fullmatch(text) and len(text) <= _LONGEST_NUMBER
    value: Value = plain(Fraction(text)) if is_number and name not in (ALGORITHM, SCENARIO) else text
    if name == ALGORITHM and value not in BY_ID:
        raise ValueError(
            f"algorithm is {shown(value)}; expected one of {', '.join(BY_ID)}{near(text, BY_ID)}"
        )
    if parameter is not None:
        _check(value, name, parameter)
    if name.startswith(PREFIX):
        if text in ("true", "false"):
            return text == "true"
        if text.startswith(("[", "{")):
            return _from_json(text, (list, dict))
    return value


def _from_json(text: str, kind: type | tuple[type, ...]) -> str:
    try:
        value = json.loads(text)
    except (ValueError, RecursionError):
        raise ValueError(f"{shown(text)} is not JSON") from None
    if not isinstance(value, kind):
        raise ValueError(f"{shown(text)} is not a string in quotes")
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False, separators=(",", ":"))


def _check(value: Value, name: str, parameter: Parameter | None) -> None:
    if parameter is not None and not parameter.accepts(value):
        hint = near(value, parameter.words) if isinstance(value, str) else ""
        raise ValueError(f"{name} is {shown(value)}; expected {parameter.expected}{hint}")


def written(value: Value) -> str:
    """Format `value`: true, 0.1, 5 or a word."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return repr(value) if isinstance(value, float) else str(value)


def _written(value: Value) -> str:
    """Format `value` for a list, with quotes if it could be misread."""
    if not isinstance(value, str) or (value.startswith(("[", "{")) and _is_json(value)):
        return written(value)
    is_safe = (
        value == value.strip()
        and value not in ("", "true", "false")
        and not _NUMBER.fullmatch(value)
        and not re.search(r'[",\[\]{}:]', value)
    )
    return value if is_safe or _is_plain_colon(value) else json.dumps(value, ensure_ascii=False)


def _is_plain_colon(value: str) -> bool:
    """Return True for values like gym:FrozenLake-v1, which cannot be ranges."""
    return re.fullmatch(r"[A-Za-z_][^\s\",\[\]{}]*", value) is not None and value not in ("true", "false")


def _is_json(text: str) -> bool:
    try:
        return isinstance(json.loads(text), (list, dict))
    except (ValueError, RecursionError):
        return False
