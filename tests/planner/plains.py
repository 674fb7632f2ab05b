"""Two bases on ground of different height, and an aircraft at each."""

from __future__ import annotations

import functools
from typing import Any

from planner.airspace.terrain import Terrain
from planner.frames import LocalFrame
from tests.planner.scenarios import feature
from tests.planner.terrains import raster

WEST, EAST = (-0.03, -0.02), (0.03, -0.02)
#: Ground of the bases, and the level of the passes.
GROUND_M = {"west": 100.0, "east": 220.0}
LEVEL_M = 520.0
ABOARD = {"uav": "west", "second": "east"}


@functools.cache
def two_plains() -> Terrain:
    """A plain in the west, a higher one in the east, and a slope between them."""
    frame = LocalFrame(0.0, 0.0)
    degree_m = float(frame.to_local([(1.0, 0.0)])[0][0])

    def surface(east_m: Any, north_m: Any) -> Any:
        up = ((east_m / degree_m + 0.015) / 0.03).clip(0.0, 1.0)
        return GROUND_M["west"] + (GROUND_M["east"] - GROUND_M["west"]) * up

    return raster(surface, frame)


def over_plains(document: dict[str, Any], **vehicle: Any) -> dict[str, Any]:
    """An aircraft at each of two bases, one on either plain."""
    document["features"] = [f for f in document["features"] if f["properties"]["role"] != "start"]
    for name, place in (("west", WEST), ("east", EAST)):
        document["features"].append(feature(name, "base", "Point", list(place)))
    for own in document["vehicles"]:
        own |= {"base": ABOARD[own["name"]], **vehicle}
    return document | {"terrain": "t", "altitude_m": LEVEL_M, "altitude_reference": "amsl"}
