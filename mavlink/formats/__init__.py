"""Mission files: QGroundControl's ``.plan``, ``QGC WPL 110``, and KML for looking at."""

from __future__ import annotations

from mavlink.formats.errors import FormatError
from mavlink.formats.kml import write_kml
from mavlink.formats.kmz import write_kmz
from mavlink.formats.losses import losses, lost_on_board
from mavlink.formats.qgc_plan import read_plan, write_plan
from mavlink.formats.reading import kind_of, read_mission
from mavlink.formats.waypoints import read_waypoints, write_waypoints

__all__ = [
    "FormatError",
    "kind_of",
    "losses",
    "lost_on_board",
    "read_mission",
    "read_plan",
    "read_waypoints",
    "write_kml",
    "write_kmz",
    "write_plan",
    "write_waypoints",
]
