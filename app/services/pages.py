"""How many entries a list has, asked of the database only where its page does not tell."""

from __future__ import annotations

from collections.abc import Awaitable, Callable


async def total_of(found: int, limit: int, offset: int, count: Callable[[], Awaitable[int]]) -> int:
    """The length of a list of which a page holds ``found`` entries.

    A page that is not full is the last one: what lies before it and what it holds is all there is. Each
    question to the database costs a millisecond of threads.
    """
    if found < limit and (found or not offset):
        return offset + found
    return await count()
