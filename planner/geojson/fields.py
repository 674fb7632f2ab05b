"""Reading one property at a time, collecting findings instead of stopping at the first."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable, Mapping
from enum import Enum
from types import MappingProxyType
from typing import Any, TypeVar

from planner.errors import Finding


class Required(Enum):
    """Stands in place of a default where a property must be given."""

    REQUIRED = "required"


REQUIRED = Required.REQUIRED


T = TypeVar("T", float, str)

LARGEST = sys.float_info.max
#: Beyond the first and, of what has to be above 0, below the second is no number in a unit of ours.
MOST, LEAST = 1e12, 1e-12
#: Of batteries, revisits, rotors; and characters of a name or another text.
MOST_COUNTED, MOST_CHARACTERS = 10_000, 1_000


def is_finite(value: Any) -> bool:
    """Whether a JSON value is a number that a float can hold: no NaN, no Infinity, no whole number beyond."""
    return isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) <= LARGEST


class Findings:
    """A list of findings under construction."""

    def __init__(self) -> None:
        self._found: list[Finding] = []

    def error(self, feature: str, rule: str, message: str, fix: str) -> None:
        """Add an error."""
        self._found.append(Finding(feature, rule, message, fix))

    def warning(self, feature: str, rule: str, message: str, fix: str) -> None:
        """Add a warning."""
        self._found.append(Finding(feature, rule, message, fix, "warning"))

    def take(self, more: Findings) -> None:
        """Add all that was found elsewhere."""
        self._found.extend(more.all())

    def all(self) -> tuple[Finding, ...]:
        """Everything found, in order."""
        return tuple(self._found)

    @property
    def errors(self) -> tuple[Finding, ...]:
        """The findings that refuse the scenario."""
        return tuple(f for f in self._found if f.severity == "error")

    @property
    def warnings(self) -> tuple[Finding, ...]:
        """The findings that do not."""
        return tuple(f for f in self._found if f.severity == "warning")


class Fields:
    """The properties of one feature, vehicle or sensor, read by name and type.

    Whatever is never asked for is unknown, and :meth:`refuse_unknown` says so.

    Parameters
    ----------
    owner
        How findings name the feature.
    values
        The raw JSON object.
    findings
        Where findings go.
    defaults
        Numbers that stand in place of the readers' own where a property is absent.
    """

    def __init__(
        self,
        owner: str,
        values: Mapping[str, Any],
        findings: Findings,
        defaults: Mapping[str, float] = MappingProxyType({}),
    ) -> None:
        self.owner = owner
        self._values = values
        self._findings = findings
        self._defaults = defaults
        self._known: set[str] = set()

    def __contains__(self, name: str) -> bool:
        return self._values.get(name) is not None

    def raw(self, name: str, default: Any = None) -> Any:
        """The value as it stands; null counts as absent."""
        self._known.add(name)
        value = self._values.get(name)
        return default if value is None else value

    def number(
        self,
        name: str,
        default: float | Required | None = REQUIRED,
        *,
        minimum: float = -math.inf,
        maximum: float = math.inf,
        above: float = -math.inf,
        below: float = math.inf,
    ) -> float | None:
        """A finite number within bounds; ``minimum``/``maximum`` may be reached, ``above``/``below`` not.

        None is beyond ``MOST`` or, where it has to be above 0, below ``LEAST``: no unit of ours needs it, and
        squares and quotients of such numbers are none.

        Returns the default, or None after a finding, when it is absent or wrong.
        """
        value = self.raw(name)
        if value is None:
            return self._absent(name, self._defaults.get(name, default), "a number")
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            self.wrong(name, f"must be a number, not {_kind(value)}", "Give a plain JSON number.")
            return None
        if not is_finite(value):
            self.wrong(name, "must be finite", "Replace NaN or Infinity by a number.", rule="not-finite")
            return None
        number = float(value)
        if abs(number) > MOST or (above == 0.0 and 0.0 < number < LEAST):
            self.wrong(
                name,
                f"is {number:g}, which no number in a unit of its name is",
                f"Give a value of {MOST:g} at most, and of {LEAST:g} at least where it is above 0.",
                rule="out-of-range",
            )
            return None
        if number < minimum or number > maximum or number <= above or number >= below:
            low = (
                f"≥ {minimum:g}" if math.isfinite(minimum) else f"> {above:g}" if math.isfinite(above) else ""
            )
            high = (
                f"≤ {maximum:g}" if math.isfinite(maximum) else f"< {below:g}" if math.isfinite(below) else ""
            )
            bounds = " and ".join(part for part in (low, high) if part)
            self.wrong(
                name, f"is {number:g}, must be {bounds}", f"Give a value {bounds}.", rule="out-of-range"
            )
            return None
        return number

    def integer(self, name: str, default: int, *, minimum: int, maximum: int = MOST_COUNTED) -> int:
        """A whole number from ``minimum`` to ``maximum``; the default after a finding."""
        value = self.raw(name)
        if value is None:
            return default
        if not is_finite(value) or value != int(value):
            self.wrong(name, f"must be a whole number, not {value!r}", "Give a whole number.")
            return default
        if not minimum <= value <= maximum:
            bounds = f"from {minimum} to {maximum}"
            self.wrong(name, f"is {value:g}, must be {bounds}", f"Give one {bounds}.", rule="out-of-range")
            return default
        return int(value)

    def flag(self, name: str, default: bool) -> bool:
        """True or false."""
        value = self.raw(name, default)
        if not isinstance(value, bool):
            self.wrong(name, f"must be true or false, not {_kind(value)}", "Write true or false.")
            return default
        return value

    def text(self, name: str, default: str | Required | None = REQUIRED) -> str | None:
        """A non-empty string."""
        value = self.raw(name)
        if value is None:
            return self._absent(name, default, "text")
        if not isinstance(value, str) or not value:
            self.wrong(name, f"must be text, not {_kind(value)}", "Write it in quotes.")
            return None
        if len(value) > MOST_CHARACTERS:
            message = f"has {len(value)} characters, more than {MOST_CHARACTERS}"
            self.wrong(name, message, "Shorten it.", rule="too-long")
            return None
        return value

    def choice(
        self, name: str, choices: Iterable[str], default: str | Required | None = REQUIRED
    ) -> str | None:
        """One of several words."""
        allowed = tuple(choices)
        value = self.raw(name)
        if value is None:
            return self._absent(name, default, " or ".join(allowed))
        if value not in allowed:
            self.wrong(name, f"is {value!r}", f"Use one of: {', '.join(allowed)}.", rule="unknown-value")
            return None
        return str(value)

    def wrong(self, name: str, message: str, fix: str, rule: str = "bad-value") -> None:
        """Add a finding about one property."""
        self._findings.error(self.owner, rule, f"{name} {message}", fix)

    def unused(self, name: str, why: str) -> None:
        """Add a warning where a property is given that nothing will read."""
        self.raw(name)
        if name in self:
            self._findings.warning(self.owner, "not-used", f"{name} {why}", "Remove it.")

    def refuse_unknown(self, *, also_known: Iterable[str] = ()) -> None:
        """Add a finding for each property never asked for."""
        known = self._known | set(also_known)
        for name in self._values:
            if name not in known:
                self._findings.error(
                    self.owner,
                    "unknown-property",
                    f"has the unknown property {name!r}",
                    f"Remove it or correct its name; known here: {', '.join(sorted(known))}.",
                )

    def _absent(self, name: str, default: T | Required | None, wanted: str) -> T | None:
        if isinstance(default, Required):
            self.wrong(name, "is missing", f"Add {name}: {wanted}.", rule="missing-property")
            return None
        return default


def _kind(value: object) -> str:
    names = {dict: "an object", list: "a list", str: "text", bool: "true/false", type(None): "null"}
    return names.get(type(value), type(value).__name__)
