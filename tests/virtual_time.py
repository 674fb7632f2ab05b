"""An event loop whose clock is its own: it jumps to whatever is due next as soon as nothing is left to do.

For tests marked ``virtual_time``, whose tasks talk to each other inside this process alone. Minutes of
waiting pass at once, and a busy machine changes nothing: between two moments all that can be done is done.
Whoever takes a clock is given ``loop_time_s``.
"""

from __future__ import annotations

import asyncio
import selectors


class _Jumping(selectors.DefaultSelector):
    """Never waits for a moment: what would have been waited is added to the clock."""

    now_s = 0.0

    def select(self, timeout: float | None = None) -> list[tuple[selectors.SelectorKey, int]]:
        if timeout is None:
            return super().select(None)
        ready = super().select(0)
        if not ready and timeout > 0.0:
            self.now_s += timeout
        return ready


class VirtualLoop(asyncio.SelectorEventLoop):
    """A loop of virtual time, which begins at 0."""

    def __init__(self) -> None:
        self._jumping = _Jumping()
        super().__init__(self._jumping)

    def time(self) -> float:
        return self._jumping.now_s


def loop_time_s() -> float:
    """The time of the loop that asks, virtual or not: for whoever takes a clock."""
    return asyncio.get_running_loop().time()
