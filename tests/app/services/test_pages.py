"""The length of a list, by one of its pages."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from app.services.pages import total_of


@given(st.integers(0, 30), st.integers(1, 12), st.integers(0, 40))
async def test_every_page_of_every_list_tells_its_length(length: int, limit: int, offset: int) -> None:
    """Asked of the database only by full pages, and by those behind the end."""
    asked = 0

    async def count() -> int:
        nonlocal asked
        asked += 1
        return length

    found = len(range(length)[offset : offset + limit])
    assert await total_of(found, limit, offset, count) == length
    assert asked == (found == limit or (not found and offset > 0))
