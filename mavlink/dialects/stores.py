"""How much of a fence an autopilot stores."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

#: What ArduPilot's AC_PolyFence_loader writes before and behind the shapes, of each polygon besides its
#: corners, of a corner, and of a circle.
FRAME_BYTES, POLYGON_BYTES, CORNER_BYTES, CIRCLE_BYTES = 5, 2, 8, 13
#: It counts a polygon's corners in a byte.
MOST_CORNERS = 255


@dataclass(frozen=True, slots=True)
class FenceStore:
    """Room for a fence.

    Parameters
    ----------
    points
        Most corners and circles together.
    size_bytes
        Most that ArduPilot's own way to store them takes; None where points alone count.
    """

    points: int
    size_bytes: int | None = None

    @property
    def told(self) -> str:
        """The limit in words."""
        if self.size_bytes is None:
            return f"{self.points} corners and circles"
        return f"{self.size_bytes} bytes or {self.points} corners and circles"

    def holds(self, polygons: Sequence[int], circles: int) -> bool:
        """Whether polygons of so many corners, and so many circles, fit."""
        return self.lacks(polygons, circles) == ""

    def lacks(self, polygons: Sequence[int], circles: int) -> str:
        """By what they do not fit; nothing where they do."""
        points = sum(polygons) + circles
        if points > self.points:
            return f"{points} corners and circles where the vehicle stores {self.points}"
        if self.size_bytes is None:
            return ""
        if max(polygons, default=0) > MOST_CORNERS:
            return f"a polygon of {max(polygons)} corners where the vehicle takes {MOST_CORNERS}"
        size_bytes = FRAME_BYTES + CIRCLE_BYTES * circles
        size_bytes += sum(POLYGON_BYTES + CORNER_BYTES * corners for corners in polygons)
        if size_bytes > self.size_bytes:
            return f"{size_bytes} bytes where the vehicle stores {self.size_bytes}"
        return ""


#: Boards with 16 kB of storage (StorageManager's layouts; ``BRD_SD_FENCE`` makes room on a card).
ARDUPLANE_STORE = FenceStore(84, 672)
ARDUCOPTER_STORE = FenceStore(70, 560)
#: v1.15 and on store 64, versions before one less.
PX4_STORE = FenceStore(63)
