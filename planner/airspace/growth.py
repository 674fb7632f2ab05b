"""Shapes grown or shrunk by a disk, where that at once would cost too much.

The outline of a comb whose teeth are nearer to each other than the disk is wide crosses itself, moved, as
often as there are pairs of teeth under the disk: time and memory grow with the square. Moved by a little
first, the teeth are one; disk after disk, each eight times as wide, is the same as the widest at once.
"""

from __future__ import annotations

import math

import shapely
from shapely.geometry.base import BaseGeometry

#: Outlines of fewer corners are moved at once.
FEW = 400
#: Parts of the whole that are done after each disk.
PARTS = (1.0 / 64.0, 1.0 / 8.0, 1.0)


def grown(shape: BaseGeometry, by_m: float, quad_segs: int = 16) -> BaseGeometry:
    """The shape and all that is within a distance of it; < 0: what of it is as far from its edge.

    Of many corners it is on the wide side (< 0: the narrow one) by 1 % of the distance at most, as shapely
    straightens outlines; of few on the other side, as ``buffer`` is.
    """
    if shapely.get_num_coordinates(shape) <= FEW:
        return shape.buffer(by_m, quad_segs=quad_segs)
    done = 0.0
    for part in PARTS:
        # A polygon is off its disk by the radius times the square of a segment's angle: the same each time.
        segments = max(2, math.ceil(2.0 * quad_segs * math.sqrt(part - done)))
        wide = (part - done) / math.cos(math.pi / (4.0 * segments))
        shape = shape.buffer(wide * by_m, quad_segs=segments)
        done = part
    return shape
