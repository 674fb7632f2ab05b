"""Every closed walk of a small grid, one by one."""

from __future__ import annotations

from collections.abc import Iterator

from planner.search.importance.grid import ImportanceGrid


def closed_walks(grid: ImportanceGrid, base: int, battery: int) -> Iterator[tuple[int, ...]]:
    """All walks of at most so many moves from the base back to it, the one that stays included."""
    rows, columns = grid.shape
    blocked = grid.blocked.reshape(-1)

    def beside(cell: int) -> Iterator[int]:
        row, column = divmod(cell, columns)
        for r, c in ((row + 1, column), (row - 1, column), (row, column + 1), (row, column - 1)):
            if 0 <= r < rows and 0 <= c < columns and not blocked[r * columns + c]:
                yield r * columns + c

    def onward(walk: tuple[int, ...]) -> Iterator[tuple[int, ...]]:
        if walk[-1] == base:
            yield walk
        if len(walk) <= battery:
            for there in beside(walk[-1]):
                yield from onward((*walk, there))

    return onward((base,))


def paid(
    grid: ImportanceGrid,
    walk: tuple[int, ...],
    battery: int,
    detection: float,
    revisit: float,
    unspent: float,
) -> float:
    """What a walk is paid, by counting looks; the last arrival at the base is no look."""
    worth = grid.worth.reshape(-1)
    looks: dict[int, int] = {}
    total = -unspent * (battery - (len(walk) - 1))
    for cell in walk[:-1] or walk:
        before = looks.get(cell, 0)
        total += worth[cell] * (1.0 - detection) ** before - (revisit if before else 0.0)
        looks[cell] = before + 1
    return total
