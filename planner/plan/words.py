"""What plans are written in: places in WGS 84 degrees and the words for what can be one of a few."""

from __future__ import annotations

from typing import Literal

LonLat = tuple[float, float]
LonLatAlt = tuple[float, float, float]
Ring = tuple[LonLat, ...]

AltitudeReference = Literal["amsl", "home", "terrain"]
SegmentKind = Literal["straight", "left", "right", "vertical"]
PhaseKind = Literal["take_off", "climb", "mission", "return", "landing"]
#: How a flight ends: on the ground, circling over home until a pilot lands it, circling over its end.
Finish = Literal["land", "return", "loiter"]
#: What releases a camera.
Trigger = Literal["distance", "time", "video"]
