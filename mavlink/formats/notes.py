"""What a reader mended and what a writer lost, in few lines: the same thing is told once, with its places."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

#: Lines of comment can be half a file.
_MOST_LINES = 8
_PLURALS = {"line": "lines", "item": "items", "fence item": "fence items", "rally item": "rally items"}


@dataclass(slots=True)
class Notes:
    """Notes in the order in which they first came up."""

    _places: dict[tuple[str, str], list[int]] = field(default_factory=dict)

    def add(self, message: str, kind: str = "", number: int | None = None) -> None:
        """Tell something of the file as a whole, or of one line or item of it."""
        places = self._places.setdefault((kind, message), [])
        if number is not None:
            places.append(number)

    def lines(self) -> tuple[str, ...]:
        """Each message once."""
        return tuple(_line(kind, message, places) for (kind, message), places in self._places.items())


def _line(kind: str, message: str, places: list[int]) -> str:
    if not places:
        return message
    word = kind if len(places) == 1 else _PLURALS[kind]
    ranges = _ranges(places)
    if kind == "line" and len(ranges) > _MOST_LINES:
        ranges = [*ranges[:_MOST_LINES], f"… ({len(places)} in all)"]
    return f"{word} {', '.join(ranges)}: {message}"


def _ranges(numbers: Iterable[int]) -> list[str]:
    runs: list[list[int]] = []
    for number in sorted(set(numbers)):
        if runs and number == runs[-1][1] + 1:
            runs[-1][1] = number
        else:
            runs.append([number, number])
    return [str(a) if a == b else f"{a}–{b}" for a, b in runs]
