"""Which targets may share a pass, over all families: only those of one family do."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from planner.coverage.ways import Group, Sharing, Target


@dataclass(frozen=True, slots=True)
class Apart:
    """Targets that share nothing."""

    owners: Sequence[int] = ()

    def groups(self) -> list[Group]:
        """None."""
        return []

    def target(self, group: Group) -> Target | None:
        """None."""
        return None


@dataclass(frozen=True, slots=True)
class ByFamily:
    """What each family's targets share, the items of all counted on.

    Parameters
    ----------
    parts
        Of each family which targets are its, and what these share.
    """

    parts: tuple[tuple[tuple[int, ...], Sharing], ...]

    @property
    def owners(self) -> tuple[int, ...]:
        """Of each item which target it is of."""
        return tuple(of[k] for of, sharing in self.parts for k in sharing.owners)

    def groups(self) -> list[Group]:
        """Groups of each family."""
        found = [
            frozenset(first + k for k in group)
            for first, sharing in zip(self._firsts(), self._sharings(), strict=True)
            for group in sharing.groups()
        ]
        return sorted(found, key=lambda group: (-len(group), sorted(group)))

    def target(self, group: Group) -> Target | None:
        """What sees a group, where it is of one family."""
        for first, sharing in zip(self._firsts(), self._sharings(), strict=True):
            own = frozenset(k - first for k in group)
            if own <= set(range(len(sharing.owners))):
                return sharing.target(own)
        return None

    def _sharings(self) -> list[Sharing]:
        return [sharing for _, sharing in self.parts]

    def _firsts(self) -> list[int]:
        counts = [len(sharing.owners) for sharing in self._sharings()]
        return [sum(counts[:k]) for k in range(len(counts))]
