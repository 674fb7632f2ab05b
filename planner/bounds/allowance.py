"""How long a bound is looked for, in work that is the same on any machine."""

from __future__ import annotations

import math

from planner.progress import Stop, never


class Allowance:
    """Work that may still be done, in lines between cells or what takes as long: about two million a second.

    Parameters
    ----------
    lines
        That many, by default no end of them.
    enough
        Ends the search for a better bound whatever is left.
    whole
        What this is a part of, and is spent of as well.
    """

    def __init__(self, lines: float = math.inf, enough: Stop = never, whole: Allowance | None = None) -> None:
        self.left = lines
        self._enough = enough
        self._whole = whole

    def spend(self, lines: float) -> None:
        """Take what has been done off what is left."""
        self.left -= lines
        if self._whole is not None:
            self._whole.spend(lines)

    @property
    def over(self) -> bool:
        """Whether nothing more is to be begun."""
        return self.left <= 0.0 or self.told

    @property
    def told(self) -> bool:
        """Whether it is enough, whatever is left."""
        return self._enough()

    def part(self, lines: float) -> Allowance:
        """So much of it at most, to be spent of both."""
        return Allowance(min(lines, self.left), self._enough, self)
