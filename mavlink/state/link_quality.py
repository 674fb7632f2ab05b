"""How many of a vehicle's frames arrive, by the numbers it gives them.

Source: https://mavlink.io/en/guide/serialization.html (a sequence number counts each sender's frames).
"""

from __future__ import annotations

from collections import deque
from typing import Final

_NUMBERS: Final = 256
#: A number this far ahead is one that was overtaken, or comes twice.
_BACK: Final = 128
#: What counts: the last seconds, told from this many frames on.
_WINDOW_S: Final = 10.0
_FEWEST: Final = 10
_BUCKET_S: Final = 1.0


class LinkQuality:
    """The share of one sender's frames that arrived lately."""

    def __init__(self) -> None:
        self._last: int | None = None
        # Begin, arrived, lost of each second.
        self._buckets: deque[list[float]] = deque()

    def heard(self, sequence: int | None, now_s: float) -> None:
        """A frame has arrived; those between it and the one before have not."""
        if sequence is None:
            return
        ahead = 1 if self._last is None else (sequence - self._last) % _NUMBERS
        bucket = self._bucket(now_s)
        bucket[1] += 1
        if 0 < ahead < _BACK:
            bucket[2] += ahead - 1
            self._last = sequence
        elif ahead:
            # It was taken for lost when its successor came.
            bucket[2] -= 1

    def forget(self) -> None:
        """The sender has vanished: it may count anew when it comes back."""
        self._last = None

    def share(self, now_s: float) -> float | None:
        """From 0 to 1; None where too little was heard to tell, 0 where all has fallen silent."""
        recent = [bucket for bucket in self._buckets if now_s - bucket[0] < _WINDOW_S]
        if not recent and self._buckets:
            return 0.0
        arrived, lost = (sum(bucket[part] for bucket in recent) for part in (1, 2))
        if arrived < _FEWEST:
            return None
        return min(1.0, arrived / (arrived + max(lost, 0.0)))

    def _bucket(self, now_s: float) -> list[float]:
        if not self._buckets or now_s - self._buckets[-1][0] >= _BUCKET_S:
            self._buckets.append([now_s, 0, 0])
            while now_s - self._buckets[0][0] >= _WINDOW_S:
                self._buckets.popleft()
        return self._buckets[-1]
